#include "identification/problem/motion.h"
#include "identification/stages.h"
#include "support/prelude.h"

// A force that is read some time after the displacement: what a fit makes of it.
namespace mindahl::identification::lag_test {
namespace {

constexpr double kStep = 0.005;  // [s]
constexpr int kSamplesPerCycle = 200;

/// Noise-free, of 1.2 of gross slip. The condition of the fit is 1e4 for the contact alone; a lag
/// that goes with α by a correlation up to 0.8 makes it 1/√(1 − 0.8²) = 1.7 times as large for α
/// and 3 times for σ (docs/identification.md).
constexpr double kWithLag = 10 * kNoiseFree;

BranchLaw LawOf(double shape_exponent) { return {5e7, shape_exponent, 20.0}; }

double ReachOf(const BranchLaw& law) { return 1.2 * GrossSlipDisplacement(law); }

/// Times at which a loop of `cycles` is read, every `step`.
std::vector<double> TimesOf(double cycles, double step = kStep) {
  std::vector<double> time;
  const auto last = static_cast<int>(std::lround(cycles * kSamplesPerCycle * kStep / step));
  for (int i = 0; i <= last; ++i) time.push_back(step * i);
  return time;
}

double SineAt(const BranchLaw& law, double time) {
  return ReachOf(law) * std::sin(2 * std::numbers::pi * time / (kSamplesPerCycle * kStep));
}

/// On straight lines between the readings, which is how the displacement is known; held beyond the
/// ends.
double ChordAt(const std::vector<double>& time, const History& displacement, double at) {
  if (at <= time.front()) return displacement.front();
  if (at >= time.back()) return displacement.back();
  const auto next = std::ranges::upper_bound(time, at);
  const auto k = static_cast<std::size_t>(next - time.begin());
  const double share = (at - time[k - 1]) / (time[k] - time[k - 1]);
  return displacement[k - 1] + share * (displacement[k] - displacement[k - 1]);
}

/// The contact moved on the chords, its force read `lag` later [s]: what the fit is to see through.
/// The response is that to all readings and all moments between them together.
Record LateRecord(const BranchLaw& law, const std::vector<double>& time, double lag) {
  Record record;
  record.time = time;
  for (const double at : time) record.displacement.push_back(SineAt(law, at));
  std::vector<std::pair<double, bool>> moments;  // and whether a force is read of it
  for (const double at : time) {
    moments.emplace_back(at, false);
    moments.emplace_back(std::clamp(at - lag, time.front(), time.back()), true);
  }
  std::ranges::stable_sort(moments);
  History motion;
  for (const auto& [at, is_read] : moments) {
    motion.push_back(ChordAt(time, record.displacement, at));
  }
  const std::vector<double> force = Respond(testing::Model("mindlin-dahl"), law, motion);
  for (std::size_t i = 0; i < moments.size(); ++i) {
    if (moments[i].second) record.force.push_back(force[i]);
  }
  return record;
}

TEST(Lag, IsRecoveredToTheLastDigitsWhereTheContactFollowedTheChords) {
  for (const double shape_exponent : {1.0 / 3, 0.7}) {
    const BranchLaw law = LawOf(shape_exponent);
    for (const double samples : {0.3, 1.0, 3.0, -0.3, -2.0}) {
      SCOPED_TRACE(::testing::Message() << shape_exponent << " late by " << samples);
      const FitResult fit =
          FitOne(LateRecord(law, TimesOf(2.25), samples * kStep), {.terms = {"lag"}});
      EXPECT_TRUE(Recovers(fit, law, kWithLag));
      EXPECT_NEAR(fit.Find("lag")->value, samples * kStep, kWithLag * kSamplesPerCycle * kStep);
      EXPECT_EQ(fit.Find("lag")->unit, "s");
    }
  }
}

TEST(Lag, IsRecoveredOfASteadyLoopThatBeginsAnywhere) {
  const BranchLaw law = LawOf(1.0 / 3);
  const Record whole = LateRecord(law, TimesOf(4.0), 2.6 * kStep);
  for (const std::size_t begin : {260U, 331U, 397U}) {
    const FitResult fit =
        FitOne(From(whole, begin), {.initial_state = InitialState::kSteady, .terms = {"lag"}});
    EXPECT_TRUE(Recovers(fit, law, kWithLag)) << begin;
  }
}

TEST(Lag, IsFittedOfARecordInWhichARowIsRepeated) {
  const BranchLaw law = LawOf(1.0 / 3);
  Record record = LateRecord(law, TimesOf(2.25), 1.7 * kStep);
  for (auto* const column : {&record.time, &record.displacement, &record.force}) {
    column->insert(column->begin() + 99, (*column)[99]);
  }
  const FitResult fit = FitOne(record, {.terms = {"lag"}});
  EXPECT_NEAR(fit.Find("lag")->value, 1.7 * kStep, 0.1 * kStep);
}

TEST(Lag, IsCountedInSamplesWhereTheRecordHasNoTime) {
  const BranchLaw law = LawOf(1.0 / 3);
  Record record = LateRecord(law, TimesOf(2.25), 1.7 * kStep);
  record.time.clear();
  const FitResult fit = FitOne(record, {.terms = {"lag"}});
  EXPECT_TRUE(Recovers(fit, law, kWithLag));
  EXPECT_NEAR(fit.Find("lag")->value, 1.7, kWithLag * kSamplesPerCycle);
  EXPECT_EQ(fit.Find("lag")->unit, "samples");
}

TEST(Lag, ThatIsKnownIsTakenOff) {
  const BranchLaw law = LawOf(0.7);
  const FitResult fit =
      FitOne(LateRecord(law, TimesOf(2.25), 2.4 * kStep), {.fixed = {{"lag", 2.4 * kStep}}});
  EXPECT_TRUE(Recovers(fit, law, kWithLag));
  EXPECT_EQ(fit.Find("lag")->status, ParameterStatus::kFixed);
  // 0, 1 and 2 steps from the start: their displacement lies before it.
  EXPECT_EQ(fit.records[0].left_out, 3U);
}

TEST(Lag, IsRefusedWhereItCannotBeCounted) {
  const Record timed = LateRecord(LawOf(1.0 / 3), TimesOf(2.25), 0.0);
  Record without = timed;
  without.time.clear();
  EXPECT_THAT(RefusalOf({timed, without}, {.terms = {"lag"}}),
              HasSubstr("or records without a time"));
  Record stopped = timed;
  std::ranges::fill(stopped.time, 3.0);
  EXPECT_THAT(RefusalOf({stopped}, {.terms = {"lag"}}), HasSubstr("a time that increases"));
}

}  // namespace
}  // namespace mindahl::identification::lag_test
