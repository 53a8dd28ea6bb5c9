#include <cstdlib>

#include "fuzz/target.h"

// What libFuzzer calls; MINDAHL_FUZZ_TARGET names the target.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const mindahl::fuzz::Target* const target = [] {
    const char* const name = std::getenv("MINDAHL_FUZZ_TARGET");
    mindahl::fuzz::Require(name != nullptr, "MINDAHL_FUZZ_TARGET is set");
    const mindahl::fuzz::Target* const found = mindahl::fuzz::FindTarget(name);
    mindahl::fuzz::Require(found != nullptr, "MINDAHL_FUZZ_TARGET is the name of a target");
    return found;
  }();
  if (size > target->longest) return -1;
  target->run({bytes, size});
  return 0;
}
