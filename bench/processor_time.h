#pragma once

#include <time.h>

/// Of the processor, which other programs on the machine disturb less than the clock [s].
inline double ProcessorTime() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}
