#pragma once

#include <string>

#include "mindahl/report/report.h"

namespace mindahl::report {

/// For people; UTF-8, at most 100 columns.
/// @throws InvalidArgument for a fit that failed
std::string ToText(const Report& report);

}  // namespace mindahl::report
