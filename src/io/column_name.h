#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "mindahl/core/units.h"

namespace mindahl::io {

/// Names what a column may be.
enum class Role { kDisplacement, kForce, kTime, kNormalLoad, kOther, kFrictionCoefficient };

/// True if a quantity of that dimension may have the role.
bool MayHaveRole(std::optional<Dimension> dimension, Role role);
/// Returns the dimension of a unit; none of one that is not known.
std::optional<Dimension> DimensionOf(std::string_view symbol);

/// Holds what the words of a name say; those of words.h.
struct NameEvidence {
  std::string_view word = {};  ///< the best; "" where none is known
  Role role = Role::kOther;
  int rank = 0;
  bool is_angular = false;  // of an angle or a torque
  bool is_lesser = false;   ///< commanded, raw or a statistic
  std::size_t other_words = 0;

  /// True if it is a word of the role.
  [[nodiscard]] bool names(Role other) const { return !word.empty() && role == other; }
};

/// A header cell taken apart: "Time [s]" is the name "Time" with the unit "s".
struct ColumnName {
  std::string name = {};
  std::string unit = {};  // as written; empty when the header names none
  NameEvidence evidence = {};
};

/// Takes the unit off a header cell:
///   x [um]   F (kN)   F [kN] left   a unit in brackets; at the end also a word that is none known
///   Position, mm   x / mm           a unit behind a comma or a slash
///   disp_mm   pos_mm_filtered       a unit of what the name is among its words; of a single letter
///                                   the last word
/// Brackets without a unit, "pos (3)" and "Load [23.8 N]", are part of the name. A factor beside a
/// unit, a range in another unit than the SI one, and a word for a ratio, make a unit that is none:
/// "mm x1000", "5 kN", "normalized".
ColumnName SplitColumnName(std::string_view header);

/// The text in brackets, or the cell itself: "[mm]", "(mm)" and "mm" are "mm".
std::string_view WithoutBrackets(std::string_view cell);

/// True for the symbol of a unit usual in such files (mm, N, V, bar...), and for a word in
/// brackets.
bool LooksLikeUnit(std::string_view cell);

/// Returns how many of the header cells have a word or a unit that is known.
std::size_t CountKnownWords(std::span<const std::string> cells);

}  // namespace mindahl::io
