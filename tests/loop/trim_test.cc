

#include "mindahl/loop/segments.h"
#include "mindahl/models/friction_model.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::loop::trim_test {
namespace {

using models::BranchLaw;

constexpr std::size_t kCycle = 100;            // samples
constexpr double kReach = 2e-6;                // [m], 1.3 times gross slip
constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};  // δc = 1.5 µm

/// A sine from zero.
Record Cycled(double cycles) {
  Record record;
  const auto samples = static_cast<std::size_t>(std::lround(cycles * static_cast<double>(kCycle)));
  for (std::size_t i = 0; i <= samples; ++i) {
    const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
    record.displacement.push_back(kReach * std::sin(2 * std::numbers::pi * cycle));
  }
  record.force = testing::Respond(testing::Model("mindlin-dahl"), kLaw, record.displacement);
  return record;
}

/// Samples at the first place before, and at the last place after.
Record WithRests(const Record& record, std::size_t before, std::size_t after) {
  Record rested = record;
  rested.displacement.insert(rested.displacement.begin(), before, record.displacement.front());
  rested.force.insert(rested.force.begin(), before, record.force.front());
  rested.displacement.insert(rested.displacement.end(), after, record.displacement.back());
  rested.force.insert(rested.force.end(), after, record.force.back());
  return rested;
}

TEST(Trim, LeavesARecordOfOneTestWhole) {
  for (const double cycles : {2.0, 5.0, 20.0, 20.4}) {
    const Trim trim = FindTrim(Cycled(cycles));
    EXPECT_TRUE(trim.parts.empty()) << cycles;
    EXPECT_EQ(trim.samples, Cycled(cycles).size());
  }
}

TEST(Trim, LeavesOutRestsButForTheSampleThatTheMotionBeginsFrom) {
  const Trim trim = FindTrim(WithRests(Cycled(3), 90, 40));
  ASSERT_EQ(trim.parts.size(), 2U);
  EXPECT_EQ(trim.parts[0].first, 0U);
  EXPECT_EQ(trim.parts[0].last, 90U);  // the sine's own first sample is at rest too, and stays
  EXPECT_EQ(trim.parts[1].last, 90U + 3 * kCycle + 1 + 40);
  EXPECT_EQ(trim.parts[1].first, trim.parts[1].last - 40);
}

TEST(Trim, LeavesADwellOfHalfAStrokeIn) {
  // Usual strokes of 50 samples; the sine's own first sample rests too.
  EXPECT_TRUE(FindTrim(WithRests(Cycled(5), kCycle / 4 - 1, 0)).parts.empty());
  EXPECT_FALSE(FindTrim(WithRests(Cycled(5), kCycle / 4, 0)).parts.empty());
}

TEST(Trim, TakesAMoveOfAHundredthOfTheAmplitudeForRest) {
  // Two dwells, each too short for a rest, so far from each other: one if within 1 % of X.
  for (const double apart : {0.008, 0.015}) {
    Record record = WithRests(Cycled(5), 19, 0);
    record.displacement.insert(record.displacement.begin(), 20, -apart * kReach);
    record.force.insert(record.force.begin(), 20, 0.0);
    EXPECT_EQ(FindTrim(record).parts.empty(), apart > 0.01) << apart;
  }
}

TEST(Trim, TakesNoiseAboutARestForRest) {
  Generator generator(3);
  Record record = WithRests(Cycled(4), 200, 0);
  for (double& x : record.displacement) x += 0.002 * kReach * testing::Normal(generator);
  const Trim trim = FindTrim(record);
  ASSERT_EQ(trim.parts.size(), 1U);
  // Within 1 % of X, and five deviations of the noise, the sine is for 0.01/(2π) of a cycle.
  EXPECT_NEAR(static_cast<double>(trim.parts[0].last), 200.0, 3.0);
}

TEST(Trim, IsIndependentOfForceSignAndWindow) {
  Record record = WithRests(Cycled(30), 90, 0);
  const Trim trim = FindTrim(record);
  for (double& force : record.force) force = 5 - force;
  PreparationOptions options;
  options.skip_cycles = 8;
  const Trim turned = FindTrim(record, options);
  ASSERT_EQ(turned.parts.size(), 1U);
  EXPECT_EQ(turned.parts[0].last, trim.parts[0].last);
}

TEST(Trim, OfARecordThatDoesNotTurnIsNone) {
  Record record;
  for (std::size_t i = 0; i < 50; ++i) {
    record.displacement.push_back(1e-8 * static_cast<double>(i));
    record.force.push_back(0.1 * static_cast<double>(i));
  }
  const Trim trim = FindTrim(record);
  EXPECT_TRUE(trim.parts.empty());
}

}  // namespace
}  // namespace mindahl::loop::trim_test
