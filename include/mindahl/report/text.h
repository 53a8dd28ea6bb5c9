#pragma once

#include <string>

#include "mindahl/report/report.h"

namespace mindahl::report {

struct TextOptions {
  bool has_colours = false;  ///< escape sequences of a terminal around verdicts and headings
};

/// Returns a text for people; UTF-8, at most 100 columns. The first 24 lines have the verdict, the
/// use, the next step, the contact's parameters and the contact as far as it is known; what that
/// rests on follows. A fit that is of no use has ten lines, and no parameter.
/// @throws InvalidArgument for a fit that failed
std::string ToText(const Report& report, const TextOptions& options = {});

}  // namespace mindahl::report
