#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mindahl/core/error.h"
#include "support/message_of.h"

// Includes what nearly every test needs, and lets it name the helpers of the tests and the common
// matchers without their namespace.
namespace mindahl::testing {

using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::SizeIs;
using ::testing::StartsWith;

}  // namespace mindahl::testing

namespace mindahl {
namespace loop {}
namespace models {}
using namespace testing;
/// Fits are of records, by models.
namespace identification {
using namespace loop;
using namespace models;
}  // namespace identification
}  // namespace mindahl
