#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <fstream>
#include <iterator>
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
    std::ifstream file(name(), std::ios::binary);
    Require(file.is_open(), "a file in memory can be read");
    return {std::istreambuf_iterator<char>(file), {}};
  }

 private:
  int descriptor_;
};

}  // namespace mindahl::fuzz
