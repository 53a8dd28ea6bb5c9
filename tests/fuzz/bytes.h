#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <string>
#include <vector>

#include "fuzz/target.h"

namespace mindahl::fuzz {

/// Takes values off the front of an input; zeros where it ends.
class Bytes {
 public:
  explicit Bytes(Input input) : rest_(input) {}

  [[nodiscard]] bool empty() const { return rest_.empty(); }

  std::uint8_t Byte() {
    if (rest_.empty()) return 0;
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    return byte;
  }

  std::uint32_t Number(int bytes) {
    std::uint32_t number = 0;
    for (int i = 0; i < bytes; ++i) number = number << 8U | Byte();
    return number;
  }

  /// Returns any double: a small multiple of 1/16, one that a scale of the field has, or eight
  /// bytes as they are, with infinities and NaN among them.
  double Double() {
    const std::uint8_t kind = Byte();
    if (kind < 160) return (static_cast<double>(Byte()) - 128.0) / 16.0;
    if (kind < 200) {
      constexpr std::array kScales = {0.0, 1e-300, 1e-9, 1e-6, 1.0 / 3.0,
                                      1.0, 2.0,    50.0, 1e7,  1e300};
      return kScales[Byte() % kScales.size()];
    }
    const std::uint64_t high = Number(4);
    return std::bit_cast<double>(high << 32U | Number(4));
  }

  std::string Text() {
    std::string text(rest_.begin(), rest_.end());
    rest_ = {};
    return text;
  }

 private:
  Input rest_;
};

}  // namespace mindahl::fuzz
