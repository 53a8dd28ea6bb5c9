#pragma once

#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>
#include <string_view>

#include "fuzz/target.h"

namespace mindahl::fuzz {

/// A file of the memory that has a name, for what reads and writes files.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view content) : descriptor_(::memfd_create("fuzz", MFD_CLOEXEC)) {
    Require(descriptor_ >= 0, "a file in memory can be made");
    const ssize_t written = ::write(descriptor_, content.data(), content.size());
    Require(written == static_cast<ssize_t>(content.size()), "a file in memory can be written");
  }
  ~MemoryFile() { ::close(descriptor_); }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  [[nodiscard]] std::string name() const { return "/proc/self/fd/" + std::to_string(descriptor_); }

  [[nodiscard]] std::string Content() const {
    struct stat status {};
    Require(::fstat(descriptor_, &status) == 0, "a file in memory has a size");
    std::string content(static_cast<std::size_t>(status.st_size), '\0');
    const ssize_t read = ::pread(descriptor_, content.data(), content.size(), 0);
    Require(read == static_cast<ssize_t>(content.size()), "a file in memory can be read");
    return content;
  }

 private:
  int descriptor_;
};

}  // namespace mindahl::fuzz
