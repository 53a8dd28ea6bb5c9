#pragma once

#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// ReadRecord() of a table.
RecordFile RecordOf(const CsvTable& table, const RecordColumns& columns);

}  // namespace mindahl::io
