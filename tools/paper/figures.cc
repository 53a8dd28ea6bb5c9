#include "figures.h"

#include <fmt/format.h>

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "mindahl/io/csv_table.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "responses.h"

namespace mindahl::paper {

using io::PlotSeries;
using io::PlotStyle;
using models::Excitation;

namespace {

constexpr double kNanometres = 1e9;  // per metre
constexpr const char* kDisplacementLabel = "displacement δ [nm]";
constexpr const char* kTimeLabel = "time t [s]";
constexpr const char* kForceLabel = "tangential force T [N]";

using Values = std::vector<double>;

Values InNanometres(Values metres) {
  for (double& value : metres) value *= kNanometres;
  return metres;
}

PlotSeries Line(std::string label, const Values& x, const Values& y) {
  return {.label = std::move(label), .x = x, .y = y};
}

/// Every stride-th sample.
PlotSeries Marks(std::string label, const Values& x, const Values& y, std::size_t stride) {
  PlotSeries marks{.label = std::move(label), .style = PlotStyle::kPoints};
  for (std::size_t i = 0; i < x.size(); i += stride) {
    marks.x.push_back(x[i]);
    marks.y.push_back(y[i]);
  }
  return marks;
}

/// About forty dots, at other phases in every cycle, for a curve that lies on another.
PlotSeries Markers(std::string label, const Values& x, const Values& y) {
  return Marks(std::move(label), x, y, x.size() / 43);
}

/// ±y, dotted.
PlotSeries DotsOnBothSides(std::string label, const Values& x, const Values& y) {
  PlotSeries dots = Marks(std::move(label), x, y, 25);
  for (std::size_t i = dots.x.size(); i-- > 0;) {
    dots.x.push_back(dots.x[i]);
    dots.y.push_back(-dots.y[i]);
  }
  return dots;
}

PlotSeries GrossSlip(const Excitation& excitation) {
  const Values level(excitation.time.size(), kNanometres * GrossSlipDisplacement(kContact));
  return DotsOnBothSides("gross slip ±δc", excitation.time, level);
}

io::PlotPanel Panel(std::string x_label, std::string y_label, std::vector<PlotSeries> series,
                    double height = 1.0) {
  io::PlotPanel panel;
  panel.x_label = std::move(x_label);
  panel.y_label = std::move(y_label);
  panel.series = std::move(series);
  panel.height = height;
  return panel;
}

void Write(const std::filesystem::path& directory, int figure,
           const std::vector<io::CsvColumn>& columns, io::Plot plot) {
  const std::string stem = fmt::format("paper_fig{}", figure);
  plot.title = fmt::format("Fig. {}: {}", figure, plot.title);
  io::WriteFileAtomically(directory / (stem + ".csv"), io::CsvText(columns));
  io::WritePlot(plot, directory / (stem + ".png"));
}

void WriteSines(const std::filesystem::path& directory) {
  const Excitation micro = Sine(kMicroSlip, 5);
  const Excitation macro = Sine(kMacroSlip, 5);
  const auto panel = [](const Excitation& excitation, double lambda) {
    return Panel(kTimeLabel, kDisplacementLabel,
                 {Line(fmt::format("λ = {}", lambda), excitation.time,
                       InNanometres(excitation.displacement)),
                  GrossSlip(excitation)});
  };
  Write(directory, 3,
        {{"time [s]", micro.time},
         {"micro-slip displacement [m]", micro.displacement},
         {"macro-slip displacement [m]", macro.displacement}},
        {.title = "imposed displacement, micro- and macro-slip",
         .panels = {panel(micro, kMicroSlip), panel(macro, kMacroSlip)}});
}

/// Figs 4-6. A curve keeps its place, and so its colour, in both panels: Mindlin's is zero error.
void WriteSineResponse(const std::filesystem::path& directory, int figure, double lambda,
                       double cycles) {
  const Excitation sine = Sine(lambda, cycles);
  const Values mindlin = MindlinForce(sine);
  const Values full = FullDahlForce(ExactLaw(), sine);
  const Values simplified = SimplifiedDahlForce(ExactLaw(), sine);
  const Values rounded = FullDahlForce(PrintedLaw(), sine);
  const Values full_error = PercentOfPeak(sine, full, mindlin);
  const Values simplified_error = PercentOfPeak(sine, simplified, mindlin);
  const Values rounded_error = PercentOfPeak(sine, rounded, mindlin);
  const Values x = InNanometres(sine.displacement);
  const Values zero(x.size(), 0.0);
  Write(directory, figure,
        {{"time [s]", sine.time},
         {"displacement [m]", sine.displacement},
         {"Mindlin force [N]", mindlin},
         {"Full-Dahl force [N]", full},
         {"Simplified-Dahl force [N]", simplified},
         {"Full-Dahl of 4.839e8 N/m force [N]", rounded},
         {"Full-Dahl error [% of T*]", full_error},
         {"Simplified-Dahl error [% of T*]", simplified_error},
         {"Full-Dahl of 4.839e8 N/m error [% of T*]", rounded_error}},
        {.title = fmt::format("λ = {}, {:g} cycle{}", lambda, cycles, cycles > 1 ? "s" : ""),
         .panels = {
             Panel(kDisplacementLabel, kForceLabel,
                   {Line("Mindlin", x, mindlin), Line("Simplified-Dahl", x, simplified),
                    Markers("Full-Dahl", x, full)},
                   1.4),
             Panel(kTimeLabel, "T − Mindlin [% of T*]",
                   {Line("", sine.time, zero), Line("Simplified-Dahl", sine.time, simplified_error),
                    Markers("Full-Dahl", sine.time, full_error),
                    Line("Full-Dahl, printed σ", sine.time, rounded_error)})}});
}

void WriteGrowingSine(const std::filesystem::path& directory) {
  const Excitation growing = GrowingSine();
  Write(directory, 7,
        {{"time [s]", growing.time},
         {"displacement [m]", growing.displacement},
         {"envelope [m]", growing.envelope}},
        {.title = fmt::format("growing sine, {:g} to {:g} δc in {:g} cycles",
                              kLastEnvelope / kGrowth, kLastEnvelope, kGrowingCycles),
         .panels = {
             Panel(kTimeLabel, kDisplacementLabel,
                   {Line("displacement", growing.time, InNanometres(growing.displacement)),
                    DotsOnBothSides("envelope ±δ*", growing.time, InNanometres(growing.envelope)),
                    GrossSlip(growing)})}});
}

/// Fig. 8, and below it what the paper lacks: the errors against the response that remembers.
void WriteGrowingSineResponse(const std::filesystem::path& directory) {
  const Excitation growing = GrowingSine();
  const Values mindlin = MindlinForce(growing);
  const Values full = FullDahlForce(ExactLaw(), growing);
  const Values simplified = SimplifiedDahlForce(ExactLaw(), growing);
  const Values exact = RememberingForce("mindlin", growing);
  const auto error = [&](const Values& force, const Values& reference) {
    return PercentOfPeak(growing, force, reference);
  };
  const Values full_error = error(full, mindlin);
  const Values simplified_error = error(simplified, mindlin);
  const Values mindlin_cost = error(mindlin, exact);
  const Values full_cost = error(full, exact);
  const Values simplified_cost = error(simplified, exact);
  const Values x = InNanometres(growing.displacement);
  const Values& time = growing.time;
  const Values zero(x.size(), 0.0);
  Write(directory, 8,
        {{"time [s]", time},
         {"displacement [m]", growing.displacement},
         {"envelope [m]", growing.envelope},
         {"Mindlin force [N]", mindlin},
         {"Full-Dahl force [N]", full},
         {"Simplified-Dahl force [N]", simplified},
         {"exact memory force [N]", exact},
         {"Full-Dahl error against Mindlin [% of T*]", full_error},
         {"Simplified-Dahl error against Mindlin [% of T*]", simplified_error},
         {"Mindlin error against exact memory [% of T*]", mindlin_cost},
         {"Full-Dahl error against exact memory [% of T*]", full_cost},
         {"Simplified-Dahl error against exact memory [% of T*]", simplified_cost}},
        {.title = "growing sine, δ* and T* from the envelope",
         .panels = {Panel(kDisplacementLabel, kForceLabel,
                          {Line("Mindlin", x, mindlin), Line("Simplified-Dahl", x, simplified),
                           Line("exact memory", x, exact), Markers("Full-Dahl", x, full)},
                          2.0),
                    Panel("", "T − Mindlin [%]",
                          {Line("", time, zero), Line("Simplified-Dahl", time, simplified_error),
                           Line("exact memory", time, error(exact, mindlin)),
                           Markers("Full-Dahl", time, full_error)}),
                    Panel(kTimeLabel, "T − exact [%]",
                          {Line("Mindlin", time, mindlin_cost),
                           Line("Simplified-Dahl", time, simplified_cost), Line("", time, zero),
                           Line("Full-Dahl", time, full_cost)})}});
}

}  // namespace

void WriteFigures(const std::filesystem::path& directory) {
  WriteSines(directory);
  WriteSineResponse(directory, 4, kMicroSlip, 1);
  WriteSineResponse(directory, 5, kMicroSlip, 5);
  WriteSineResponse(directory, 6, kMacroSlip, 1);
  WriteGrowingSine(directory);
  WriteGrowingSineResponse(directory);
}

}  // namespace mindahl::paper
