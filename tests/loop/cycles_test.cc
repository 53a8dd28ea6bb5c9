#include <random>

#include "../support/histories.h"
#include "mindahl/loop/facts.h"
#include "mindahl/loop/reversals.h"
#include "support/prelude.h"

namespace mindahl::loop::cycles_test {
namespace {

constexpr double kPi = std::numbers::pi;

/// An ellipse x = centre + X·sin θ, T = offset + T*·sin(θ + lag): its area is π·X·T*·sin(lag).
struct Ellipse {
  double amplitude = 2e-6;
  double peak_force = 30.0;
  double lag = 0.4;
  double centre = 0.0;
  double offset = 0.0;
  double cycles = 4.0;
  double start = 0.0;  // θ of the first sample
};

constexpr std::size_t kSamplesPerCycle = 1000;

Record MakeRecord(const Ellipse& ellipse) {
  Record record;
  const auto samples = static_cast<std::size_t>(std::llround(ellipse.cycles * kSamplesPerCycle));
  for (std::size_t i = 0; i <= samples; ++i) {
    const double theta =
        ellipse.start + 2 * kPi * static_cast<double>(i) / static_cast<double>(kSamplesPerCycle);
    record.displacement.push_back(ellipse.centre + ellipse.amplitude * std::sin(theta));
    record.force.push_back(ellipse.offset + ellipse.peak_force * std::sin(theta + ellipse.lag));
  }
  return record;
}

double Area(const Ellipse& ellipse) {
  return kPi * ellipse.amplitude * ellipse.peak_force * std::sin(ellipse.lag);
}

/// A polygon of n sides in an ellipse has 1 − (2π/n)²/6 of its area.
constexpr double kPolygon = 1.01 * (2 * kPi / kSamplesPerCycle) * (2 * kPi / kSamplesPerCycle) / 6;

std::vector<std::size_t> Reversals(const Record& record) {
  return FindReversals(record.displacement, 0.0);
}

LoopFacts FactsOf(const Record& record) { return MeasureFacts(record, Reversals(record), 1); }

int SenseOf(const Record& record) { return ForceSense(record, FactsOf(record)); }

std::vector<double> EnergiesOf(const Record& record) {
  std::vector<double> energies;
  for (const CycleFacts& cycle : FactsOf(record).cycles) energies.push_back(cycle.energy);
  return energies;
}

TEST(EnergyOfCycles, IsTheAreaOfTheLoop) {
  const Ellipse ellipse;
  const Record record = MakeRecord(ellipse);
  const auto energies = EnergiesOf(record);
  ASSERT_EQ(energies.size(), 3U);  // of 4 cycles from mid-swing, 3 run from extreme to extreme
  for (const double energy : energies) {
    EXPECT_NEAR(energy, Area(ellipse), kPolygon * Area(ellipse));
  }
  const Record from_an_extreme = MakeRecord({.start = kPi / 2});
  EXPECT_EQ(EnergiesOf(from_an_extreme).size(), 4U);
}

TEST(EnergyOfCycles, DoesNotChangeWithOffsets) {
  const Ellipse plain;
  // Far off centre: 1e3 times the amplitude; rounding is then 1e3 times larger too.
  constexpr double kRounding = 1e3 * kSamplesPerCycle * std::numeric_limits<double>::epsilon();
  const Record record = MakeRecord(plain);
  const Record moved = MakeRecord({.centre = 2e-3, .offset = 3e4});
  const auto energies = EnergiesOf(record);
  const auto moved_energies = EnergiesOf(moved);
  ASSERT_EQ(moved_energies.size(), energies.size());
  for (std::size_t i = 0; i < energies.size(); ++i) {
    EXPECT_NEAR(moved_energies[i], energies[i], kRounding * energies[i]);
  }
}

TEST(EnergyOfCycles, ClosesADriftingLoopByAChord) {
  // A ratchet: the second maximum lies beyond the first. From (2,2) by (0,0) to (3,1) and back by
  // the chord: by hand, ∮T dx = −2 + 1.5 − 1.5 = −2.
  const Record record{{1, 2, 0, 3, 1}, {0, 2, 0, 1, 0}, {}, {}};
  const auto energies = EnergiesOf(record);
  ASSERT_EQ(energies.size(), 1U);
  EXPECT_DOUBLE_EQ(energies.front(), -2.0);
}

TEST(EnergyOfCycles, NeedsAClosedCycleAndAnEnergyThatADoubleHolds) {
  const Record huge{{0, 1e200, -1e200, 1e200, -1e200}, {0, 1e200, -2e200, 3e200, 0}, {}, {}};
  EXPECT_THROW(EnergiesOf(huge), InvalidArgument);
  const Record record = MakeRecord({.cycles = 0.6});
  EXPECT_TRUE(EnergiesOf(record).empty());
  EXPECT_TRUE(EnergiesOf(Record{{0, 1}, {0, 1}, {}, {}}).empty());
}

TEST(MeasureFacts, ReadsAmplitudeAndForce) {
  const Ellipse ellipse{.lag = 0.0, .centre = 5e-6, .offset = -7.0};
  constexpr double kRounding = 1e-14;  // of sums of a few numbers of this size
  const Record record = MakeRecord(ellipse);
  const LoopFacts measures = FactsOf(record);
  EXPECT_NEAR(measures.amplitude, 2e-6, kRounding * 5e-6);
  EXPECT_NEAR(measures.peak_force, 30.0, kRounding * 30);
}

TEST(MeasureFacts, ReadsThePeakForceWhereverInTheSwingItIs) {
  const Record record = MakeRecord({.lag = 0.4});
  // The mean of a sine over 1/40 of a cycle about its peak is short of it by (π/40)²/6.
  constexpr double kHalfWindow = kPi / 40;
  constexpr double kAveraging = 1.05 * kHalfWindow * kHalfWindow / 6;
  EXPECT_NEAR(FactsOf(record).peak_force, 30.0, kAveraging * 30);
}

TEST(MeasureFacts, ReadsASharpTipExactly) {
  // A triangle of displacement and force: the peak is one sample, which averaging would blunt.
  const std::vector<double> x = {0,  1,  2,  3,  4,  3, 2, 1, 0, -1, -2,
                                 -3, -4, -3, -2, -1, 0, 1, 2, 3, 4,  3};
  const Record record{x, x, {}, {}};
  EXPECT_DOUBLE_EQ(FactsOf(record).peak_force, 4.0);
}

TEST(MeasureFacts, NoiseDoesNotRaiseThePeakForce) {
  Record record = MakeRecord({.lag = 0.4, .cycles = 20});
  std::mt19937_64 engine(3);
  constexpr double kNoise = 0.6;  // 2 % of the peak; its extremes would add three times as much
  std::normal_distribution<double> noise(0.0, kNoise);
  for (double& force : record.force) force += noise(engine);
  EXPECT_NEAR(FactsOf(record).peak_force, 30.0, kNoise);
}

TEST(MeasureFacts, ASpikeInOneSwingIsNoPeakForce) {
  Record record = MakeRecord({});
  const double peak = FactsOf(record).peak_force;
  record.force[1600] += 1000;
  record.force[2100] -= 1000;
  EXPECT_DOUBLE_EQ(FactsOf(record).peak_force, peak);
}

TEST(MeasureFacts, NestedSwingsDoNotEnterTheAmplitude) {
  //                  main swings 0 ↔ 10, with a nested loop 6 → 4 → 6 on the way up
  const std::vector<double> x = {0, 5, 10, 5, 0, 6, 4, 10, 5, 0, 5, 10};
  const Record record{x, x, {}, {}};
  const LoopFacts measures = FactsOf(record);
  EXPECT_DOUBLE_EQ(measures.amplitude, 5.0);
  EXPECT_DOUBLE_EQ(measures.peak_force, 5.0);
}

TEST(MeasureFacts, CountsCompleteCycles) {
  const auto cycles = [](double count, double start) {
    const Record record = MakeRecord({.cycles = count, .start = start});
    return FactsOf(record).complete_cycles;
  };
  for (const double start : {0.0, kPi / 2, kPi, 3 * kPi / 2}) {
    EXPECT_EQ(cycles(1.0, start), 1U) << start;
    EXPECT_EQ(cycles(5.0, start), 5U) << start;
    EXPECT_EQ(cycles(1.5, start), 1U) << start;
    EXPECT_EQ(cycles(9.5, start), 9U) << start;
    EXPECT_EQ(cycles(2.25, start), 2U) << start;
  }
  EXPECT_EQ(cycles(0.2, 0.0), 0U);
}

TEST(MeasureFacts, MonotoneLoadingHasNoCycleAndRestNoAmplitude) {
  const LoopFacts monotone = FactsOf(Record{{1, 2, 4}, {0, 3, 5}, {}, {}});
  EXPECT_EQ(monotone.complete_cycles, 0U);
  EXPECT_DOUBLE_EQ(monotone.amplitude, 1.5);
  EXPECT_DOUBLE_EQ(monotone.peak_force, 2.5);
  const LoopFacts constant = FactsOf(Record{{2, 2, 2}, {1, 1, 1}, {}, {}});
  EXPECT_EQ(constant.amplitude, 0.0);
  EXPECT_EQ(constant.complete_cycles, 0U);
}

TEST(ForceSense, OfElasticLineFollowsItsSlope) {
  // Its energy is rounding alone: either sign.
  for (const double slope : {4.8e8, -4.8e8}) {
    for (const double offset : {0.0, 1e-3, 17.0}) {
      Record record = MakeRecord({.centre = 0.3e-6});
      for (std::size_t i = 0; i < record.size(); ++i) {
        record.force[i] = offset + slope * record.displacement[i];
      }
      EXPECT_EQ(SenseOf(record), slope > 0 ? 1 : -1);
    }
  }
}

// The energy of a contact that sticks is that of the noise alone, 1.1 σ/(T* √n) of the rectangle
// round the loop for n samples a cycle: 1 to 4 % here, with either sign, where the slope has
// √(n/2) T*/σ = 17 standard errors or more.
TEST(ForceSense, OfStickingContactFollowsItsSlope) {
  constexpr double kSamples = 100;
  Generator generator(7);
  for (int k = 0; k < 300; ++k) {
    const double sign = k % 2 == 0 ? 1.0 : -1.0;
    const double noise = testing::Uniform(generator, 0.1, 0.4);
    Record record{.displacement = Sine(2, kSamples)};
    for (const double x : record.displacement) {
      record.force.push_back(sign * x + noise * testing::Normal(generator));
    }
    EXPECT_EQ(SenseOf(record), sign > 0 ? 1 : -1) << k;
  }
}

TEST(ForceSense, OfGrossSlipLoopFollowsEnergyDespiteFallingPlateau) {
  // A rectangle with a plateau that falls: the covariance is negative, the contact dissipates.
  Record record;
  for (int cycle = 0; cycle < 3; ++cycle) {
    for (int i = -50; i <= 50; ++i) {
      record.displacement.push_back(i);
      record.force.push_back(1.0 - 0.01 * i);
    }
    for (int i = 50; i >= -50; --i) {
      record.displacement.push_back(i);
      record.force.push_back(-1.0 - 0.01 * i);
    }
  }
  EXPECT_EQ(SenseOf(record), 1);
}

TEST(ForceSense, FollowsTheEnergyThatExceedsFiveDeviationsOfItsNoise) {
  // Four cycles of 40 samples, X = 1: friction of 1 on a spring of −2, and a noise of ±e in turn. A
  // cycle loses 4 but for the steps at the turns. Second differences of the noise are 4e, of which
  // 4e/(0.6745·√6) = 2.42e is a deviation; with Σ((x[i+1] − x[i−1])/2)² = 80·sin²9° that of the
  // mean energy is 0.847e. The energy is five of them at e = 0.939.
  const auto sign_under = [](double noise) {
    Record record;
    for (int i = 0; i <= 160; ++i) {
      const double x = -std::cos(2 * kPi * i / 40);
      const double friction = i % 20 == 0 ? 0.0 : i % 40 < 20 ? 1.0 : -1.0;
      record.displacement.push_back(x);
      record.force.push_back(-2 * x + friction + (i % 2 == 0 ? noise : -noise));
    }
    return SenseOf(record);
  };
  EXPECT_EQ(sign_under(0.8 * 0.939), 1);
  EXPECT_EQ(sign_under(1.2 * 0.939), -1);  // of the spring
}

TEST(ForceSense, WithoutClosedCycleFollowsTheCovarianceUnlessThereIsNone) {
  EXPECT_EQ(SenseOf(Record{{0, 1, 2}, {5, 6, 8}, {}, {}}), 1);
  EXPECT_EQ(SenseOf(Record{{0, 1, 2}, {-5, -6, -8}, {}, {}}), -1);
  EXPECT_EQ(SenseOf(Record{{0, 1, 2, 1, 0}, {3, 3, 3, 3, 3}, {}, {}}), 0);
}

TEST(ForceSense, IsRightOnManyNoisyRecords) {
  Generator generator(12);
  for (int i = 0; i < 200; ++i) {
    const double sign = i % 2 == 0 ? 1.0 : -1.0;
    Record record = MakeRecord({.lag = testing::Uniform(generator, 0.0, 1.4),
                                .centre = testing::Uniform(generator, -0.1, 0.1),
                                .offset = testing::Uniform(generator, -100, 100)});
    for (double& force : record.force) force = sign * force + testing::Normal(generator);
    ASSERT_EQ(SenseOf(record), sign > 0 ? 1 : -1);
  }
}

}  // namespace
}  // namespace mindahl::loop::cycles_test
