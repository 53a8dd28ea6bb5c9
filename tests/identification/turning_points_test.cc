#include "identification/solve/turning_points.h"

#include "identification/stages.h"
#include "support/prelude.h"

// Turning points between samples: what an overshoot does to the forces, and when it is fitted.
namespace mindahl::identification::turning_points_test {
namespace {

constexpr BranchLaw kLaw{4e7, 0.4, 40.0};
constexpr double kReach = 1.4e-6;  // [m]

/// Every n-th sample of a record: its extremes lie between them.
Record Sparse(const Record& dense, std::size_t begin, std::size_t every) {
  Record record;
  for (std::size_t i = begin; i < dense.size(); i += every) {
    record.displacement.push_back(dense.displacement[i]);
    record.force.push_back(dense.force[i]);
  }
  return record;
}

/// How far beyond the outermost sample of a motion its turning points are said to lie, on average
/// over those of a record of 10 cycles whose extremes fall anywhere between samples, less the
/// truth.
double LargestErrorOfOvershoot(Wave wave, int samples_a_cycle) {
  constexpr int kFine = 64;
  constexpr double kCycles = 10.0;
  double largest = 0.0;
  for (std::size_t begin = 0; begin < kFine; begin += 5) {
    const auto displacement = Cycling(wave, kReach, kCycles, samples_a_cycle * kFine);
    const Record record = Sparse(testing::LoopOf(kLaw, displacement), begin, kFine);
    const Stages stages(record);
    const ScaledRecord& scaled = stages.data.records[0];
    const auto [least, greatest] = std::ranges::minmax(displacement);
    for (std::size_t k = 0; k < scaled.reversals.size(); ++k) {
      const double sample = record.displacement[scaled.reversals[k]];
      const double truth = sample > 0 ? greatest - sample : sample - least;
      const double said = OvershootOfMotion(scaled, k) * stages.data.length;
      largest = std::max(largest, std::abs(said - truth) / kReach);
    }
  }
  return largest;
}

TEST(TurningPoints, OfASmoothMotionAreThoseOfThePolynomialThroughFiveSamples) {
  for (const int samples : {12, 25, 50}) {
    const double step = 2 * M_PI / samples;
    EXPECT_LT(LargestErrorOfOvershoot(Wave::kSine, samples), std::pow(step, 6) / 200) << samples;
  }
}

TEST(TurningPoints, OfASharpMotionAreWhereItsLinesMeet) {
  constexpr double kRounding = 1e-9;  // of differences of samples over small differences of slopes
  EXPECT_LT(LargestErrorOfOvershoot(Wave::kTriangle, 24), kRounding);
}

TEST(TurningPoints, BetweenSamplesLeaveIntervalsTheirCoverage) {
  // 25 samples a cycle, 1 % noise: the outermost samples for turning points would leave Tc's
  // intervals 48 to 90 % (0.3 and 1 % noise). 95 % of 200, less three standard deviations.
  constexpr int kLoops = 200;
  constexpr double kLeast = 0.95 - 3 * 0.0154;
  const auto dense = Cycling(Wave::kSine, kReach, 3.0, 25 * 64);
  const Record exact = Sparse(testing::LoopOf(kLaw, dense), 0, 64);
  for (const double noise : {0.003, 0.01}) {
    Generator generator(3);
    int covered = 0;
    Fitter fitter;
    for (int k = 0; k < kLoops; ++k) {
      const Record record = WithForceNoise(exact, noise * kLaw.slip_force, generator);
      const ParameterEstimate& estimate =
          *fitter.Fit(RecordView(record), Depth::kErrors).Find("slip_force");
      if (Covers(estimate, kLaw.slip_force)) ++covered;
    }
    EXPECT_GE(covered, kLeast * kLoops) << noise;
  }
}

}  // namespace
}  // namespace mindahl::identification::turning_points_test
