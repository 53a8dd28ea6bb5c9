#pragma once

#include <string>

#include "mindahl/report/report.h"

namespace mindahl::report {

/// Returns the measured and fitted force of every sample, as CSV. With several records the first
/// column numbers them; time is there where every record has it.
/// @throws InvalidArgument for a fit that failed
std::string ResidualsCsv(const Report& report);

}  // namespace mindahl::report
