#pragma once

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
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

/// Waits until a file or a directory is on the disk, so that it survives a loss of power. A file
/// system that has no such request (EINVAL) is left to itself.
/// @param path  by which the user knows what is written, for the message
/// @throws InputError "cannot write '<path>': <reason>"
inline void WriteToDisk(int descriptor, const std::filesystem::path& path) {
  if (::fsync(descriptor) != 0 && errno != EINVAL) ThrowCannotWrite(path, errno);
}

/// WriteToDisk() of the directory that holds the file, which has its name.
inline void WriteNameToDisk(const std::filesystem::path& file, const std::filesystem::path& path) {
  const std::filesystem::path parent = file.parent_path();
  const int directory =
      ::open(parent.empty() ? "." : parent.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  // One that may be written to and not read, EACCES, cannot be synchronised.
  if (directory < 0 && errno == EACCES) return;
  if (directory < 0) ThrowCannotWrite(path, errno);
  const int failed = ::fsync(directory) != 0 && errno != EINVAL ? errno : 0;
  ::close(directory);
  if (failed != 0) ThrowCannotWrite(path, failed);
}

}  // namespace mindahl::io
