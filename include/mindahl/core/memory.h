#pragma once

#include <cstdint>
#include <string>

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

}  // namespace mindahl
