
#include "identification/inference/estimates.h"
#include "identification/problem/parameters.h"
#include "identification/stages.h"
#include "support/prelude.h"

// Intervals that reach to what can be read off a loop.
namespace mindahl::identification::covering_test {
namespace {

// Tc is at the reference load, the plateau at the record's.
TEST(CoverPlateau, BringsThePlateauToTheReferenceLoad) {
  constexpr double kLoadRatio = 2.0;
  for (const double plateau : {2.5, 1.5}) {  // of Tc in [1.9, 2.1], above it and below
    FitResult result = testing::MadeFit(/*peak_force=*/kLoadRatio * plateau);
    result.records[0].load_ratio = kLoadRatio;
    result.records[0].facts.half_gap = kLoadRatio * plateau;
    Thresholds thresholds;
    thresholds.mobilised_by_asymptote = 0.5;
    result.parameters[kSlipForce] = CoverPlateau(result, thresholds);
    EXPECT_DOUBLE_EQ(*result.parameters[kSlipForce].lower95, std::min(1.9, plateau));
    EXPECT_DOUBLE_EQ(*result.parameters[kSlipForce].upper95, std::max(2.1, plateau));
  }
}

TEST(IsAnotherMinimum, IsOneWithinTheSquaredQuantileWhoseLawIsElsewhere) {
  // Of white noise of variance 1 a sum of squares larger by up to 1.96² is as likely at 95 %.
  const auto displacement = testing::Cycling(testing::Wave::kSine, 3e-6, 2.0, 50);
  testing::Stages stages(testing::MakeRecord(
      displacement,
      testing::Respond(testing::Model("mindlin-dahl"), {4e7, 1.0 / 3, 40.0}, displacement)));
  const Solution best = stages.Solve();
  const Noise noise = testing::KnownNoise(1.0, stages.data.counted);
  std::vector<ParameterEstimate> estimates(3);
  for (const std::size_t p : {kStiffness, kShape, kSlipForce}) {
    const double value = stages.problem.parameters[p].ToValue(best.theta[p]);
    estimates[p].lower95 = 0.99 * value;
    estimates[p].upper95 = 1.01 * value;
  }
  Solution other = best;
  other.converged = true;
  const auto is_one = [&](double more, double slip_force) {
    other.sum_of_squares = best.sum_of_squares + more;
    other.theta[kSlipForce] = best.theta[kSlipForce] + std::log(slip_force);
    return IsAnotherMinimum(stages.problem, best, other, noise, estimates);
  };
  EXPECT_TRUE(is_one(3.8, 1.1));
  EXPECT_FALSE(is_one(3.9, 1.1));
  EXPECT_FALSE(is_one(3.8, 1.005));
}

}  // namespace
}  // namespace mindahl::identification::covering_test
