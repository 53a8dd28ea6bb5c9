#pragma once

#include <string_view>

namespace mindahl {

/// Returns the version of the library, "major.minor.patch".
std::string_view Version();

}  // namespace mindahl
