#pragma once

#include <string>
#include <vector>

#include "bindings.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::python {

using io::NamedRecord;

/// Makes columns of arrays, a name each.
std::vector<io::NamedColumn> ColumnsOfArrays(const std::vector<std::string>& names,
                                             const std::vector<Array>& arrays);

}  // namespace mindahl::python
