#pragma once

#include "mindahl/io/plot.h"
#include "mindahl/report/report.h"

namespace mindahl::report {

/// Plots the measured and fitted loop, with the residual along the displacement below: of samples
/// in the load window where there is one.
/// @throws InvalidArgument for a fit that failed
io::Plot ToPlot(const Report& report);

}  // namespace mindahl::report
