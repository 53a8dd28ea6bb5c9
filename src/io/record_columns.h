#pragma once

#include <string>
#include <string_view>

#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// RecordOf() of rows the order of whose times is for the caller to judge.
RecordFile RecordOfRows(const CsvTable& table, const RecordColumns& columns);

/// What is wrong with a time before that of the row above, and what to do: "time = 1.5 s is before
/// …"; "" where nothing is. Times may be equal: a clock of few digits stands still.
std::string DescribeTimeFault(double time, double time_above, std::string_view unit);

}  // namespace mindahl::io
