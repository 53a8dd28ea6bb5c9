#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <string>
#include <string_view>

namespace mindahl::cli {

/// Ends a command's help with lines to copy, before what ends every help. tests/cli/help_text.py
/// runs each, and makes the records that they name. A line that continues the last one begins with
/// blanks.
void AddExamples(CLI::App& command, const CLI::App& app,
                 std::initializer_list<std::string_view> lines);

}  // namespace mindahl::cli
