

#include <nlohmann/json.hpp>

#include "mindahl/identification/fit.h"
#include "mindahl/loop/segments.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"
#include "support/histories.h"
#include "support/prelude.h"

// --trim auto: a fit of a record without what is no part of its test, and what is said of it.
namespace mindahl::request::trim_test {
namespace {

using identification::FitOptions;
using identification::FitResult;
using loop::Record;
using models::BranchLaw;

constexpr std::size_t kCycle = 100;            // samples
constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};  // δc = 1.5 µm
constexpr double kReach = 2e-6;                // [m]
constexpr double kNoise = 0.2;                 // [N]

/// A contact that runs in: its force begins with 0.7 of what it settles to.
Record RunningIn(std::size_t cycles, Generator& generator, double begins_with = 0.7) {
  constexpr double kTime = 1.5;  // [cycles]
  Record record;
  for (std::size_t i = 0; i <= cycles * kCycle; ++i) {
    const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
    record.displacement.push_back(kReach * std::sin(2 * std::numbers::pi * cycle));
  }
  record.force = testing::Respond(testing::Model("mindlin-dahl"), kLaw, record.displacement);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
    record.force[i] *= 1 + (begins_with - 1) * std::exp(-cycle / kTime);
    record.force[i] += kNoise * testing::Normal(generator);
  }
  return record;
}

/// Under a load [N] that ramps up over three cycles, and its force with it.
Record UnderARampingLoad(std::size_t cycles, Generator& generator) {
  Record record = RunningIn(cycles, generator, 1.0);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
    const double share = std::min(1.0, 0.4 + 0.2 * cycle);
    record.normal_load.push_back(100 * share);
    record.force[i] *= share;  // no contact's law: what --trim is to keep away from the fit
  }
  return record;
}

FitResult FitOf(const Record& record, bool trims) {
  FitOptions options;
  if (trims) {
    const std::vector<loop::Trim> found = {loop::FindTrim(record, options.preparation)};
    LeaveOutTrimmed(found, options);
  }
  return identification::Fit({&record, 1}, options, identification::Depth::kIntervals);
}

bool Covers(const FitResult& fit, std::string_view name, double truth) {
  const identification::ParameterEstimate& estimate = *fit.Find(name);
  return estimate.lower95 && estimate.upper95 && *estimate.lower95 <= truth &&
         truth <= *estimate.upper95;
}

TEST(TrimmedFit, CoversTheContactThatARunningInEndsWith) {
  constexpr std::size_t kRecords = 60;
  Generator generator(19);
  std::size_t whole = 0;
  std::size_t trimmed = 0;
  std::size_t adequate = 0;
  double error_of_whole = 0.0;
  double error_of_trimmed = 0.0;
  for (std::size_t k = 0; k < kRecords; ++k) {
    const Record record = RunningIn(16, generator);
    const FitResult of_whole = FitOf(record, false);
    const FitResult of_trimmed = FitOf(record, true);
    whole += Covers(of_whole, "slip_force", kLaw.slip_force) ? 1 : 0;
    trimmed += Covers(of_trimmed, "slip_force", kLaw.slip_force) ? 1 : 0;
    error_of_whole += std::abs(of_whole.law.slip_force / kLaw.slip_force - 1) / kRecords;
    error_of_trimmed += std::abs(of_trimmed.law.slip_force / kLaw.slip_force - 1) / kRecords;
    adequate += of_trimmed.adequacy.verdict != identification::AdequacyVerdict::kInadequate ? 1 : 0;
  }
  RecordProperty("whole", static_cast<int>(whole));
  RecordProperty("trimmed", static_cast<int>(trimmed));
  RecordProperty("error_of_whole_ppm", static_cast<int>(1e6 * error_of_whole));
  RecordProperty("error_of_trimmed_ppm", static_cast<int>(1e6 * error_of_trimmed));
  RecordProperty("not_inadequate", static_cast<int>(adequate));
  // What is left of the running-in is within 1 % of the contact's force, and falls from there.
  EXPECT_LT(error_of_trimmed, 0.01 / 4);
  EXPECT_LT(error_of_trimmed, error_of_whole / 4);
  EXPECT_GE(trimmed, whole);
}

