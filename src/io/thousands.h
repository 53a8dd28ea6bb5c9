#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace mindahl::io {

/// Could a column hold numbers whose mark separates thousands, as "1.234" of 1234? All then lie
/// within ±1000 as they were read, with three decimals at most and none of them below 1.
bool MayHaveThousands(std::span<const double> values);

/// The first cell whose mark separates thousands beyond doubt: every cell is a whole number below
/// 1000, or has one to three digits, the mark and three more, both are there, and the column is
/// smoother, by a factor of two in the squares of its steps over its range, when the mark is left
/// out. (999, 1.000, 1.001 is; 1, 1.125, 1.25 is not.)
/// @param cells  of one column, without blanks around them
std::optional<std::size_t> FindThousands(std::span<const std::string_view> cells);

/// True if all cells are one to three digits, not a 0, a mark and three more digits, so that
/// nothing distinguishes a decimal mark from one that separates thousands.
/// @param cells  likewise
bool AreAllGrouped(std::span<const std::string_view> cells);

}  // namespace mindahl::io
