#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "io/expression.h"
#include "mindahl/core/units.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"

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

/// Holds what the user gives for each role.
struct GivenColumns {
  Expression displacement, force, time, normal_load;
};
GivenColumns ReadGivenColumns(const CsvTable& table, const RecordColumns& columns);

/// RecordOf() of rows the order of whose times is for the caller to judge.
RecordFile RecordOfRows(const CsvTable& table, const RecordColumns& columns);

/// Describes a time before that of the row above, and the remedy: "time = 1.5 s is before …"; ""
/// where there is no fault. Times may be equal: a clock of few digits stands still.
std::string DescribeTimeFault(double time, double time_above, std::string_view unit);

/// Returns the unit of a force, or of the torque that a joint carries.
std::optional<Unit> ForceOrTorqueUnit(std::string_view symbol);

}  // namespace mindahl::io
