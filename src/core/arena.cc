#include "mindahl/core/arena.h"

#include <algorithm>

namespace mindahl {

void Arena::Reset() {
  if (blocks_.size() > 1) {
    const std::size_t size = capacity();
    blocks_.clear();
    blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(size), size, 0});
  }
  for (Block& block : blocks_) block.used = 0;
}

std::size_t Arena::capacity() const {
  std::size_t size = 0;
  for (const Block& block : blocks_) size += block.size;
  return size;
}

void* Arena::do_allocate(std::size_t bytes, std::size_t alignment) {
  constexpr std::size_t kFirstBlock = std::size_t{1} << 16;
  if (!blocks_.empty()) {
    Block& last = blocks_.back();
    void* place = last.memory.get() + last.used;
    std::size_t room = last.size - last.used;
    if (std::align(alignment, bytes, place, room) != nullptr) {
      last.used = last.size - room + bytes;
      return place;
    }
  }
  const std::size_t size = std::max({kFirstBlock, bytes + alignment, capacity()});
  blocks_.push_back({std::make_unique_for_overwrite<std::byte[]>(size), size, 0});
  return do_allocate(bytes, alignment);
}

}  // namespace mindahl
