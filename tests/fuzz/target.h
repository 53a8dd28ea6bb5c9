#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <span>
#include <string_view>

/// What is run on arbitrary bytes: by libFuzzer (scripts/fuzz.sh), and by the tests on a corpus and
/// on pseudo-random mutations of it.
namespace mindahl::fuzz {

using Input = std::span<const std::uint8_t>;

struct Target {
  std::string_view name;  ///< also of its folder in corpus/
  void (*run)(Input);
  std::size_t longest;  ///< bytes, so that the work for an input is bounded
};

/// Returns all of them.
std::span<const Target> Targets();
/// Returns nullptr where there is none of that name.
const Target* FindTarget(std::string_view name);

/// Ends the program where a property does not hold.
inline void Require(bool holds, std::string_view property) {
  if (holds) return;
  std::fprintf(stderr, "fuzz: violated: %.*s\n", static_cast<int>(property.size()),
               property.data());
  std::abort();
}

}  // namespace mindahl::fuzz
