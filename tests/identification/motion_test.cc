#include "identification/problem/motion.h"

#include "identification/stages.h"
#include "support/prelude.h"

// Turning points between samples: where the motion says that they are, and what they are worth.
namespace mindahl::identification::motion_test {
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

/// The largest error of the turning points of a record of 10 cycles, over the half range: extremes
/// fall anywhere between samples.
double LargestErrorOfTurns(Wave wave, int samples_a_cycle) {
  constexpr int kFine = 64;
  constexpr double kCycles = 10.0;
  double largest = 0.0;
  for (std::size_t begin = 0; begin < kFine; begin += 5) {
    const auto displacement = Cycling(wave, kReach, kCycles, samples_a_cycle * kFine);
    Stages stages(Sparse(testing::LoopOf(kLaw, displacement), begin, kFine));
    TurnBetweenSamples(stages.data);
    const ScaledRecord& scaled = stages.data.records[0];
    const auto [least, greatest] = std::ranges::minmax(displacement);
    const std::vector<models::Turn> turns = TurnsOf(scaled);
    // The first and the last one may have no two samples on either side.
    for (std::size_t k = 1; k + 1 < turns.size(); ++k) {
      const double at =
          turns[k].displacement * stages.data.length + scaled.units.displacement_reference;
      largest = std::max(largest, std::abs(at - (at > 0 ? greatest : least)) / kReach);
    }
  }
  return largest;
}

TEST(TurningPoints, OfASmoothMotionAreThoseOfThePolynomialThroughFiveSamples) {
  for (const int samples : {12, 25, 50}) {
    const double step = 2 * M_PI / samples;
    EXPECT_LT(LargestErrorOfTurns(Wave::kSine, samples), std::pow(step, 6) / 200) << samples;
  }
}

TEST(TurningPoints, OfASharpMotionAreWhereItsLinesMeet) {
  constexpr double kRounding = 1e-9;  // of differences of samples over small differences of slopes
  EXPECT_LT(LargestErrorOfTurns(Wave::kTriangle, 24), kRounding);
}

/// The largest distance of a contact whose force is read late from where the motion was, over the
/// half range; but for the ends of the record, where it runs straight.
double LargestErrorOfLateContact(Wave wave, int samples_a_cycle) {
  constexpr int kFine = 64;
  constexpr std::size_t kEnd = 5;  // samples
  double largest = 0.0;
  for (std::size_t begin = 0; begin < kFine; begin += 5) {
    const auto displacement = Cycling(wave, kReach, 10.0, samples_a_cycle * kFine);
    Stages stages(Sparse(testing::LoopOf(kLaw, displacement), begin, kFine));
    TurnBetweenSamples(stages.data);
    const ScaledRecord& scaled = stages.data.records[0];
    const double step = scaled.time[1] - scaled.time[0];
    for (std::size_t late = 0; late < 2 * kFine; late += 3) {
      Motion motion;
      Locate(scaled, TurnsOf(scaled), TermId::kLag, step * static_cast<double>(late) / kFine,
             models::Memory::kReturnPoint, {}, motion);
      const std::vector<double>& contact = motion.paths.front().displacement;
      for (std::size_t i = kEnd; i + kEnd < contact.size(); ++i) {
        const double at = contact[i] * stages.data.length + scaled.units.displacement_reference;
        const double was = displacement[begin + i * kFine - late];
        largest = std::max(largest, std::abs(at - was) / kReach);
      }
    }
  }
  return largest;
}

TEST(TurningPoints, ArePassedByALateContactWhenTheMotionDidSo) {
  for (const int samples : {12, 25, 50}) {
    // Chords would be step²/8 off, and a turn at the sample up to step²/2.
    const double step = 2 * M_PI / samples;
    EXPECT_LT(LargestErrorOfLateContact(Wave::kSine, samples), std::pow(step, 3) / 15) << samples;
  }
  constexpr double kRounding = 1e-13;
  EXPECT_LT(LargestErrorOfLateContact(Wave::kTriangle, 24), kRounding);
}

TEST(TurningPoints, OfAMotionThatIsNeitherAreTheSamples) {
  Generator generator(5);
  std::vector<double> noisy = Cycling(Wave::kSine, kReach, 3.0, 400);
  std::vector<double> counted = noisy;
  std::vector<double> held = noisy;
  for (double& x : noisy) x += 0.05 * kReach * Normal(generator);
  for (double& x : counted) x = 0.05 * kReach * std::round(x / (0.05 * kReach));
  for (double& x : held) x = std::clamp(x, -0.7 * kReach, 0.7 * kReach);
  for (const std::vector<double>& displacement : {noisy, counted, held}) {
    Stages stages(testing::LoopOf(kLaw, displacement));
    TurnBetweenSamples(stages.data);
    const ScaledRecord& scaled = stages.data.records[0];
    std::size_t between = 0;
    for (std::size_t k = 0; k < scaled.reversals.size(); ++k) {
      if (TurnsOf(scaled)[k].displacement != scaled.displacement[scaled.reversals[k]]) ++between;
    }
    EXPECT_LE(10 * between, 2 * scaled.reversals.size());  // by chance
  }
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
}  // namespace mindahl::identification::motion_test
