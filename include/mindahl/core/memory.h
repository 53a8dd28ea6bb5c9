#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <memory_resource>
#include <string>
#include <vector>

namespace mindahl {

/// Returns the bytes that this process may have: the least of the machine's memory, the limit of
/// its address space (ulimit -v) and that of its control group (cgroup v2). What others use of the
/// machine's is not taken off.
std::uintmax_t MemoryOfProcess();

/// Returns the message for exhausted memory: how much the process had, and may have.
///   "memory ran out: the process had 612 MB and may have 650 MB"
std::string OutOfMemoryText();

/// Returns "1.2 GB", "650 MB", in powers of 1000.
std::string BytesInWords(std::uintmax_t bytes);

/// Memory that is taken bit by bit and given back all at once: after Reset() what was taken before
/// is free again, in one piece, so that work repeated on data of one size allocates nothing.
/// Not for use by several threads.
class Arena final : public std::pmr::memory_resource {
 public:
  /// Forgets everything that was allocated. Nothing of it may be used, or destroyed, any more.
  void Reset();

  /// Returns the number of bytes held.
  [[nodiscard]] std::size_t capacity() const;

 private:
  struct Block {
    std::unique_ptr<std::byte[]> memory;
    std::size_t size = 0;
    std::size_t used = 0;
  };

  void* do_allocate(std::size_t bytes, std::size_t alignment) override;
  void do_deallocate(void* /*memory*/, std::size_t /*bytes*/, std::size_t /*alignment*/) override {}
  [[nodiscard]] bool do_is_equal(const std::pmr::memory_resource& other) const noexcept override {
    return this == &other;
  }

  std::vector<Block> blocks_;
};

}  // namespace mindahl
