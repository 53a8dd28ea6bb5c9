

#include "mindahl/loop/segments.h"
#include "mindahl/models/friction_model.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::loop::trim_test {
namespace {

using models::BranchLaw;

constexpr std::size_t kCycle = 100;  // samples
constexpr std::size_t kTurn = kCycle / 4;
constexpr double kReach = 2e-6;                // [m], 1.3 times gross slip
constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};  // δc = 1.5 µm

using OfCycle = std::function<double(double cycle)>;

double Always(double /*cycle*/) { return 1.0; }

/// A sine from zero, its amplitude [of kReach] and the contact's strength going with the cycles.
Record Cycled(double cycles, const OfCycle& amplitude = Always, const OfCycle& strength = Always) {
  Record record;
  const auto samples = static_cast<std::size_t>(std::lround(cycles * static_cast<double>(kCycle)));
  for (std::size_t i = 0; i <= samples; ++i) {
    const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
    record.displacement.push_back(amplitude(cycle) * kReach *
                                  std::sin(2 * std::numbers::pi * cycle));
  }
  record.force = testing::Respond(testing::Model("mindlin-dahl"), kLaw, record.displacement);
  for (std::size_t i = 0; i <= samples; ++i) {
    record.force[i] *= strength(static_cast<double>(i) / static_cast<double>(kCycle));
  }
  return record;
}

