#pragma once

#include <string>

namespace mindahl::cli {

/// Reads "0.01" or "1%".
/// @throws InputError naming --tolerance, the text and the rule
double ParseTolerance(const std::string& text);

}  // namespace mindahl::cli
