#pragma once

#include <cstddef>
#include <memory>
#include <memory_resource>
#include <vector>

namespace mindahl {

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
