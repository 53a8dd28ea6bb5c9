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
/// configuration file, and digests of the files, that of the configuration among them.
report::Provenance ProvenanceOf(const CLI::App& command, const Console& console,
                                std::span<const std::string> files);

/// Returns the provenance of one file of a batch: the `fit` that does the same to it alone.
report::Provenance ProvenanceOfOneFit(const CLI::App& batch, const Console& console,
                                      const std::string& file);

}  // namespace mindahl::cli
