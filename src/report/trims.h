#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mindahl/loop/trim.h"
#include "mindahl/report/report.h"
#include "report/field.h"

namespace mindahl::report {

/// What was left out of the records as no part of their test, and why no more, in a note each; none
/// where that was not asked for.
std::vector<Warning> TrimNotes(const Report& report);

/// One part that was left out of a record.
struct TrimmedItem {
  std::string file;
  loop::TrimmedPart part;
  std::size_t first_line = 0;  ///< of the file, counted from 1
  std::size_t last_line = 0;
};

/// Of all records, in order.
std::vector<TrimmedItem> TrimmedItems(const Report& report);

const std::vector<Field<TrimmedItem>>& TrimmedFields();

}  // namespace mindahl::report
