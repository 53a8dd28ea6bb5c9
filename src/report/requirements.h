#pragma once

#include <fmt/format.h>

#include <string_view>

#include "mindahl/core/error.h"
#include "mindahl/report/report.h"

namespace mindahl::report {

/// @throws InvalidArgument for a fit that failed: it has no curve to draw and no residual to list
inline void RequireFitted(const Report& report, std::string_view what) {
  if (!report.failed()) return;
  throw InvalidArgument(fmt::format("there is nothing to make {} of: the fit failed: {}", what,
                                    report.fit.solver.message));
}

}  // namespace mindahl::report
