#include "mindahl/report/figure.h"

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "mindahl/report/quantity.h"
#include "report/panels.h"
#include "report/requirements.h"
#include "report/statements.h"

namespace mindahl::report {

using identification::FitResult;
using identification::Identifiability;
using identification::ParameterEstimate;
using identification::ParameterStatus;

namespace {

/// Returns a parameter by its sign: no number of what is not known.
std::string ParameterText(const char* sign, const ParameterEstimate& estimate) {
  if (estimate.status == ParameterStatus::kFixed) {
    return fmt::format("{} = {}, held", sign, Quantity(estimate.value, estimate.unit));
  }
  if (estimate.is_known()) {
    return fmt::format("{} = {}", sign,
                       QuantityWithError(estimate.value, estimate.standard_error, estimate.unit));
  }
  if (estimate.identifiability == Identifiability::kBoundedBelow && estimate.lower95) {
    return fmt::format("{} > {}", sign, Quantity(*estimate.lower95, estimate.unit, 3));
  }
  return fmt::format("{} not known", sign);
}

std::string FindingsOf(const Report& report) {
  const FitResult& fit = report.fit;
  return fmt::format("{}: {}, {}, {}", fit.model->name, ParameterText("σ", *fit.Find("sigma")),
                     ParameterText("α", *fit.Find("alpha")),
                     ParameterText("Tc", *fit.Find("slip_force")));
}

}  // namespace

io::Plot ToPlot(const Report& report) {
  RequireFitted(report, "a figure");
  io::Plot plot;
  plot.title = TitleOf(report);
  plot.subtitle = FindingsOf(report);
  const PanelUnits units = PlainUnits(report);
  plot.panels = {LoopPanel(report, units, LoopColours::kOneARecord),
                 ResidualAlongStroke(report, units, LoopColours::kOneARecord)};
  std::vector<io::PlotPanel> over_load = LoadPanels(report, units);
  if (!over_load.empty()) {
    constexpr int kTaller = 200;  // [px] a panel
    plot.height += kTaller * static_cast<int>(over_load.size());
    if (over_load.size() > 1) over_load.front().x_label.clear();
    for (io::PlotPanel& panel : over_load) plot.panels.push_back(std::move(panel));
  }
  return plot;
}

}  // namespace mindahl::report
