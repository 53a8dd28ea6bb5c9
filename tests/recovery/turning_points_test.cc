

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

TEST(TurningPoints, BetweenSamplesAreInterpolatedAndTheContactIsRecovered) {
  const BranchLaw truth = MapMindlinToDahl(kContact);
  for (const double lambda : {0.5, 0.8, 1.2, 3.0}) {
    for (const int samples_per_cycle : {50, 101, 201}) {
      for (const double direction : {1.0, -1.0}) {
        SCOPED_TRACE(::testing::Message() << "lambda " << lambda << ", " << samples_per_cycle
                                          << " samples a cycle, direction " << direction);
        const Record record = LoopWithMissedExtremes(lambda, samples_per_cycle, direction);
        const FitResult fit = Fit({&record, 1}, {});
        EXPECT_TRUE(fit.converged);
        // The interpolated extreme is off by (2π/n)⁶/200 of X; each parameter by some times that.
        const double tolerance =
            testing::kNoiseFree + 20 * std::pow(2 * M_PI / samples_per_cycle, 6) / 200;
        EXPECT_NEAR(fit.law.tangential_stiffness / truth.tangential_stiffness, 1, tolerance);
        EXPECT_NEAR(fit.law.shape_exponent, truth.shape_exponent, tolerance);
        EXPECT_NEAR(fit.law.slip_force / truth.slip_force, 1, tolerance);
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::identification::turning_points_test
