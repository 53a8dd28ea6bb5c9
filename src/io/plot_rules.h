#pragma once

#include <string>

#include "mindahl/io/plot.h"

namespace mindahl::io {

/// True if a series of that style has lower and upper ends.
constexpr bool HasEnds(PlotStyle style) {
  return style == PlotStyle::kIntervals || style == PlotStyle::kBand;
}

/// @param where  the panel, for messages
/// @throws InvalidArgument naming the panel and series for what WritePlot() does not draw
void RequireDrawable(const PlotPanel& panel, const std::string& where);

}  // namespace mindahl::io
