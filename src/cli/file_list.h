#pragma once

#include <string>
#include <vector>

#include "cli/app.h"

namespace mindahl::cli {

/// Names more files than a command line holds, and a part of them for one of many jobs.
struct FileList {
  std::string list;   ///< file that names one a line; "" for none
  std::string shard;  ///< "K/N"; "" for all
};

/// Adds --files-from, beside which FILE is not required.
void AddFilesFrom(CLI::App& command, FileList& options);
void AddShard(CLI::App& command, FileList& options);

/// Returns the named files, then those of the list; of m the K-th of N parts, from the ⌊(K −
/// 1)m/N⌋-th on, so that the parts in order are all of them once.
/// @throws InputError for a list that cannot be read or names none, a shard that is not K/N with
///   1 <= K <= N, and where no file is named
std::vector<std::string> FilesOf(const std::vector<std::string>& named, const FileList& options);

}  // namespace mindahl::cli
