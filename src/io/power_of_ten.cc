#include "io/power_of_ten.h"

#include <array>
#include <cstddef>
#include <string_view>

namespace mindahl::io {

std::string PowerOfTen(int exponent) {
  constexpr std::array<std::string_view, 10> kDigits = {"⁰", "¹", "²", "³", "⁴",
                                                        "⁵", "⁶", "⁷", "⁸", "⁹"};
  std::string text = "10";
  for (const char character : std::to_string(exponent)) {
    text += character == '-' ? "⁻" : kDigits[static_cast<std::size_t>(character - '0')];
  }
  return text;
}

}  // namespace mindahl::io
