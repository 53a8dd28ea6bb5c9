#pragma once

#include <string>
#include <string_view>

#include "report/fields.h"

// Tables of what the commands answer. A row is an object of the JSON, whose members are its cells;
// rows are a list of such or an object of them, whose keys are then the first column. Of a member
// that is an object the members are cells; lists are none. So one maker of rows serves JSON, text,
// CSV and page.
namespace mindahl::report {

/// Returns a cell for people: a number, "yes" or "no", "-" of null.
std::string CellText(const Json& value, int digits = 5);

/// Returns the rows as aligned columns below their names; "" of none.
std::string TableText(const Json& rows, int digits = 5);

/// Returns the rows as CSV with every digit, nothing where a member is null.
std::string TableCsv(const Json& rows);

/// Returns the rows as a table of a page; "" of none.
std::string TableHtml(std::string_view caption, const Json& rows);

}  // namespace mindahl::report