TEST(TrimmedFit, IsTheFitOfTheWholeWhereNothingIsLeftOut) {
  Generator generator(4);
  const Record record = RunningIn(12, generator, 1.0);
  const FitResult whole = FitOf(record, false);
  const FitResult trimmed = FitOf(record, true);
  EXPECT_EQ(whole.law.tangential_stiffness, trimmed.law.tangential_stiffness);
  EXPECT_EQ(whole.initial_state, trimmed.initial_state);
}

TEST(LeaveOutTrimmed, TakesASteadyContactWhereEveryFirstLoadingIsLeftOut) {
  const loop::TrimmedPart rest{.reason = loop::TrimReason::kRest, .first = 0, .last = 3};
  const loop::TrimmedPart ramp{
      .reason = loop::TrimReason::kRamp, .first = 3, .last = 5, .at_start = true};
  const loop::Trim rested{.samples = 8, .parts = {rest}};
  const loop::Trim ramped{.samples = 7, .parts = {ramp}};
  FitOptions options;
  LeaveOutTrimmed(std::vector<loop::Trim>{rested, ramped}, options);
  EXPECT_FALSE(options.initial_state);
  EXPECT_EQ(options.preparation.held_out[0],
            (std::vector<bool>{true, true, true, false, false, false, false, false}));
  EXPECT_EQ(options.preparation.held_out[1],
            (std::vector<bool>{false, false, false, true, true, false, false}));
  LeaveOutTrimmed(std::vector<loop::Trim>{ramped}, options);
  EXPECT_EQ(options.initial_state, models::InitialState::kSteady);
  options.initial_state = models::InitialState::kVirgin;  // said by the user
  LeaveOutTrimmed(std::vector<loop::Trim>{ramped}, options);
  EXPECT_EQ(options.initial_state, models::InitialState::kVirgin);
}

/// As the program fits it.
report::Report ReportOf(const Record& record, FitRequest request = {}) {
  io::RecordFile file;
  file.record = record;
  file.displacement.unit = "m";
  file.force.unit = "N";
  request.files = {"a.csv"};
  request.trim = kAutomatic;
  return FitRecords(request, {file}, [](std::string_view) {});
}

TEST(TrimmedFit, ReportsWhatIsLeftOutAndWhatDependsOnIt) {
  Generator generator(6);
  const report::Report report = ReportOf(RunningIn(16, generator));
  EXPECT_EQ(report.fit.initial_state, models::InitialState::kSteady);
  EXPECT_GT(report.fit.records.front().left_out, 2 * kCycle);
  EXPECT_THAT(report::ToJson(report), HasSubstr("\"why\": \"running_in\""));
  const auto trimmed = nlohmann::json::parse(report::ToJson(report))["input"]["left_out"];
  ASSERT_FALSE(trimmed.empty());
  std::size_t next = 1;  // of a record without lines samples count from 1
  for (const auto& part : trimmed) {
    EXPECT_EQ(part["first"], next);
    next += part["samples"].get<std::size_t>();
    EXPECT_EQ(part["last"], next - 1);
  }
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

TEST(TrimmedFit, IsRefusedTogetherWithOtherWindows) {
  const auto message = [](FitRequest request) {
    request.trim = kAutomatic;
    try {
      MakeFitOptions(request);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  FitRequest request;
  EXPECT_EQ(message(request), "");
  request.cycles = {.first = 2, .last = 3};
  EXPECT_THAT(message(request), HasSubstr("--cycles cannot be combined with --trim auto"));
  request = {};
  request.samples = {.first = 2, .last = 30};
  EXPECT_THAT(message(request), HasSubstr("--samples cannot be combined"));
  request = {};
  request.skip_cycles = 1;
  EXPECT_THAT(message(request), HasSubstr("--skip-cycles cannot be combined"));
  request = {};
  request.noise_in = "displacement";
  EXPECT_THAT(message(request), HasSubstr("--noise-in displacement cannot be combined"));
}

}  // namespace
}  // namespace mindahl::request::trim_test
