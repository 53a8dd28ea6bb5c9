#include "mindahl/core/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/refuse.h"

namespace mindahl {

void ThrowInvalid(std::string_view quantity, double value, std::string_view rule) {
  throw InvalidArgument(fmt::format("{} = {} is invalid: {}", quantity, value, rule));
}

void RequireFinite(std::string_view quantity, double value) {
  if (!std::isfinite(value)) ThrowInvalid(quantity, value, "must be finite");
}

void RequirePositive(std::string_view quantity, double value) {
  if (!(std::isfinite(value) && value > 0)) {
    ThrowInvalid(quantity, value, "must be finite and > 0");
  }
}

void RequireNonNegative(std::string_view quantity, double value) {
  if (!(std::isfinite(value) && value >= 0)) {
    ThrowInvalid(quantity, value, "must be finite and >= 0");
  }
}

void RequireSameSize(std::string_view first, std::size_t first_size, std::string_view second,
                     std::size_t second_size) {
  if (first_size != second_size) {
    throw InvalidArgument(fmt::format("{} has {} values and {} has {}: must be equal", first,
                                      first_size, second, second_size));
  }
}

void RequireOneOf(std::string_view option, std::string_view word,
                  std::span<const std::string_view> words) {
  if (std::ranges::find(words, word) != words.end()) return;
  throw InputError(fmt::format("{}: {}", option, UnknownAmong(word, words)));
}

}  // namespace mindahl
