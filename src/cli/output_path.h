#pragma once

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>

namespace mindahl::cli {

/// Names the output of an option; an empty path is an output that was not requested.
struct OutputPath {
  std::string_view option;
  const std::string& path;
  bool dash_is_stdout = false;  ///< true if "-" means standard output
};

/// Refuses before the work what could not be written after it: a run with several outputs leaves
/// none behind, takes none for another and none for what it reads.
/// @param inputs  files that the run reads
/// @throws InputError naming the option and the path
void RequireOutputPaths(std::initializer_list<OutputPath> outputs,
                        std::span<const std::string> inputs = {});

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
