#include "mindahl/report/figure.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "mindahl/core/error.h"
#include "report/made_report.h"

namespace mindahl::report {
namespace {

using namespace loop;
using namespace io;

using report::ToPlot;
using ::testing::ElementsAre;
using testing::MadeInput;
using testing::MadeRecord;
using ::testing::SizeIs;

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
  ASSERT_THAT(plot.panels[0].series, SizeIs(2));
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

TEST(Figure, OfAFitThatFailedIsRefused) {
  EXPECT_THROW(ToPlot(report::MakeReport(testing::FailedInput())), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::report
