#include "identification/diagnosis/diagnosis.h"

#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "support/prelude.h"

// Findings from results made by hand.
namespace mindahl::identification::diagnosis_test {
namespace {

/// Far below slip.
FitResult Made() { return testing::MadeFit(/*peak_force=*/2.0); }

TEST(FindOpenSlipForce, NamesTheShapeToo) {
  FitResult result = Made();
  EXPECT_TRUE(FindOpenSlipForce(result).empty());
  result.parameters[2].upper95.reset();
  auto findings = FindOpenSlipForce(result);
  ASSERT_EQ(findings.size(), 2U);
  EXPECT_EQ(findings[0].code, "bounded_below");
  EXPECT_THAT(findings[0].parameters, ElementsAre("slip_force"));
  EXPECT_EQ(findings[1].code, "not_identifiable");
  EXPECT_EQ(findings[1].kind, "with_slip_force");
  EXPECT_THAT(findings[1].parameters, ElementsAre("alpha"));
  result.records[0].facts.closed = true;
  result.records[0].facts.peak_force = 1.75;
  result.records[0].facts.amplitude = 0.5e-6;
  findings = FindOpenSlipForce(result);
  EXPECT_EQ(findings[0].kind, "");
  result.records[0].facts.energy_ratio = 0.9;
  result.records[0].facts.half_gap = 1.5;
  EXPECT_EQ(FindOpenSlipForce(result)[0].kind, "slides") << "a larger amplitude is no remedy";
  result.parameters[1].status = ParameterStatus::kFixed;
  EXPECT_EQ(FindOpenSlipForce(result).size(), 1U);
}

// ---
// Tests the findings of records, from facts made by hand, and in the result of a whole fit.

std::vector<std::string_view> Codes(const std::vector<Finding>& findings) {
  std::vector<std::string_view> codes;
  for (const Finding& finding : findings) codes.push_back(finding.code);
  return codes;
}

RecordFit Flawless() {
  RecordFit record;
  record.facts.closed = true;
  return record;
}

std::vector<Finding> FindIn(const RecordFit& record) { return FindInRecords({&record, 1}); }

TEST(FindInRecords, NothingInAFlawlessOne) { EXPECT_THAT(FindIn(Flawless()), IsEmpty()); }

TEST(FindInRecords, UncertainReversalsHaveTheirCountAndGate) {
  RecordFit record = Flawless();
  record.gate = {8e-4, false};
  record.reversals.resize(19);  // after smoothing
  const std::vector<Finding> findings = FindIn(record);
  ASSERT_THAT(Codes(findings), ElementsAre("reversals_uncertain"));
  EXPECT_EQ(findings[0].severity, Severity::kWarning);
  EXPECT_EQ(findings[0].Number("count"), 19);
  EXPECT_EQ(findings[0].Number("gate"), 8e-4);
}

TEST(FindInRecords, RecordWithoutAClosedCycleIsNotedAndOfSeveralNamed) {
  RecordFit open;
  EXPECT_THAT(Codes(FindIn(open)), ElementsAre("no_closed_cycle"));
  EXPECT_EQ(FindIn(open)[0].severity, Severity::kNote);
  EXPECT_FALSE(FindIn(open)[0].Number("record"));
  const std::vector<RecordFit> records = {Flawless(), open};
  EXPECT_EQ(FindInRecords(records).at(0).Number("record"), 2);
}

TEST(FindMissingRows, NamesAGapOfAQuarterOfACycleAndNoUnevenSampling) {
  loop::PreparedRecord prepared;
  std::vector<double> time;
  std::vector<double> displacement;
  for (std::size_t i = 0; i < 400; ++i) {
    time.push_back(0.01 * static_cast<double>(i));
    displacement.push_back(std::abs(50.0 - static_cast<double>(i % 100)));
  }
  prepared.reversals = {50, 100, 150, 200, 250, 300, 350};  // cycles of a second
  prepared.record.time = time;
  prepared.record.displacement = displacement;
  EXPECT_THAT(FindMissingRows(std::span(&prepared, 1)), IsEmpty());
  for (std::size_t i = 220; i < 400; ++i) time[i] += 0.4;
  EXPECT_THAT(FindMissingRows(std::span(&prepared, 1)), IsEmpty()) << "a pause";
  displacement[219] += 20;
  const std::vector<Finding> found = FindMissingRows(std::span(&prepared, 1));
  ASSERT_EQ(found.size(), 1U);
  EXPECT_EQ(found[0].code, "rows_missing");
  EXPECT_NEAR(*found[0].Number("gap"), 0.41, 1e-12);
  EXPECT_NEAR(*found[0].Number("from"), 2.19, 1e-12);
  // Sparse rows at even times have no gap.
  const std::vector<double> sparse = {0.0, 0.3, 0.6, 0.9, 1.2};
  prepared.record.time = sparse;
  prepared.reversals = {1, 2, 3};
  EXPECT_THAT(FindMissingRows(std::span(&prepared, 1)), IsEmpty());
}

TEST(FindVaryingLoads, StateTheAmplitudeOfASineAboutTheMeanOfWhatCounts) {
  ScaledRecords data;
  ScaledRecord& record = data.records.emplace_back();
  record.force.assign({0.0, 0.1, 0.2, 0.3});
  record.load_change.assign({0.5, 0.3, 0.1, 9.0});
  record.counts.assign({1, 1, 1, 0});
  const std::vector<Finding> findings = FindVaryingLoads(data);
  ASSERT_EQ(findings.size(), 1U);
  // The variance of 0.5, 0.3 and 0.1 is 0.08/3.
  EXPECT_NEAR(findings[0].numbers[0].second, std::sqrt(2 * 0.08 / 3), 1e-15);
}

TEST(ForceAtLimit, IsOfASensorThatSaturatesAndNotOfAPlateau) {
  Generator generator(5);
  const loop::Record clean = Loop();
  EXPECT_FALSE(FitOne(clean).FindFinding("force_at_limit")) << "a plateau that was computed";
  for (const int samples : {30, 60}) {
    loop::Record coarse =
        MakeRecord(Cycling(Wave::kSine, 8 * GrossSlipDisplacement(kLaw), 5.25, samples), {});
    coarse.force = Respond(Model("dahl"), kLaw, coarse.displacement);
    const FitResult fit = FitOne(coarse, testing::OfModel("dahl"));
    EXPECT_FALSE(fit.FindFinding("force_at_limit")) << "few readings of one that was computed";
  }
  const loop::Record noisy = WithForceNoise(clean, 0.2, generator);
  EXPECT_FALSE(FitOne(noisy).FindFinding("force_at_limit"));
  loop::Record counted = noisy;
  for (double& force : counted.force) force = 4.0 * std::round(force / 4.0);
  EXPECT_FALSE(FitOne(counted).FindFinding("force_at_limit")) << "steps repeat everywhere";
  loop::Record clipped = noisy;
  const double limit = 0.6 * *std::ranges::max_element(clean.force);
  for (double& force : clipped.force) force = std::min(force, limit);
  const FitResult fit = FitOne(clipped);
  const Finding* finding = fit.FindFinding("force_at_limit");
  ASSERT_NE(finding, nullptr);
  EXPECT_EQ(finding->Number("limit"), limit);
  EXPECT_FALSE(fit.Find("slip_force")->is_known());
  EXPECT_FALSE(fit.Find("alpha")->is_known());
}

TEST(UnknownPast, IsOfALoopWithinALargerOneThatIsNotRecorded) {
  // Growing cycles from the middle of a stroke on: of a contact that was cycled twice as wide
  // before, the virgin curve from the last turn fits as well, with another Tc.
  constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
  const double reach = 0.7 * GrossSlipDisplacement(kLaw);
  const auto turns = [&](std::span<const double> targets) {
    History path{0.0};
    for (const double target : targets) {
      const double from = path.back();
      for (int i = 1; i <= 50; ++i) path.push_back(from + (target - from) * i / 50.0);
    }
    return path;
  };
  const double x = reach;
  const std::vector<double> growing = {0.3 * x, -0.44 * x, 0.58 * x, -0.72 * x, 0.86 * x, -x};
  std::vector<double> after = {2 * x, -2 * x, 2 * x, -2 * x, 0.0};
  const std::size_t past = after.size() * 50;
  after.insert(after.end(), growing.begin(), growing.end());
  for (const bool is_cycled : {false, true}) {
    Generator generator(3);
    const History displacement = turns(is_cycled ? after : growing);
    const loop::Record record =
        MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement));
    const FitResult fit =
        FitOne(WithForceNoise(From(record, is_cycled ? past : 0), 0.1, generator));
    EXPECT_EQ(fit.FindFinding("unknown_past", "elsewhere") != nullptr, is_cycled);
    EXPECT_EQ(fit.Find("slip_force")->is_known(), !is_cycled);
  }
}

TEST(FewPlaces, LeaveTheShapeUnknownAlsoWhereNoneRepeats) {
  constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
  const History displacement =
      Cycling(Wave::kSine, 2 * GrossSlipDisplacement(kLaw), 2.5, /*samples a cycle*/ 8);
  const loop::Record whole =
      MakeRecord(displacement, Respond(Model("mindlin-dahl"), kLaw, displacement));
  const FitResult fit = FitOne(From(whole, 8));
  EXPECT_TRUE(fit.FindFinding("not_identifiable", "few_places"));
  EXPECT_FALSE(fit.Find("sigma")->is_known());
  EXPECT_FALSE(fit.Find("alpha")->is_known());
}

}  // namespace
}  // namespace mindahl::identification::diagnosis_test
