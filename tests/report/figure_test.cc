
#include <map>
#include <numeric>

#include "mindahl/report/report.h"
#include "report/made_report.h"
#include "report/panels.h"
#include "support/prelude.h"

namespace mindahl::report::figure_test {
namespace {

using namespace loop;
using namespace io;

using report::ToPlot;

/// Metres to the unit that the axis names.
double PerMetre(const std::string& label) {
  const std::map<std::string, double> units = {{"displacement [nm]", 1e9},
                                               {"displacement [µm]", 1e6},
                                               {"displacement [mm]", 1e3},
                                               {"displacement [m]", 1.0}};
  return units.at(label);
}

TEST(Figure, DrawsDisplacementsInTheUnitThatItsAxisNames) {
  for (const double amplitude : {3e-9, 0.9e-6, 2e-6, 0.9e-3, 2e-3, 0.9, 2.0}) {
    SCOPED_TRACE(amplitude);
    const Record record = MadeRecord(amplitude);
    const Plot plot = ToPlot(report::MakeReport(MadeInput({record}, amplitude)));
    ASSERT_THAT(plot.panels, SizeIs(2));
    const double per_metre = PerMetre(plot.panels[1].x_label);
    // The unit in which the extent is from 1 to 1000, as far as there is one.
    EXPECT_GE(per_metre * amplitude, amplitude < 1e-6 ? 0.0 : 0.9);
    EXPECT_LT(per_metre * amplitude, 1000.0);
    for (const PlotPanel& panel : plot.panels) {
      for (const PlotSeries& series : panel.series) {
        if (series.label == "reversals") continue;
        ASSERT_THAT(series.x, SizeIs(record.size()));
        for (std::size_t i = 0; i < record.size(); ++i) {
          EXPECT_EQ(series.x[i], per_metre * record.displacement[i]);
        }
      }
    }
  }
}

TEST(Figure, HasMeasuredAndFittedForceAboveTheResidual) {
  const report::Report report = report::MakeReport(MadeInput());
  const Plot plot = ToPlot(report);
  ASSERT_THAT(plot.panels[0].series, SizeIs(3));
  EXPECT_EQ(plot.panels[0].series[0].y, report.records[0].record.force);
  EXPECT_EQ(plot.panels[0].series[1].y, report.fit.records[0].fitted_force);
  ASSERT_THAT(plot.panels[1].series, SizeIs(1));
  EXPECT_EQ(plot.panels[1].series[0].y, report.fit.records[0].residual);
}

TEST(Figure, LeavesResidualsOutsideTheLoadWindowOut) {
  Record record = MadeRecord(1e-6, 5);
  record.normal_load = {90, 100, 110, 100, 80};
  report::ReportInput input = MadeInput({record}, 1e-6);
  input.load_window = {95, 105};
  const Plot plot = ToPlot(report::MakeReport(std::move(input)));
  // The made residuals are eighths of the sample's number.
  EXPECT_THAT(plot.panels[1].series[0].y, ElementsAre(0.125, 0.375));
  EXPECT_THAT(plot.panels[0].series[0].x, SizeIs(5));
}

TEST(Figure, NamesTheFilesOfAJointFit) {
  const Record record = MadeRecord(1e-6);
  const Plot plot = ToPlot(report::MakeReport(MadeInput({record, record}, 1e-6)));
  EXPECT_EQ(plot.panels[0].series[0].label, "measured loop_1.csv");
  EXPECT_EQ(plot.panels[0].series[3].label, "fitted loop_2.csv");
}

TEST(Figure, DrawsStiffnessAndSlipForceOverTheLoadsOfASeries) {
  report::ReportInput input = MadeInput({MadeRecord(1e-6), MadeRecord(2e-6)}, 2e-6);
  input.fit.normal_load = 75.0;
  input.fit.load_exponent = 0.5;
  identification::ParameterEstimate& exponent = input.fit.parameters.emplace_back();
  exponent.name = "load_exponent";
  exponent.unit = "-";
  exponent.value = 0.5;
  const std::size_t count = input.fit.parameters.size();
  input.fit.correlation.assign(count * count, 0.0);
  for (std::size_t r = 0; r < 2; ++r) {
    identification::RecordFit& record = input.fit.records[r];
    record.normal_load = r == 0 ? 50.0 : 100.0;
    record.load_ratio = *record.normal_load / 75.0;
    identification::RecordAlone& alone = record.alone.emplace();
    alone.stiffness.value = 3e7;
    alone.stiffness.lower95 = 2e7;
    alone.stiffness.upper95 = 5e7;
    alone.slip_force.value = 10.0;  // with no interval: not drawn
  }
  const models::BranchLaw law = input.fit.law;
  const Plot plot = ToPlot(report::MakeReport(std::move(input)));
  ASSERT_THAT(plot.panels, SizeIs(4));
  const PlotPanel& stiffness = plot.panels[2];
  EXPECT_EQ(stiffness.y_label, "σ [N/µm]");
  ASSERT_THAT(stiffness.series, SizeIs(2));
  EXPECT_EQ(stiffness.series[0].x.front(), 50.0);
  EXPECT_EQ(stiffness.series[0].x.back(), 100.0);
  constexpr double kRounding = 1e-14;
  EXPECT_NEAR(
      stiffness.series[0].y.back() / (1e-6 * law.tangential_stiffness * std::sqrt(100.0 / 75)), 1,
      kRounding);
  EXPECT_THAT(stiffness.series[1].x, ElementsAre(50.0, 100.0));
  EXPECT_NEAR(stiffness.series[1].lower[0], 20.0, 20 * kRounding);
  EXPECT_NEAR(stiffness.series[1].upper[1], 50.0, 50 * kRounding);
  ASSERT_THAT(plot.panels[3].series, SizeIs(1));
  EXPECT_NEAR(plot.panels[3].series[0].y.front() / (law.slip_force * 50 / 75), 1, kRounding);
}

TEST(Figure, MarksTheReversalsOfEveryRecord) {
  report::ReportInput input =
      MadeInput({MadeRecord(1e-6), MadeRecord(2e-6)}, 2e-6);  // each turns in its middle
  const report::Report report = report::MakeReport(std::move(input));
  const Plot plot = ToPlot(report);
  const PlotSeries& reversals = plot.panels[0].series.back();
  EXPECT_EQ(reversals.label, "reversals");
  EXPECT_EQ(reversals.style, PlotStyle::kMarkers);
  ASSERT_THAT(reversals.x, SizeIs(2));
  for (std::size_t r = 0; r < 2; ++r) {
    const Record& record = report.records[r].record;
    EXPECT_EQ(reversals.x[r], 1e6 * record.displacement[4]);
    EXPECT_EQ(reversals.y[r], record.force[4]);
  }
}

TEST(Figure, TitlesNameFileAndVerdictAndNoUnknownValue) {
  report::ReportInput input = MadeInput();
  input.fit.adequacy.tried = 15;
  EXPECT_EQ(ToPlot(report::MakeReport(input)).title, "loop_1.csv: adequate");
  EXPECT_EQ(ToPlot(report::MakeReport(input)).subtitle,
            "mindlin-dahl: σ = 40.00 ± 0.40 N/µm, α = 0.333 ± 0.010, Tc = 40.00 ± 0.40 N");
  input.fit.adequacy.verdict = identification::AdequacyVerdict::kInadequate;
  input.fit.parameters[0].identifiability = identification::Identifiability::kNotIdentifiable;
  input.fit.parameters[1].status = identification::ParameterStatus::kFixed;
  input.fit.parameters[2].identifiability = identification::Identifiability::kBoundedBelow;
  input.fit.parameters[2].lower95 = 12.5;
  EXPECT_EQ(ToPlot(report::MakeReport(input)).title, "loop_1.csv: inadequate");
  EXPECT_EQ(ToPlot(report::MakeReport(input)).subtitle,
            "mindlin-dahl: σ not known, α = 0.33333, fixed, Tc > 12.5 N");
}

TEST(Figure, OfAFitThatFailedIsRefused) {
  EXPECT_THROW(ToPlot(report::MakeReport(testing::FailedInput())), InvalidArgument);
}

// --- what pages draw besides

/// A sine of whole cycles whose residuals are given, with the reversals at its turning points.
Report ReportOfCycles(std::size_t cycles, std::size_t per_cycle, std::vector<double> residual) {
  Record record;
  ReportInput input;
  std::vector<std::size_t> reversals;
  for (std::size_t i = 0; i < cycles * per_cycle; ++i) {
    const double phase = 2 * M_PI * static_cast<double>(i) / static_cast<double>(per_cycle);
    record.displacement.push_back(1e-6 * std::sin(phase));
    record.force.push_back(10 * std::sin(phase - 0.3));
    record.time.push_back(0.5 * static_cast<double>(i));
    if (i % (per_cycle / 2) == per_cycle / 4) reversals.push_back(i);
  }
  input = MadeInput({record}, 1e-6);
  input.fit.records[0].reversals = reversals;
  input.fit.records[0].residual = std::move(residual);
  input.fit.records[0].residual.resize(record.size());
  return MakeReport(std::move(input));
}

const PlotSeries* Find(const PlotPanel& panel, std::string_view label) {
  const auto series = std::ranges::find(panel.series, label, &PlotSeries::label);
  return series == panel.series.end() ? nullptr : &*series;
}

TEST(PageFigure, DrawsTheLastWholeCycleOfALongFit) {
  constexpr std::size_t kPerCycle = 3000;
  const Report report = ReportOfCycles(4, kPerCycle, {});
  const PlotPanel panel = LoopPanel(report, PlainUnits(report), LoopColours::kByCycle);
  const PlotSeries* const fitted = Find(panel, "fitted, last cycle");
  ASSERT_NE(fitted, nullptr);
  // The last of eight turns is at 11 250, a cycle before it 8250.
  ASSERT_THAT(fitted->y, SizeIs(kPerCycle + 1));
  EXPECT_EQ(fitted->y.front(), report.fit.records[0].fitted_force[8250]);
  EXPECT_EQ(fitted->y.back(), report.fit.records[0].fitted_force[11250]);
  // A measured cycle begins at every second turn; samples before the first belong to the first.
  const PlotSeries* const third = Find(panel, "measured, cycle 3");
  ASSERT_NE(third, nullptr);
  ASSERT_THAT(third->y, SizeIs(kPerCycle));
  EXPECT_EQ(third->y.front(), report.records[0].record.force[750 + 2 * kPerCycle]);
}

TEST(PageFigure, NamesTheFitOfSeveralRecordsOnce) {
  const Record record = MadeRecord(1e-6);
  const Report report = MakeReport(MadeInput({record, record, record}, 1e-6));
  const PlotPanel panel = LoopPanel(report, PlainUnits(report), LoopColours::kByCycle);
  EXPECT_EQ(std::ranges::count(panel.series, "fitted", &PlotSeries::label), 1);
  EXPECT_EQ(std::ranges::count(panel.series, PlotStyle::kLine, &PlotSeries::style), 3);
}

TEST(PageFigure, DrawsAFitOfTheDisplacementWhereTheLawHasTheContact) {
  ReportInput input = MadeInput();
  std::vector<double>& fitted = input.fit.records[0].fitted_displacement;
  for (std::size_t i = 0; i < 9; ++i) fitted.push_back(1e-7 * static_cast<double>(i));
  const Report report = MakeReport(std::move(input));
  const PlotPanel panel = LoopPanel(report, PlainUnits(report), LoopColours::kOneARecord);
  EXPECT_EQ(panel.series[1].x[7], 1e6 * (1e-7 * 7));
  EXPECT_EQ(panel.series[0].x[7], 1e6 * report.records[0].record.displacement[7]);
}

TEST(PageFigure, HasResidualsThatCountOverTheTimeOrTheSample) {
  ReportInput input = MadeInput();
  input.fit.records[0].counts = {1, 1, 0, 1, 1, 1, 1, 1, 0};
  const Report timed = MakeReport(input);
  const PlotPanel panel = ResidualInTime(timed, PlainUnits(timed));
  EXPECT_EQ(panel.x_label, "time [s]");
  EXPECT_THAT(panel.series[0].x, ElementsAre(0, 0.25, 0.75, 1, 1.25, 1.5, 1.75));
  EXPECT_THAT(panel.series[0].y, ElementsAre(0, 0.125, 0.375, 0.5, 0.625, 0.75, 0.875));
  input.records[0].record.time.clear();
  const Report untimed = MakeReport(std::move(input));
  EXPECT_THAT(ResidualInTime(untimed, PlainUnits(untimed)).series[0].x,
              ElementsAre(1, 2, 4, 5, 6, 7, 8));
}

TEST(PageFigure, CorrelatesResidualsOverALittleMoreThanACycle) {
  constexpr std::size_t kSamples = 240;
  std::vector<double> residual(kSamples);
  for (std::size_t i = 0; i < kSamples; ++i) residual[i] = i % 2 == 0 ? 3.0 : -3.0;
  const auto panel = ResidualAutocorrelation(ReportOfCycles(3, 80, residual));
  ASSERT_TRUE(panel);
  // Lags up to a cycle and a quarter; of n alternating values n − k products are ±1.
  ASSERT_THAT(panel->series[0].x, SizeIs(101));
  EXPECT_EQ(panel->series[0].x[100], 100.0);
  EXPECT_NEAR(panel->series[0].y[1], -239.0 / 240, 1e-14);
  EXPECT_NEAR(panel->series[0].y[100], 140.0 / 240, 1e-14);
  EXPECT_NEAR(panel->series[1].upper[1], 1.96 / std::sqrt(240.0), 1e-5);
  EXPECT_EQ(panel->series[1].lower[1], -panel->series[1].upper[1]);
  EXPECT_EQ(panel->series[1].x[1], 100.0);
}

TEST(PageFigure, CountsResidualsInBinsBesideTheNormalDistribution) {
  // 0, 1 … 99 have the quartiles 24 and 74: 2·50/∛100 is more than a tenth of 99, so ten bins.
  constexpr int kSamples = 100;
  std::vector<double> residual(kSamples);
  std::iota(residual.begin(), residual.end(), 0.0);
  const Report report = ReportOfCycles(1, kSamples, residual);
  const PlotPanel panel = ResidualDistribution(report, PlainUnits(report));
  EXPECT_THAT(panel.series[0].y, ElementsAre(10, 10, 10, 10, 10, 10, 10, 10, 10, 10));
  EXPECT_NEAR(panel.series[0].x[0], 9.9 / 2, 1e-12);
  EXPECT_NEAR(panel.series[0].x[9], 99 - 9.9 / 2, 1e-12);
  const double deviation = std::sqrt(kSamples * (kSamples + 1) / 12.0);
  EXPECT_EQ(panel.series[1].x[60], 49.5);
  EXPECT_NEAR(panel.series[1].y[60], kSamples * 9.9 / (deviation * std::sqrt(2 * M_PI)), 1e-9);
  EXPECT_NEAR(panel.series[1].y[0] / panel.series[1].y[60],
              std::exp(-std::pow(49.5 / deviation, 2) / 2), 1e-9);
  // One of 1 + n readings may be as far as √n deviations away.
  residual.push_back(1e6);
  const Report stray = ReportOfCycles(1, kSamples + 1, residual);
  const PlotPanel cut = ResidualDistribution(stray, PlainUnits(stray));
  EXPECT_EQ(cut.series[0].label, "residuals, 1 more beyond the axis");
  EXPECT_EQ(std::accumulate(cut.series[0].y.begin(), cut.series[0].y.end(), 0.0), kSamples);
}

TEST(PageFigure, CutsALikelihoodOffAtFourTimesItsCriticalValue) {
  ReportInput input = MadeInput();
  auto& profile = input.fit.slip_force_profile.emplace();
  profile.critical = 2.0;
  double slip_force = 30.0;
  for (const double statistic : {40.0, 20.0, 5.0, 0.0, 2.5, 9.0, 30.0}) {
    profile.points.push_back({.law = {kSigma, 1.0 / 3, slip_force}, .statistic = statistic});
    slip_force += 5;
  }
  const auto panel = SlipForceLikelihood(MakeReport(std::move(input)));
  ASSERT_TRUE(panel);
  // On either side one point beyond 8 is kept, for the curve to leave the figure there.
  EXPECT_THAT(panel->series[0].x, ElementsAre(35, 40, 45, 50, 55));
  EXPECT_THAT(panel->series[0].y, ElementsAre(8, 5, 0, 2.5, 8));
  EXPECT_THAT(panel->series[1].x, ElementsAre(35, 55));
  EXPECT_THAT(panel->series[1].y, ElementsAre(2, 2));
}

TEST(PageFigure, ClosesTheRegionOfTheParametersThatAreAskedFor) {
  ReportInput input = MadeInput();
  input.fit.regions = {{.parameters = {"sigma", "alpha"}, .boundary = {{1e7, 0.1}}, .closed = true},
                       {.parameters = {"slip_force", "alpha"},
                        .boundary = {{38.0, 0.3}, {42.0, 0.3}, {40.0, 0.4}},
                        .closed = false}};
  const auto panel = RegionPanel(MakeReport(std::move(input)), "slip_force");
  ASSERT_TRUE(panel);
  EXPECT_EQ(panel->x_label, "slip force Tc [N]");
  EXPECT_EQ(panel->series[0].label, "95 % region, open where it ends");
  EXPECT_THAT(panel->series[0].x, ElementsAre(38, 42, 40, 38));
  EXPECT_THAT(panel->series[0].y, ElementsAre(0.3, 0.3, 0.4, 0.3));
  EXPECT_THAT(panel->series[1].x, ElementsAre(kSlipForce));
  EXPECT_THAT(panel->series[1].y, ElementsAre(1.0 / 3));
  EXPECT_THAT(panel->series[2].x, ElementsAre(38, 42));
}

TEST(PageFigure, ShadesCyclesFromTheFirstToTheLast) {
  const auto groups = [](std::size_t cycles) {
    const Report report = ReportOfCycles(cycles, 40, {});
    std::vector<std::pair<std::string, double>> all;
    for (const PlotSeries& series :
         LoopPanel(report, PlainUnits(report), LoopColours::kByCycle).series) {
      if (series.label.starts_with("measured")) all.emplace_back(series.label, *series.shade);
    }
    return all;
  };
  // Turns at 10, 30, 50 …: a cycle begins at every second one, and the last ends the record.
  EXPECT_THAT(groups(3), ElementsAre(std::pair(std::string("measured, cycle 1"), 0.0),
                                     std::pair(std::string("measured, cycle 2"), 0.5),
                                     std::pair(std::string("measured, cycle 3"), 1.0)));
  // Ten cycles in eight groups: the fourth and the eighth have two.
  const auto ten = groups(10);
  ASSERT_THAT(ten, SizeIs(8));
  for (std::size_t g = 0; g < 8; ++g) {
    const std::size_t first = g * 10 / 8 + 1;
    const std::size_t last = (g + 1) * 10 / 8;
    EXPECT_EQ(ten[g].first, first == last ? "measured, cycle " + std::to_string(first)
                                          : "measured, cycles " + std::to_string(first) + " to " +
                                                std::to_string(last));
    EXPECT_NEAR(ten[g].second, static_cast<double>(g) / 7, 1e-15);
  }
}

}  // namespace
}  // namespace mindahl::report::figure_test
