#pragma once

#include <span>
#include <string>
#include <vector>

namespace mindahl::io {

/// A column of numbers. The values must outlive what it is given to.
struct CsvColumn {
  std::string name;  ///< with its unit, e.g. "displacement [m]"
  std::span<const double> values;
};

/// Returns a text as one cell, quoted when it must be: RFC 4180 §2.6, and a '#' or a blank at an
/// end, or nothing at all, which a reader would take for its own.
std::string CsvCell(const std::string& text);

/// Returns the columns as CSV text (RFC 4180, with LF at line ends): a header, then one row a
/// value, with 17 significant digits so that every double reads back as itself. NaN, a value that
/// is not known, is an empty cell.
/// @param columns  at least one; all of one length
/// @throws InvalidArgument when lengths differ, there is no column, or a value is infinite
std::string CsvText(const std::vector<CsvColumn>& columns);

}  // namespace mindahl::io
