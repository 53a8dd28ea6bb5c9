#pragma once

#include <span>
#include <string>
#include <string_view>

#include "cli/app.h"
#include "mindahl/report/page.h"

namespace mindahl::cli {

/// A word as a shell takes it: in single quotes where it needs them.
std::string ShellWord(std::string_view word);

/// The command line as a shell takes it, the program by its own name.
std::string CommandLine(int argc, const char* const* argv);

/// Returns what is needed to make a result again: the command line, the options given there or in a
/// configuration file, and digests of the files.
report::Provenance ProvenanceOf(const CLI::App& command, const std::string& command_line,
                                std::span<const std::string> files);

}  // namespace mindahl::cli
