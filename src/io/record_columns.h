#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "mindahl/core/units.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// RecordOf() of rows the order of whose times is for the caller to judge.
RecordFile RecordOfRows(const CsvTable& table, const RecordColumns& columns);

/// Describes a time before that of the row above, and the remedy: "time = 1.5 s is before …"; ""
/// where there is no fault. Times may be equal: a clock of few digits stands still.
std::string DescribeTimeFault(double time, double time_above, std::string_view unit);

/// Returns the unit of a force, or of the torque that a joint carries.
std::optional<Unit> ForceOrTorqueUnit(std::string_view symbol);

}  // namespace mindahl::io
