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

}  // namespace mindahl
