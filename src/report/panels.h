#pragma once

#include <optional>
#include <string>

#include "mindahl/io/plot.h"
#include "mindahl/report/report.h"

// The figures of a report. None is of a fit that failed.
namespace mindahl::report {

/// Loop and residual over one axis: of samples in the load window where there is one. A record is
/// called by its load where the records differ in it, else by its file.
struct LoopPanels {
  io::PlotPanel loop;
  io::PlotPanel residual;
};

LoopPanels DrawLoop(const Report& report);

/// Returns friction (the slip force without a load), σ and α with their intervals as bars, as
/// elements of an inline SVG of 560 px; α's with 1/3 marked. A bar is green only of what may be
/// quoted. "" where none has a value.
std::string DrawIntervals(const Report& report);
/// Height of that drawing [px].
int HeightOfIntervals(const Report& report);

}  // namespace mindahl::report
