
#include <map>

#include "mindahl/report/report.h"
#include "report/made_report.h"
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

}  // namespace
}  // namespace mindahl::report::figure_test
