#pragma once

#include <string>
#include <string_view>

namespace mindahl::io {

/// Runs gnuplot on a script and returns what it writes to its standard output.
/// No shell is involved, and the user's own gnuplot settings are not read.
/// @throws InputError when gnuplot is not on PATH
/// @throws std::runtime_error with its messages when it fails
std::string RunGnuplot(std::string_view script);

}  // namespace mindahl::io
