#pragma once

#include <string>

namespace mindahl::io {

/// 10ⁿ in plain text, of which labels are made.
std::string PowerOfTen(int exponent);

}  // namespace mindahl::io
