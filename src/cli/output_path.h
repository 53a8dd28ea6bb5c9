#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <system_error>

#include "mindahl/core/error.h"

namespace mindahl::cli {

/// Refuses before the work what could not be written after it: a run with several outputs leaves
/// none behind.
/// @throws InputError naming the option and the path
inline void RequireOutputPath(std::string_view option, const std::string& path) {
  if (path.empty()) throw InputError(fmt::format("{}: the path is empty", option));
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) {
    throw InputError(fmt::format("{}: cannot write '{}': it is a directory", option, path));
  }
  const std::filesystem::path parent = std::filesystem::path(path).parent_path();
  if (!parent.empty() && !std::filesystem::is_directory(parent, ignored)) {
    throw InputError(fmt::format("{}: cannot write '{}': there is no directory '{}'", option, path,
                                 parent.string()));
  }
}

}  // namespace mindahl::cli
