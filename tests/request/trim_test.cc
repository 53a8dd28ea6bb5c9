

#include "mindahl/request/fit_request.h"
#include "support/histories.h"
#include "support/prelude.h"

// --trim on: a fit of a record without what is no part of its test, and what is said of it.
namespace mindahl::request::trim_test {
namespace {

using loop::Record;

constexpr std::size_t kCycle = 100;                    // samples
constexpr models::BranchLaw kLaw{4e7, 1.0 / 3, 40.0};  // δc = 1.5 µm
constexpr double kReach = 2e-6;                        // [m]
constexpr double kNoise = 0.2;                         // [N]

Record Cycles(double cycles, Generator& generator) {
  Record record;
  record.displacement = testing::Sine(cycles, kCycle);
  for (double& displacement : record.displacement) displacement *= kReach;
  record.force = testing::Respond(testing::Model("mindlin-dahl"), kLaw, record.displacement);
  for (double& force : record.force) force += kNoise * testing::Normal(generator);
  return record;
}

/// Under a load [N] that ramps up over three cycles, and its force with it.
Record UnderARampingLoad(double cycles, Generator& generator) {
  Record record = Cycles(cycles, generator);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
    const double share = std::min(1.0, 0.4 + 0.2 * cycle);
    record.normal_load.push_back(100 * share);
    record.force[i] *= share;  // no contact's law: what --trim is to keep away from the fit
  }
  return record;
}

/// As the program fits it.
report::Report ReportOf(const Record& record) {
  FitRequest request;
  io::RecordFile file;
  file.record = record;
  file.displacement.unit = "m";
  file.force.unit = "N";
  request.files = {"a.csv"};
  request.trim = true;
  return FitRecords(request, {file});
}

TEST(TrimmedFit, IsUnderTheLoadThatARampEndsWith) {
  Generator generator(8);
  const Record record = UnderARampingLoad(20, generator);
  const report::Report report = ReportOf(record);
  EXPECT_EQ(report.fit.normal_load, 100.0);
  EXPECT_EQ(report.fit.FindFinding("load_followed"), nullptr);
  EXPECT_NEAR(report.fit.law.slip_force / kLaw.slip_force, 1, 0.005);
  // The ramp ends after three cycles, a turn is a quarter past each half, and the second counts.
  EXPECT_EQ(report.records.front().record.size(), record.size() - (3 * kCycle + 3 * kCycle / 4));
}

TEST(TrimmedFit, HasSignGapAndScaleOfTheTestAndNamesTheRowsOfATravel) {
  Generator generator(9);
  Record record = Cycles(6, generator);
  // An approach of 100 mm under a force of the other sign, and the same way back.
  for (std::size_t i = 0; i < 150; ++i) {
    const double far = -0.1 * (1 - static_cast<double>(i) / 150);
    record.displacement.insert(record.displacement.begin() + static_cast<std::ptrdiff_t>(i), far);
    record.force.insert(record.force.begin() + static_cast<std::ptrdiff_t>(i), -60.0);
    record.displacement.push_back(-0.1 * static_cast<double>(i) / 150);
    record.force.push_back(60.0);
  }
  const report::Report report = ReportOf(record);
  EXPECT_EQ(report.fit.force_sense, 1);
  EXPECT_NEAR(report.fit.records[0].measures.amplitude / kReach, 1, 0.001);
  EXPECT_NEAR(report.fit.law.slip_force / kLaw.slip_force, 1, 0.01);
  EXPECT_NEAR(report.fit.law.tangential_stiffness / kLaw.tangential_stiffness, 1, 0.02);
  ASSERT_EQ(report.left_out.size(), 2U);
  EXPECT_EQ(report.left_out[0].why, "travel");
  EXPECT_EQ(report.left_out[0].first, 1U);
  EXPECT_GE(report.left_out[0].last, 150U);
  EXPECT_EQ(report.left_out[1].last, record.size());
}

}  // namespace
}  // namespace mindahl::request::trim_test
