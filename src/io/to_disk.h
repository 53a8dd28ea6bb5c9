#pragma once

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>

#include "io/write_fault.h"

namespace mindahl::io {

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
