#include <cstdlib>

#include "fuzz/target.h"

// What libFuzzer calls; MINDAHL_FUZZ_TARGET names the target.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  static const mindahl::fuzz::Target& target = []() -> const auto& {
    const char* const name = std::getenv("MINDAHL_FUZZ_TARGET");
    mindahl::fuzz::Require(name != nullptr, "MINDAHL_FUZZ_TARGET is set");
    return mindahl::fuzz::FindTarget(name);
  }
  ();
  if (size > target.longest) return -1;
  target.run({bytes, size});
  return 0;
}
