#pragma once

#include <string>
#include <string_view>

#include "cli/app.h"

namespace mindahl::cli {

/// Writes to a file, whole or not at all, or to standard output for "-".
/// @throws InputError when the file cannot be written
void WriteText(std::string_view text, const std::string& path, Console& console);

}  // namespace mindahl::cli
