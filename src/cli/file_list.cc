#include "cli/file_list.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iostream>
#include <string_view>
#include <utility>

#include "cli/options.h"
#include "core/from_chars.h"
#include "mindahl/core/error.h"

namespace mindahl::cli {
namespace {

constexpr const char* kFilesGroup = "Files";

std::pair<std::uint64_t, std::uint64_t> ShardOf(const std::string& text) {
  constexpr std::uint64_t kMost = 1'000'000;  // so that no product overflows
  const std::size_t slash = text.find('/');
  if (slash != std::string::npos) {
    const auto part = NumberIn<std::uint64_t>(std::string_view(text).substr(0, slash));
    const auto parts = NumberIn<std::uint64_t>(std::string_view(text).substr(slash + 1));
    if (part && parts && *part >= 1 && *part <= *parts && *parts <= kMost) return {*part, *parts};
  }
  throw InputError(fmt::format(
      "--shard: '{}' is invalid: must be K/N with 1 <= K <= N <= {}, as 2/8", text, kMost));
}

void ReadList(std::istream& stream, std::vector<std::string>& files) {
  for (std::string line; std::getline(stream, line);) {
    if (line.ends_with('\r')) line.pop_back();
    if (!line.empty() && !line.starts_with('#')) files.push_back(line);
  }
}

}  // namespace

void AddFilesFrom(CLI::App& command, FileList& options) {
  OptionGroup(command, kFilesGroup)
      .Add("--files-from", options.list,
           "read further file names from LIST, one a line; lines that are empty or\nbegin with # "
           "are skipped; - is standard input",
           "LIST");
}

void AddShard(CLI::App& command, FileList& options) {
  OptionGroup(command, kFilesGroup)
      .Add("--shard", options.shard,
           "process only the K-th of N parts of the files: the tables of all\nparts, one after the "
           "other, are the table of all files",
           "K/N");
}

std::vector<std::string> FilesOf(const std::vector<std::string>& named, const FileList& options) {
  std::vector<std::string> files = named;
  if (options.list == "-") {
    ReadList(std::cin, files);
  } else if (!options.list.empty()) {
    std::ifstream list(options.list, std::ios::binary);
    if (!list) {
      throw InputError(
          fmt::format("--files-from: cannot read '{}': {}", options.list, std::strerror(errno)));
    }
    ReadList(list, files);
  }
  if (files.empty() && !options.list.empty()) {
    throw InputError(fmt::format("--files-from: '{}' names no file: one a line", options.list));
  }
  if (files.empty()) {
    throw InputError("FILE is required: name files, or a list of them with --files-from");
  }
  if (options.shard.empty()) return files;
  const auto [part, parts] = ShardOf(options.shard);
  const std::uint64_t count = files.size();
  const auto place = [&](std::uint64_t before) {
    return files.begin() + static_cast<std::ptrdiff_t>(before * count / parts);
  };
  return {place(part - 1), place(part)};
}

}  // namespace mindahl::cli
