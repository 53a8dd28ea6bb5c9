#pragma once

#include "mindahl/io/plot.h"
#include "mindahl/report/report.h"
#include "report/fields.h"

// The figures of a report. None is of a fit that failed.
namespace mindahl::report {

/// Loop and residual over one axis: of samples in the load window where there is one. A record is
/// called by its load where the records differ in it, else by its file.
struct LoopPanels {
  io::PlotPanel loop;
  io::PlotPanel residual;
};

LoopPanels DrawLoop(const Report& report);

/// Returns friction (the slip force without a load), σ and α with their intervals as bars:
/// `elements` of an inline SVG 560 px wide, and its `height`; α's with 1/3 marked. A bar is green
/// only of what may be quoted. Null where none has a value.
Json DrawIntervals(const Report& report);

}  // namespace mindahl::report
