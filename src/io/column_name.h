#pragma once

#include <string>
#include <string_view>

namespace mindahl::io {

/// A header cell taken apart: "Time [s]" is the name "Time" with the unit "s".
struct ColumnName {
  std::string name;
  std::string unit;  ///< unit as written; empty when the header names none
};

/// Takes the unit off a header cell:
///   x [um]   F (kN)     any text in brackets at the end
///   Position, mm        a word of at most 8 bytes after the last comma
///   x / mm              a word of at most 8 bytes after the first slash
///   disp_mm   Force N   after the last underscore or blank, a symbol that core/units.h knows
ColumnName SplitColumnName(std::string_view header);

/// The text in brackets, or the cell itself: "[mm]", "(mm)" and "mm" are "mm".
std::string_view WithoutBrackets(std::string_view cell);

/// True for a bracketed text and for the symbol of a unit usual in such files (mm, N, s, V,
/// bar...).
bool LooksLikeUnit(std::string_view cell);

}  // namespace mindahl::io
