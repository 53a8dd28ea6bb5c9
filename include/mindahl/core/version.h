#pragma once

#include <string_view>

namespace mindahl {

/// Version of the library, "major.minor.patch".
std::string_view Version();

}  // namespace mindahl
