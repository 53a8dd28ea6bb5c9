#include "io/plot_rules.h"

#include <fmt/format.h>

#include <vector>

#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

void RequireNumbers(const std::string& name, const std::vector<double>& values, bool logarithmic) {
  for (const double value : values) {
    RequireFinite(name, value);
    if (logarithmic && value <= 0) ThrowInvalid(name, value, "must be > 0 on a logarithmic axis");
  }
}

}  // namespace

void RequireDrawable(const PlotPanel& panel, const std::string& where) {
  RequirePositive("height of " + where, panel.height);
  if (panel.series.empty()) throw InvalidArgument(where + " has no series: must have one");
  for (const PlotSeries& series : panel.series) {
    const std::string name = fmt::format("'{}' of {}", series.label, where);
    RequireSameSize("x of " + name, series.x.size(), "y of " + name, series.y.size());
    if (series.x.empty()) throw InvalidArgument(name + " has no points: must have one");
    RequireNumbers("x of " + name, series.x, panel.log_x);
    RequireNumbers("y of " + name, series.y, panel.log_y);
    if (!HasEnds(series.style)) continue;
    for (const auto* ends : {&series.lower, &series.upper}) {
      RequireSameSize("ends of intervals of " + name, ends->size(), "points", series.y.size());
      RequireNumbers("ends of intervals of " + name, *ends, panel.log_y);
    }
  }
  for (const PlotMark& mark : panel.marks) {
    RequireNumbers(fmt::format("mark '{}' of {}", mark.label, where), {mark.x}, panel.log_x);
  }
}

}  // namespace mindahl::io