Record WithNoise(Record record, double deviation, Generator& generator) {
  for (double& force : record.force) force += deviation * testing::Normal(generator);
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

/// Begins with a factor, and settles at 1 as e^{−cycle/τ}.
OfCycle RunningIn(double factor, double time) {
  return [=](double cycle) { return 1 + (factor - 1) * std::exp(-cycle / time); };
}

TEST(Trim, LeavesARecordOfOneTestWhole) {
  for (const double cycles : {2.0, 5.0, 20.0, 20.4}) {
    const Trim trim = FindTrim(Cycled(cycles));
    EXPECT_TRUE(trim.parts.empty()) << cycles;
    EXPECT_FALSE(trim.has_first_loading());
    EXPECT_EQ(trim.samples, Cycled(cycles).size());
  }
  EXPECT_EQ(FindTrim(Cycled(5)).settling, Settling::kFewCycles);
  EXPECT_EQ(FindTrim(Cycled(20)).settling, Settling::kSettled);
}

TEST(Trim, LeavesOutRestsButForTheSampleThatTheMotionBeginsFrom) {
  const Trim trim = FindTrim(WithRests(Cycled(3), 90, 40));
  ASSERT_EQ(trim.parts.size(), 2U);
  EXPECT_EQ(trim.parts[0].reason, TrimReason::kRest);
  EXPECT_EQ(trim.parts[0].first, 0U);
  EXPECT_EQ(trim.parts[0].last, 90U);  // the sine's own first sample is at rest too, and stays
  EXPECT_EQ(trim.parts[1].last, 90U + 3 * kCycle + 1 + 40);
  EXPECT_EQ(trim.parts[1].first, trim.parts[1].last - 40);
  EXPECT_FALSE(trim.has_first_loading());  // it begins after the rest
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

TEST(Trim, LeavesOutRampsOfTheAmplitude) {
  const Trim trim = FindTrim(Cycled(14, [](double cycle) {
    if (cycle < 2) return 0.4 + 0.3 * std::floor(cycle);  // 0.4, 0.7
    return cycle < 12 ? 1.0 : cycle < 13 ? 0.7 : 0.4;
  }));
  ASSERT_EQ(trim.parts.size(), 2U);
  EXPECT_EQ(trim.parts[0].reason, TrimReason::kRamp);
  EXPECT_EQ(trim.parts[1].reason, TrimReason::kRamp);
  EXPECT_TRUE(trim.has_first_loading());
  // Cycles begin at the upper extremes: the third is the first that is as wide as all, the twelfth
  // ends in a narrower one.
  EXPECT_EQ(trim.parts[0].first, 0U);
  EXPECT_EQ(trim.parts[0].last, 2 * kCycle + kTurn);
  EXPECT_EQ(trim.parts[0].cycles, 2U);
  EXPECT_EQ(trim.parts[1].first, 11 * kCycle + kTurn);
  EXPECT_EQ(trim.parts[1].last, trim.samples);
  EXPECT_EQ(trim.parts[1].cycles, 2U);
}

TEST(Trim, ARampMayStandStillForACycle) {
  const Trim trim = FindTrim(Cycled(16, [](double cycle) {
    return cycle < 1 ? 0.4 : cycle < 4 ? 0.7 : 1.0;
  }));
  ASSERT_EQ(trim.parts.size(), 1U);
  EXPECT_EQ(trim.parts[0].reason, TrimReason::kRamp);
  EXPECT_EQ(trim.parts[0].last, 4 * kCycle + kTurn);
  EXPECT_EQ(trim.parts[0].cycles, 4U);
}

TEST(Trim, TakesNoAmplitudesInTurnAndNoGrowingSineForRamps) {
  const OfCycle growing = [](double cycle) { return 0.1 + 0.09 * cycle; };
  const OfCycle in_turn = [](double cycle) { return static_cast<int>(cycle) % 2 == 0 ? 1.0 : 0.6; };
  const OfCycle two_blocks = [](double cycle) { return cycle < 5 ? 0.5 : 1.0; };
  const OfCycle up_and_down_at_first = [](double cycle) {
    return cycle < 1 ? 0.8 : cycle < 2 ? 0.4 : 1.0;
  };
  for (const OfCycle& amplitude : {growing, in_turn, two_blocks, up_and_down_at_first}) {
    const Trim trim = FindTrim(Cycled(10, amplitude));
    EXPECT_TRUE(trim.parts.empty());
    EXPECT_EQ(trim.settling, Settling::kFewCycles);
  }
}

TEST(Trim, LeavesOutWhatHasNotSettledToOnePerCent) {
  for (const double factor : {0.7, 1.4}) {
    constexpr double kTime = 2.0;  // [cycles]
    const Trim trim = FindTrim(Cycled(30, Always, RunningIn(factor, kTime)));
    ASSERT_EQ(trim.parts.size(), 1U);
    const TrimmedPart& part = trim.parts.front();
    EXPECT_EQ(part.reason, TrimReason::kRunningIn);
    EXPECT_EQ(trim.settling, Settling::kSettled);
    EXPECT_TRUE(trim.has_first_loading());
    EXPECT_EQ(part.first, 0U);
    EXPECT_EQ(part.last, part.cycles * kCycle + kTurn);
    // |factor − 1|·e^{−c/τ} = 0.01; a cycle's facts are of its middle, three quarters past its
    // number, half a cycle to either side.
    const double settled = kTime * std::log(std::abs(factor - 1) / 0.01);
    EXPECT_NEAR(static_cast<double>(part.cycles) + 0.75, settled, 1.0);
  }
}

TEST(Trim, LeavesARecordWholeThatDoesNotSettle) {
  const auto drifting = [](double cycle) { return 1 + 0.01 * cycle; };
  const auto too_slow = RunningIn(0.5, 15);
  for (const OfCycle& strength : {OfCycle(drifting), OfCycle(too_slow)}) {
    const Trim trim = FindTrim(Cycled(20, Always, strength));
    EXPECT_TRUE(trim.parts.empty());
    EXPECT_EQ(trim.settling, Settling::kUnsettled);
  }
}

// Of the last four of eight cycles, y = 1 + b k + r (1, −1, −1, 1): Student's t of their slope is
// b √5/(√2 r) with two degrees of freedom, beyond which chance lies in one of a hundred at 9.92 to
// either side, and at 6.96 to one.
TEST(Trim, ATrendOfTheLastHalfIsJudgedToEitherSide) {
  const auto settling_at = [](double t) {
    constexpr double kSlope = 0.005;  // 1.5 % over the last half
    const double ripple = kSlope * std::sqrt(2.5) / t;
    const auto strength = [&](double cycle) {
      // Cycles are from the first turn, a quarter in.
      const int number = static_cast<int>(std::floor(cycle - 0.25)) - 4;
      if (number < 0) return 1.0;
      return 1 + kSlope * number + (number % 3 == 0 ? ripple : -ripple);
    };
    return FindTrim(Cycled(8.5, Always, strength)).settling;
  };
  EXPECT_EQ(settling_at(8.3), Settling::kSettled);
  EXPECT_EQ(settling_at(12.0), Settling::kUnsettled);
}

TEST(Trim, LeavesARecordWholeThatIsOffForMoreThanHalfOfIt) {
  // A step after 13 of 20 cycles: the last half is on both sides of it.
  const Trim trim =
      FindTrim(Cycled(20, Always, [](double cycle) { return cycle < 13 ? 0.8 : 1.0; }));
  EXPECT_TRUE(trim.parts.empty());
}

TEST(Trim, TakesOffCyclesOnBothSidesForScatter) {
  const Trim trim = FindTrim(Cycled(20, Always, [](double cycle) {
    return cycle < 2.25 ? 0.9 : cycle < 3.25 ? 1.1 : 1.0;
  }));
  // Those below are left out, that above them is not.
  ASSERT_EQ(trim.parts.size(), 1U);
  EXPECT_EQ(trim.parts[0].cycles, 2U);
}

TEST(Trim, SaysRestRampAndRunningInOneAfterTheOther) {
  const Record record = WithRests(
      Cycled(
          30, [](double cycle) { return std::min(1.0, (cycle + 0.5) / 3); }, RunningIn(0.6, 2.0)),
      80, 0);
  const Trim trim = FindTrim(record);
  ASSERT_EQ(trim.parts.size(), 3U);
  EXPECT_EQ(trim.parts[0].reason, TrimReason::kRest);
  EXPECT_EQ(trim.parts[1].reason, TrimReason::kRamp);
  EXPECT_EQ(trim.parts[2].reason, TrimReason::kRunningIn);
  EXPECT_EQ(trim.parts[1].first, trim.parts[0].last);
  EXPECT_EQ(trim.parts[2].first, trim.parts[1].last);
  // Each cycle once.
  EXPECT_EQ(80 + kTurn + (trim.parts[1].cycles + trim.parts[2].cycles) * kCycle,
            trim.parts[2].last);
}

TEST(Trim, LeavesNothingOutOfWhatNoiseMakesOfASteadyTest) {
  // Two facts at a chance of 1/2000 a side, of which one side begins a running-in, and a slope at
  // one of 200 that has to be 1 % too: three in a thousand; of 400 more than 6 once in 10⁴.
  constexpr std::size_t kRecords = 400;
  constexpr std::size_t kMost = 6;
  for (const double cycles : {9.0, 14.0, 40.0}) {
    Generator generator(7);
    std::size_t trimmed = 0;
    for (std::size_t k = 0; k < kRecords; ++k) {
      // 20 % of Tc: the half gap of one cycle scatters by some per cent.
      trimmed += FindTrim(WithNoise(Cycled(cycles), 8.0, generator)).parts.empty() ? 0 : 1;
    }
    EXPECT_LE(trimmed, kMost) << cycles;
    RecordProperty("of_400_with_" + std::to_string(static_cast<int>(cycles)) + "_cycles",
                   static_cast<int>(trimmed));
  }
}

TEST(Trim, FindsARunningInUnderNoise) {
  constexpr std::size_t kRecords = 200;
  Generator generator(11);
  std::size_t found = 0;
  for (std::size_t k = 0; k < kRecords; ++k) {
    const Trim trim = FindTrim(WithNoise(Cycled(30, Always, RunningIn(0.7, 2.0)), 0.4, generator));
    const bool is_there = trim.parts.size() == 1 && trim.parts[0].cycles >= 5 &&
                          trim.parts[0].cycles <= 8;  // 6 without noise
    found += is_there ? 1 : 0;
  }
  EXPECT_GE(found, kRecords * 95 / 100);
}

TEST(Trim, IsIndependentOfForceSignAndWindow) {
  Record record = Cycled(30, Always, RunningIn(0.7, 2.0));
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
  EXPECT_EQ(trim.settling, Settling::kFewCycles);
}

TEST(Trim, NamesItsReasons) {
  EXPECT_EQ(NameOf(TrimReason::kRest), "rest");
  EXPECT_EQ(NameOf(TrimReason::kRamp), "ramp");
  EXPECT_EQ(NameOf(TrimReason::kRunningIn), "running_in");
}

}  // namespace
}  // namespace mindahl::loop::trim_test
