#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/app.h"
#include "mindahl/report/page.h"

namespace mindahl::cli {

/// Writes to a file, whole or not at all, or to standard output for "-".
/// @throws InputError when the file cannot be written
void WriteText(std::string_view text, const std::string& path, Console& console);

/// Says sentences on standard error.
/// @param what  "fit: note"
void Say(std::string_view what, const std::vector<std::string>& sentences, Console& console);

/// Writes an answer as JSON to where that is asked for, and as text to standard output, unless the
/// JSON goes there.
void WriteAnswer(const std::string& json_path, Console& console, std::string_view json,
                 std::string_view text);

/// Lets a command run, once it refused what could not be written after the work: a run with several
/// outputs leaves none behind, takes none for another and none for what it reads. An option whose
/// value is called PATH or DIR writes there, "-" to standard output; one called FILE is read.
void OnRun(CLI::App& command, std::function<void()> run);

/// Returns the files that a command was given to read, a configuration the last.
std::vector<std::string> InputsOf(const CLI::App& command);

/// Refuses a file that is given twice, by one name or by two: its samples would count twice.
/// @throws InputError naming both
void RequireDistinctFiles(std::span<const std::string> files);

/// A table is the work of hours: it is written over only where that is asked for.
/// @param remedy  what to add, for the message
/// @throws InputError where a file is there
void RequireNotThere(std::string_view option, const std::string& path, std::string_view remedy);

/// A word as a shell takes it: in single quotes where it needs them.
std::string ShellWord(std::string_view word);

/// The command line as a shell takes it, the program by its own name.
std::string CommandLine(int argc, const char* const* argv);

/// Returns what is needed to make a result again: the command line, the options given there or in a
/// configuration file, and digests of the files.
report::Provenance ProvenanceOf(const CLI::App& command, const std::string& command_line,
                                std::span<const std::string> files);

}  // namespace mindahl::cli
