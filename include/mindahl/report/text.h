#pragma once

#include <string>

#include "mindahl/report/report.h"

namespace mindahl::report {

struct TextOptions {
  bool has_colours = false;  ///< escape sequences of a terminal around verdicts and headings
};

/// Returns a text for people; UTF-8, at most 100 columns. First what is to be read in ten seconds:
/// does the model describe the record, the parameters in units that suit them, the contact as far
/// as it is known; then what that rests on.
/// @throws InvalidArgument for a fit that failed
std::string ToText(const Report& report, const TextOptions& options = {});

}  // namespace mindahl::report
