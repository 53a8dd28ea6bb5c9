#include "identification/inference/reweighting.h"

#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "support/prelude.h"

// The variance that weighted residuals stand for, by hand.
namespace mindahl::identification::reweighting_test {
namespace {

using namespace loop;
using namespace models;

Record WithOutliers(double share) {
  Generator generator(5);
  Record record = Loop();
  for (double& force : record.force) {
    force += 0.3 * testing::Normal(generator);
    if (testing::Uniform(generator, 0, 1) < share) force += 20 * testing::Normal(generator);
  }
  return record;
}

TEST(Reweighting, OfHubersLossHasHubersVariance) {
  // Huber (1981) §7.6 for JᵀWJ in place of JᵀJ: s²·[Σψ²/(n − p)]·w̄/[Σψ'/n]², ψ of the residuals
  // over their scale s, 1.4826 times the median of their magnitudes.
  FitOptions options;
  options.loss = Loss::kHuber;
  Stages robust(WithOutliers(0.2), options);
  // Weights have settled to 1e-4 of the noise: the scale and its functions to as much.
  const auto [settled, at] = FitWeighted(robust);
  for (double& w : robust.data.records[0].root_weight) w = 1.0;
  const Eigen::VectorXd r = robust.ResidualsAt(at.theta);
  std::vector<double> sorted;
  for (const double value : r) sorted.push_back(std::abs(value));
  std::ranges::sort(sorted);
  const double s = 1.482602218505602 * sorted[sorted.size() / 2];
  double influence = 0.0;
  double slope = 0.0;
  double weight = 0.0;
  std::size_t outliers = 0;
  for (const double value : r) {
    const double z = std::abs(value) / s;
    influence += std::pow(std::min(z, 1.345), 2);
    slope += z <= 1.345 ? 1 : 0;
    weight += std::min(1.0, 1.345 / z);
    outliers += z > 2 * 1.345 ? 1 : 0;
  }
  const auto count = static_cast<double>(r.size());
  const auto parameters = static_cast<double>(robust.problem.parameters.free().size());
  const double expected =
      s * s * influence / (count - parameters) * (weight / count) / std::pow(slope / count, 2);
  EXPECT_LT(weight / count, 0.93) << "the case needs it";
  EXPECT_NEAR(settled.variance / expected, 1.0, 2e-3);
  EXPECT_NEAR(settled.force / s, 1.0, 2e-2);
  EXPECT_NEAR(static_cast<double>(settled.outliers), static_cast<double>(outliers), 1.0);
}

TEST(Reweighting, ForceNoiseWithDisplacementNoiseCountsDegreesOfFreedom) {
  // A displacement that is all but exact leaves the plain estimate: SS/(n − p).
  Generator generator(3);
  const testing::History displacement =
      testing::Cycling(testing::Wave::kSine, testing::kReach, 1.0, 40);
  Record record = testing::LoopOf(kLaw, displacement);
  for (double& force : record.force) force += 0.6 * testing::Normal(generator);
  FitOptions options;
  options.preparation.displacement_noise = 1e-6 * testing::kReach;
  Stages stages(record, options);
  const auto [noise, solution] = FitWeighted(stages);
  const double degrees =
      static_cast<double>(record.size() - stages.problem.parameters.free().size());
  const double plain = std::sqrt(solution.sum_of_squares / degrees);
  EXPECT_NEAR(noise.force / plain, 1.0, 1e-3);
  EXPECT_NEAR(noise.variance / (plain * plain), 1.0, 2e-3);
  ASSERT_EQ(noise.force_share.size(), record.size());
  for (const double share : noise.force_share) EXPECT_NEAR(share, 1.0, 1e-3);
}

TEST(Reweighting, RobustScaleIsTheMedianMagnitudeOfNormalValues) {
  EXPECT_NEAR(RobustScale({-3.0, 1.0, 2.0}), 2 * 1.482602218505602, 1e-12);
  // Φ(1/1.4826) = 3/4
  EXPECT_NEAR(std::erf(1 / RobustScale({1.0}) / std::sqrt(2.0)), 0.5, 1e-12);
}

}  // namespace
}  // namespace mindahl::identification::reweighting_test
