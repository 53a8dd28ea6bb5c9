#include "mindahl/core/error.h"

#include <fmt/format.h>

#include <cmath>

namespace mindahl {

void ThrowInvalid(std::string_view quantity, double value, std::string_view rule) {
  throw InvalidArgument(fmt::format("{} = {} is invalid: {}", quantity, value, rule));
}

void RequireFinite(std::string_view quantity, double value) {
  if (!std::isfinite(value)) ThrowInvalid(quantity, value, "must be finite");
}

void RequirePositive(std::string_view quantity, double value) {
  if (!(value > 0) || std::isinf(value)) ThrowInvalid(quantity, value, "must be finite and > 0");
}

void RequireNonNegative(std::string_view quantity, double value) {
  if (!(value >= 0) || std::isinf(value)) ThrowInvalid(quantity, value, "must be finite and >= 0");
}

void RequireSameSize(std::string_view first, std::size_t first_size, std::string_view second,
                     std::size_t second_size) {
  if (first_size != second_size) {
    throw InvalidArgument(fmt::format("{} has {} values and {} has {}: must be equal", first,
                                      first_size, second, second_size));
  }
}

}  // namespace mindahl
