#pragma once

#include <initializer_list>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cli/app.h"

namespace mindahl::cli {

/// Writes to a file, whole or not at all, or to standard output for "-".
/// @throws InputError when the file cannot be written
void WriteText(std::string_view text, const std::string& path, Console& console);

/// Writes an answer as JSON to where that is asked for, and as text to standard output, unless the
/// JSON goes there.
/// @param answer  as ToJson() and ToText() take it
template <typename... Answer>
void WriteAnswer(const std::string& json_path, Console& console, const Answer&... answer) {
  if (!json_path.empty()) WriteText(ToJson(answer...), json_path, console);
  if (json_path != "-") console.out << ToText(answer...);
}

/// Names the output of an option; an empty path is an output that was not requested.
struct OutputPath {
  std::string_view option;
  const std::string& path;
  bool dash_is_stdout = false;  ///< true if "-" means standard output
};

/// Refuses before the work what could not be written after it: a run with several outputs leaves
/// none behind, takes none for another and none for what it reads.
/// @param files  that the run reads besides those of the console
/// @throws InputError naming the option and the path
void RequireOutputPaths(std::initializer_list<OutputPath> outputs, const Console& console,
                        const std::vector<std::string>& files = {});

/// @throws InputError where two outputs are one file; an empty path is none
void RequireDistinctOutputs(const OutputPath& first, const OutputPath& second);

/// Refuses a file that is given twice, by one name or by two: its samples would count twice.
/// @throws InputError naming both
void RequireDistinctFiles(std::span<const std::string> files);

/// A table is the work of hours: it is written over only where that is asked for.
/// @param remedy  what to add, for the message
/// @throws InputError where a file is there
void RequireNotThere(const OutputPath& output, std::string_view remedy);

}  // namespace mindahl::cli
