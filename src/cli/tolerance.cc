#include "cli/tolerance.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <system_error>

#include "mindahl/core/error.h"

namespace mindahl::cli {

double ParseTolerance(const std::string& text) {
  const bool percent = text.ends_with('%');
  const char* end = text.data() + text.size() - (percent ? 1 : 0);
  double number = 0.0;
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc() || rest != end || !(number > 0) || !std::isfinite(number)) {
    throw InputError(
        fmt::format("--tolerance '{}' is invalid: must be a number > 0, as 0.01 or 1%", text));
  }
  return percent ? number / 100 : number;
}

}  // namespace mindahl::cli
