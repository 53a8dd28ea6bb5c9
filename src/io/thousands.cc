#include "io/thousands.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string>

namespace mindahl::io {
namespace {

constexpr double kThousand = 1000.0;

/// A whole number below 1000, or one with a mark before its last three digits.
struct Grouped {
  bool has_mark = false;
  double as_read = 0.0;       // the mark a decimal one
  double as_thousands = 0.0;  // the mark left out
};

std::optional<Grouped> ReadGrouped(std::string_view cell) {
  constexpr std::size_t kGroup = 3;
  const bool negative = cell.starts_with('-');
  if (negative || cell.starts_with('+')) cell.remove_prefix(1);
  const std::size_t mark = cell.find_first_of(".,");
  const std::string_view head = cell.substr(0, mark);
  const std::string_view tail =
      mark == std::string_view::npos ? std::string_view() : cell.substr(mark + 1);
  const auto is_digits = [](std::string_view text) {
    return std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
  };
  if (head.empty() || head.size() > kGroup || !is_digits(head) || !is_digits(tail)) {
    return std::nullopt;
  }
  const bool has_mark = mark != std::string_view::npos;
  if (has_mark && (tail.size() != kGroup || head.starts_with('0'))) return std::nullopt;
  int whole = 0;
  int group = 0;
  std::from_chars(head.data(), head.data() + head.size(), whole);
  std::from_chars(tail.data(), tail.data() + tail.size(), group);
  const double sign = negative ? -1.0 : 1.0;
  return Grouped{has_mark, sign * (whole + group / kThousand),
                 sign * (has_mark ? whole * kThousand + group : whole)};
}

/// Squares of the steps from value to value, over the range's.
double Roughness(std::span<const double> values) {
  const auto [least, greatest] = std::ranges::minmax(values);
  if (!(greatest > least)) return 0.0;
  double squares = 0.0;
  for (std::size_t i = 1; i < values.size(); ++i) {
    squares += std::pow((values[i] - values[i - 1]) / (greatest - least), 2);
  }
  return squares;
}

}  // namespace

bool MayHaveThousands(std::span<const double> values) {
  constexpr double kRounding = 1e-6;
  return std::ranges::all_of(values, [](double value) {
    const double size = std::abs(value);
    if (!(size < kThousand)) return false;
    if (size == std::floor(size)) return true;
    return size >= 1 && std::abs(size * kThousand - std::round(size * kThousand)) < kRounding;
  });
}

std::optional<std::size_t> FindThousands(std::span<const std::string_view> cells) {
  constexpr double kSmoother = 2.0;
  std::optional<std::size_t> first;
  bool any_whole = false;
  std::vector<double> as_read;
  std::vector<double> as_thousands;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    const std::optional<Grouped> grouped = ReadGrouped(cells[i]);
    if (!grouped) return std::nullopt;
    if (grouped->has_mark && !first) first = i;
    any_whole = any_whole || !grouped->has_mark;
    as_read.push_back(grouped->as_read);
    as_thousands.push_back(grouped->as_thousands);
  }
  if (!first || !any_whole) return std::nullopt;
  if (!(Roughness(as_read) > kSmoother * Roughness(as_thousands))) return std::nullopt;
  return first;
}

bool AreAllGrouped(std::span<const std::string_view> cells) {
  return std::ranges::all_of(cells, [](std::string_view cell) {
    const std::optional<Grouped> grouped = ReadGrouped(cell);
    return grouped && grouped->has_mark;
  });
}

}  // namespace mindahl::io
