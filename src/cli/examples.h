#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <string>
#include <string_view>

namespace mindahl::cli {

/// Ends a command's help with lines to copy, before what ends every help. Each works as it is where
/// there are a loop.csv and, in `loops`, records of one contact; tests/cli/help_text.py runs them.
/// A line that is the last one's continuation begins with blanks.
void AddExamples(CLI::App& command, const CLI::App& app,
                 std::initializer_list<std::string_view> lines);

}  // namespace mindahl::cli
