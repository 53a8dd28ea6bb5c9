#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "mindahl/loop/segments.h"
#include "mindahl/report/report.h"

namespace mindahl::report {

template <typename Item>
struct Field;

/// Returns a note for each part left out of the records as not of their test, and for why no more
/// was; none where it was not requested.
std::vector<Warning> TrimNotes(const Report& report);

struct TrimmedItem {
  std::string file;
  loop::TrimmedPart part;
  std::size_t first_line = 0;  ///< line of the file, counted from 1
  std::size_t last_line = 0;
};

std::vector<TrimmedItem> TrimmedItems(const Report& report);

const std::vector<Field<TrimmedItem>>& TrimmedFields();

}  // namespace mindahl::report
