#pragma once

#include <fmt/format.h>

#include <cstring>
#include <filesystem>
#include <string>

#include "mindahl/core/error.h"

namespace mindahl::io {

/// A file, or a directory that is empty by then, which goes with this object unless it is kept; and
/// with the program, when RemoveTemporaryFilesOnSignals() was called and a signal ends it.
class TemporaryName {
 public:
  /// Before the file is made: a signal may come in between.
  explicit TemporaryName(std::string name);
  ~TemporaryName();
  TemporaryName(const TemporaryName&) = delete;
  TemporaryName& operator=(const TemporaryName&) = delete;

  void Keep();
  [[nodiscard]] const std::string& name() const { return name_; }

 private:
  std::string name_;
  bool kept_ = false;
};

/// @param error  errno of what failed
/// @throws InputError always
[[noreturn]] inline void ThrowCannotWrite(const std::filesystem::path& path, int error) {
  throw InputError(fmt::format("cannot write '{}': {}", path.string(), std::strerror(error)));
}

/// Passes an error on, if there is one.
inline void RequireWritten(const std::filesystem::path& path, int error) {
  if (error != 0) ThrowCannotWrite(path, error);
}

}  // namespace mindahl::io
