#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "mindahl/campaign/cycle_fit.h"

namespace mindahl::campaign {

/// A column of numbers of the table, and where a fit has them.
struct CycleNumber {
  std::string_view name;
  std::string_view unit;  ///< in a record of forces; "" for a pure number
  std::optional<double>& (*of)(CycleFit&) = nullptr;
};

/// Returns all of them, in the order of the table.
std::span<const CycleNumber> CycleNumbers();

/// Returns the first line of a table of cycles: the columns with their units.
/// @param is_torsional  of torques against angles
std::string CycleTableHeader(bool is_torsional);

/// Returns one line of it (RFC 4180, LF): numbers with as many digits as read back the same double,
/// an empty cell for what is not known, flags separated by blanks.
/// @param accumulated_energy  [J] dissipated up to the end of the cycle
std::string CycleTableRow(const CycleFit& fit, double accumulated_energy);

/// Holds what is read back from a line of the table: the inverse of CycleTableRow().
struct CycleTableEntry {
  CycleFit fit;  ///< with numbers and flags, as far as the table has them
  double accumulated_energy = 0.0;
};

/// @param line  without its end
/// @throws InputError where it is no line of such a table, saying why
CycleTableEntry ReadCycleTableRow(std::string_view line);

}  // namespace mindahl::campaign
