
#include <random>

#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "recovered.h"
#include "support/prelude.h"

namespace mindahl::identification::turning_points_test {
namespace {

using namespace contact;
using namespace loop;
using namespace models;

constexpr MindlinContact kContact{2.7e-3, 4.42e-11, 30.0};

/// Three cycles of Mindlin's loop between ±X, sampled so that X falls between samples. The
/// equations know the true extremes, the record does not show them.
Record LoopWithMissedExtremes(double lambda, int samples_per_cycle, double direction) {
  constexpr double kTwoPi = 6.283185307179586;
  constexpr int kCycles = 3;
  const double amplitude = lambda * GrossSlipDisplacement(kContact);
  Record record;
  for (int i = 0; i <= kCycles * samples_per_cycle; ++i) {
    const double phase = static_cast<double>(i) / samples_per_cycle;
    const double x = amplitude * std::sin(kTwoPi * phase);
    const bool unloading = std::fmod(phase - 0.25, 1.0) < 0.5;
    const double force = phase <= 0.25 ? MindlinVirginForce(kContact, x)
                         : unloading   ? MindlinUnloadingForce(kContact, x, amplitude)
                                       : MindlinReloadingForce(kContact, x, amplitude);
    record.displacement.push_back(direction * x);
    record.force.push_back(direction * force);
  }
  return record;
}

bool Warns(const FitResult& fit, FindingCode code) { return fit.FindFinding(code) != nullptr; }

TEST(TurningPoints, MissedBetweenSamplesAreFoundAndTheContactIsRecovered) {
  const BranchLaw truth = MapMindlinToDahl(kContact);
  for (const double lambda : {0.5, 0.8, 1.2, 3.0}) {
    for (const int samples_per_cycle : {50, 101, 201}) {
      for (const double direction : {1.0, -1.0}) {
        SCOPED_TRACE(::testing::Message() << "lambda " << lambda << ", " << samples_per_cycle
                                          << " samples a cycle, direction " << direction);
        const Record record = LoopWithMissedExtremes(lambda, samples_per_cycle, direction);
        const FitResult fit = Fit({&record, 1}, {});
        EXPECT_TRUE(fit.converged);
        // Of 201 samples a cycle the motion itself tells them to (2π/201)⁶/200 = 5e-12 of it.
        const bool motion_tells = samples_per_cycle == 201;
        EXPECT_TRUE(motion_tells || Warns(fit, "turning_points_between_samples"));
        EXPECT_NEAR(fit.law.tangential_stiffness / truth.tangential_stiffness, 1,
                    testing::kNoiseFree);
        EXPECT_NEAR(fit.law.shape_exponent, truth.shape_exponent, testing::kNoiseFree);
        EXPECT_NEAR(fit.law.slip_force / truth.slip_force, 1, testing::kNoiseFree);
      }
    }
  }
}

TEST(TurningPoints, AreReportedAsFarOutAsTheyWere) {
  constexpr int kSamplesPerCycle = 101;
  const Record record = LoopWithMissedExtremes(0.8, kSamplesPerCycle, 1.0);
  const FitResult fit = Fit({&record, 1}, {});
  const double amplitude = 0.8 * GrossSlipDisplacement(kContact);
  const RecordFit& seen = fit.records.front();
  ASSERT_EQ(seen.overshoot.size(), seen.reversals.size());
  for (std::size_t j = 0; j < seen.reversals.size(); ++j) {
    const double outermost = std::abs(record.displacement[seen.reversals[j]]);
    // The last turning point has few samples after it; the others are known to rounding.
    EXPECT_NEAR(outermost + seen.overshoot[j], amplitude, testing::kNoiseFree * amplitude) << j;
  }
}

TEST(TurningPoints, AreLeftAloneWhereSamplesShowThem) {
  const Record record = LoopWithMissedExtremes(0.8, 200, 1.0);  // a multiple of four
  const FitResult fit = Fit({&record, 1}, {});
  EXPECT_FALSE(Warns(fit, "turning_points_between_samples"));
  EXPECT_TRUE(fit.records.front().overshoot.empty());
}

TEST(TurningPoints, AreLeftAloneWhereNoiseHidesThem) {
  // Missing 1 − cos(π/201) = 1e-4 of the amplitude cannot be seen under 1 % of noise.
  Record record = LoopWithMissedExtremes(0.8, 201, 1.0);
  std::mt19937_64 engine(5);
  std::normal_distribution<double> noise(0.0, 0.01 * kContact.slip_force);
  for (double& force : record.force) force += noise(engine);
  EXPECT_FALSE(Warns(Fit({&record, 1}, {}), "turning_points_between_samples"));
}

TEST(TurningPoints, KeepDahlsOwnLawExactToo) {
  // Dahl's law with α = 1 from v = 1 − sT/Tc: exact between turning points that no sample shows.
  constexpr double kStiffness = 4e7;
  constexpr double kSlipForce = 12.0;
  constexpr double kAmplitude = 4e-7;
  constexpr int kSamplesPerCycle = 90;
  Record record;
  double last_turn = 0.0;
  double force_there = 0.0;
  double sense = 1.0;
  const auto force_at = [&](double x) {
    const double v = 1 - sense * force_there / kSlipForce;
    const double left = v * std::exp(-kStiffness * std::abs(x - last_turn) / kSlipForce);
    return sense * kSlipForce * (1 - left);
  };
  int turns = 0;
  for (int i = 0; i <= 3 * kSamplesPerCycle; ++i) {
    const double phase = static_cast<double>(i) / kSamplesPerCycle;
    if (phase > 0.25 + 0.5 * turns) {
      force_there = force_at(sense * kAmplitude);
      last_turn = sense * kAmplitude;
      sense = -sense;
      ++turns;
    }
    const double x = kAmplitude * std::sin(6.283185307179586 * phase);
    record.displacement.push_back(x);
    record.force.push_back(force_at(x));
  }
  FitOptions options;
  options.model = FindFrictionModel("dahl");
  const FitResult fit = Fit({&record, 1}, options);
  EXPECT_NEAR(fit.law.tangential_stiffness / kStiffness, 1, testing::kNoiseFree);
  EXPECT_NEAR(fit.law.shape_exponent, 1, testing::kNoiseFree);
  EXPECT_NEAR(fit.law.slip_force / kSlipForce, 1, testing::kNoiseFree);
}

}  // namespace
}  // namespace mindahl::identification::turning_points_test
