#include "../support/histories.h"
#include "mindahl/loop/disturbances.h"
#include "mindahl/loop/reversals.h"
#include "support/prelude.h"

namespace mindahl::loop::displacement_noise_test {
namespace {

History Repeated(const History& history, std::size_t times) {
  History repeated;
  for (const double displacement : history) repeated.insert(repeated.end(), times, displacement);
  return repeated;
}

double RmsDifference(const History& one, const History& other) {
  double sum = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) sum += (one[i] - other[i]) * (one[i] - other[i]);
  return std::sqrt(sum / static_cast<double>(one.size()));
}

constexpr double kNoise = 0.02;
// Three standard deviations of an estimate with the efficiency 0.4 from n samples: 3/√(0.8·n).
double NoiseTolerance(std::size_t samples) {
  return kNoise * 3 / std::sqrt(0.8 * static_cast<double>(samples));
}

TEST(EstimateDisplacementNoise, FindsThatOfASmoothDrive) {
  Generator generator(1);
  const History drive = Sine(20, 300);
  EXPECT_NEAR(EstimateDisplacementNoise(WithNoise(generator, drive, kNoise)), kNoise,
              NoiseTolerance(drive.size()));
}

TEST(EstimateDisplacementNoise, PassesOverRepeatedReadings) {
  Generator generator(2);
  const History drive = Sine(20, 300);
  EXPECT_NEAR(EstimateDisplacementNoise(Repeated(WithNoise(generator, drive, kNoise), 8)), kNoise,
              NoiseTolerance(drive.size()));
}

TEST(EstimateDisplacementNoise, IsThatOfRoundingAtLeastForAnEncoder) {
  constexpr double kStep = 0.01;
  constexpr double kRounding = 1e-12;  // of readings, over their step
  EXPECT_GE(EstimateDisplacementNoise(Quantised(Sine(3, 2000), kStep)),
            kStep / std::sqrt(12.0) * (1 - kRounding));
}

TEST(EstimateDisplacementNoise, IsZeroForFewerThanFourDifferentSamples) {
  EXPECT_EQ(EstimateDisplacementNoise(History{0, 0, 1, 1, 0, 0}), 0.0);
  EXPECT_EQ(EstimateDisplacementNoise(History{}), 0.0);
}

TEST(EncoderStep, IsFoundWhereADriveOfAnyShapeIsCounted) {
  constexpr double kStep = 0.053;
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(EncoderStep(Quantised(Sine(3, 200), kStep)), kStep, kRounding);
  EXPECT_NEAR(EncoderStep(Quantised(Sine(3, 5000), kStep)), kStep, kRounding);
  EXPECT_NEAR(EncoderStep(Quantised(Triangle(3, 200), kStep)), kStep, kRounding);
  constexpr double kFine = 0.0013;  // several counts between samples, no rests within a stroke
  EXPECT_NEAR(EncoderStep(Quantised(Sine(3, 200), kFine)), kFine, kRounding);
}

TEST(EncoderStep, IsZeroForADriveThatRunsEvenlyOrFromRestToRest) {
  History between;  // turns half way between two samples
  for (std::size_t i = 0; i < 600; ++i) {
    const std::size_t turn = i % 50;
    between.push_back(static_cast<double>(turn < 25 ? turn : 49 - turn));
  }
  EXPECT_EQ(EncoderStep(between), 0.0);
  EXPECT_EQ(EncoderStep(Repeated(between, 3)), 0.0);
  EXPECT_EQ(EncoderStep(Sine(3, 200)), 0.0);
  History growing;  // triangles of four amplitudes, of as many samples a stroke
  for (std::size_t i = 0; i < 800; ++i) {
    const auto stage = static_cast<double>(1 + i / 200);
    growing.push_back(stage * between[i % 600]);
  }
  EXPECT_EQ(EncoderStep(growing), 0.0);
  // A trapezoid whose ramps end with half a step, and whose dwells differ by a sample.
  History dwells;
  for (std::size_t i = 0; i < 600; ++i) {
    const double phase = std::fmod(static_cast<double>(i), 100.5);
    const double up = std::min(phase, 25.5);
    dwells.push_back(phase < 50 ? up : std::max(25.5 - (phase - 50), 0.0));
  }
  EXPECT_EQ(EncoderStep(dwells), 0.0);
}

History SmoothedOf(const History& readings, double noise) {
  return Smoothed(readings, SmoothingReaches(readings, noise));
}

TEST(Smoothed, LeavesARecordWithoutNoiseAsItIs) {
  const History drive = Sine(2, 100);
  EXPECT_EQ(SmoothedOf(drive, 0.0), drive);
}

TEST(Smoothed, TakesMostOfTheNoiseFromASine) {
  Generator generator(3);
  const History drive = Sine(3, 200);
  const History noisy = WithNoise(generator, drive, kNoise);
  // Windows of half a radian, 2h + 1 = 33 samples, leave √(9/4·33) = 0.26; those cut short by
  // chance and at the ends leave more.
  EXPECT_LT(RmsDifference(SmoothedOf(noisy, kNoise), drive), 0.4 * kNoise);
}

TEST(Smoothed, KeepsTheCornersOfATriangleToTheNoise) {
  Generator generator(4);
  const History drive = Triangle(3, 200);
  const History noisy = WithNoise(generator, drive, kNoise);
  const History smoothed = SmoothedOf(noisy, kNoise);
  // A parabola through 2h + 1 samples cuts a corner by 3/16·h steps; windows whose estimates differ
  // by the 2.5 deviations of both are found out, and half of that is left.
  for (std::size_t i = 50; i < drive.size(); i += 100) {
    EXPECT_NEAR(smoothed[i], drive[i], 2.5 * kNoise) << i;
  }
}

TEST(Smoothed, RefusesANegativeNoiseAndAnotherNumberOfSamples) {
  const History drive = Sine(1, 100);
  EXPECT_THROW((void)SmoothingReaches(drive, -1.0), InvalidArgument);
  EXPECT_THROW((void)Smoothed(History{0, 1}, SmoothingReaches(drive, kNoise)), InvalidArgument);
}

TEST(MoveReversals, PutsThemOnTheOutermostSamples) {
  Generator generator(5);
  const History drive = Sine(4, 400);
  const History noisy = WithNoise(generator, drive, kNoise);
  const std::vector<std::size_t> found = FindReversals(noisy, 10 * kNoise);
  ASSERT_EQ(found.size(), 8U);
  const History smoothed = SmoothedOf(noisy, kNoise);
  const std::vector<std::size_t> moved = MoveReversals(smoothed, found);
  ASSERT_EQ(moved.size(), found.size());
  for (std::size_t r = 0; r < moved.size(); ++r) {
    const std::size_t begin = r == 0 ? 0 : moved[r - 1];
    const std::size_t end = r + 1 < moved.size() ? moved[r + 1] : smoothed.size() - 1;
    const double sense = r % 2 == 0 ? 1.0 : -1.0;
    for (std::size_t i = begin; i <= end; ++i) {
      EXPECT_LE(sense * smoothed[i], sense * smoothed[moved[r]]) << r << ", " << i;
    }
  }
}

TEST(MoveReversals, LeavesThoseOfACleanRecordButOneThatItBeginsAt) {
  const History drive = Sine(4, 100);
  const std::vector<std::size_t> found = FindReversals(drive, 0.0);
  EXPECT_EQ(MoveReversals(drive, found), found);
  EXPECT_EQ(MoveReversals(History{1.0, 0.9, 0.5, -1.0, 0.0}, std::vector<std::size_t>{1, 3}),
            (std::vector<std::size_t>{3}));
}

}  // namespace
}  // namespace mindahl::loop::displacement_noise_test
