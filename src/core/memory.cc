#include "mindahl/core/memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "core/platform.h"

namespace mindahl {

std::uintmax_t MemoryOfProcess() {
  std::uintmax_t least = std::min(MemoryOfMachine(), MemoryLimit());
  std::uintmax_t of_group = 0;  // no number where the file says "max"
  if (std::ifstream("/sys/fs/cgroup/memory.max") >> of_group) least = std::min(least, of_group);
  return least;
}

std::string OutOfMemoryText() {
  return fmt::format("memory ran out: the process had {} and may have {}",
                     BytesInWords(PeakMemory()), BytesInWords(MemoryOfProcess()));
}

std::string BytesInWords(std::uintmax_t bytes) {
  constexpr double kMegabyte = 1e6;
  constexpr double kGigabyte = 1e9;
  const auto size = static_cast<double>(bytes);
  return size < kGigabyte ? fmt::format("{:.3g} MB", size / kMegabyte)
                          : fmt::format("{:.3g} GB", size / kGigabyte);
}

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
