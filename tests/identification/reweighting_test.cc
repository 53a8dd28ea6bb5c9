#include "identification/inference/reweighting.h"

#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "support/prelude.h"

// The variance that weighted residuals stand for, by hand.
namespace mindahl::identification::reweighting_test {
namespace {

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
  Stages robust(WithOutliers(0.2), {.loss = Loss::kHuber});
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
  Stages stages(record, {.preparation = {.displacement_noise = 1e-6 * testing::kReach}});
  const auto [noise, solution] = FitWeighted(stages);
  const double degrees =
      static_cast<double>(record.size() - stages.problem.parameters.free().size());
  const double plain = std::sqrt(solution.sum_of_squares / degrees);
  EXPECT_NEAR(noise.force / plain, 1.0, 1e-3);
  EXPECT_NEAR(noise.variance / (plain * plain), 1.0, 2e-3);
  ASSERT_EQ(noise.force_share.size(), std::ssize(record.force));
  for (const double share : noise.force_share) EXPECT_NEAR(share, 1.0, 1e-3);
}

// ---
// Drawn readings against readings that are drawn here.

/// Root mean square of the errors of the drawn displacements over the half range: a Jenkins element
/// that never slips is a spring, whose force errs in proportion.
double ErrorOfASpring(Stages& stages) {
  std::vector<double> theta;
  const Parameters& parameters = stages.problem.parameters;
  for (std::size_t p = 0; p < parameters.size(); ++p) theta.push_back(parameters[p].theta);
  theta[kStiffness] = 0.0;
  theta[kSlipForce] = std::log(100.0);
  theta[kShape] = 0.0;
  const Eigen::MatrixXd force =
      ForceErrors(*loop::DrawReadings(stages.prepared), stages.problem, theta);
  return std::sqrt(force.squaredNorm() / static_cast<double>(force.size()));
}

template <typename Read>
double ErrorOfReadings(const Stages& stages, Read read) {
  constexpr int kDraws = 200;
  Generator generator(77);
  const PreparedRecord& record = stages.prepared.records[0];
  const std::span<const double> truth = record.displacement();
  double squares = 0.0;
  for (int k = 0; k < kDraws; ++k) {
    const std::vector<double> smoothed = loop::Smoothed(read(truth, generator), record.smoothing);
    for (std::size_t i = 0; i < truth.size(); ++i) squares += std::pow(smoothed[i] - truth[i], 2);
  }
  return std::sqrt(squares / (kDraws * static_cast<double>(truth.size()))) / stages.data.length;
}

/// 200 draws of hundreds of samples: to a few per cent, correlated as they are.
constexpr double kDrawn = 0.05;

FitOptions Jenkins(std::optional<double> noise = std::nullopt) {
  return {.model = &Model("jenkins"), .preparation = {.displacement_noise = noise}};
}

TEST(ForceErrors, OfReadingsThatRepeatAreOneError) {
  constexpr double kNoise = 0.02;
  Generator generator(5);
  const History sine = Cycling(Wave::kSine, 1.0, 3.0, 80);
  Record record;
  for (const double x : sine) {
    const double reading = x + kNoise * Normal(generator);
    for (int twice = 0; twice < 2; ++twice) {
      record.displacement.push_back(reading);
      record.force.push_back(x);
    }
  }
  Stages stages(record, Jenkins(kNoise));
  const double expected = ErrorOfReadings(stages, [&](std::span<const double> truth, auto& random) {
    std::vector<double> reading;
    double error = 0.0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      if (i % 2 == 0) error = kNoise * Normal(random);
      reading.push_back(truth[i] + error);
    }
    return reading;
  });
  EXPECT_NEAR(ErrorOfASpring(stages) / expected, 1.0, kDrawn);
}

TEST(ForceErrors, OfAnEncoderAreThoseOfItsRoundingAlone) {
  constexpr double kStep = 0.02;
  History displacement = Cycling(Wave::kSine, 1.0, 3.0, 200);
  const History truth_of = displacement;
  for (double& x : displacement) x = kStep * std::round(x / kStep + 0.3) - 0.3 * kStep;
  Stages stages(MakeRecord(displacement, truth_of), Jenkins());
  ASSERT_NEAR(stages.prepared.records[0].encoder_step, kStep, 1e-9);
  ASSERT_GT(stages.prepared.records[0].displacement_noise, 0.0);
  ASSERT_LE(stages.prepared.records[0].displacement_noise, kStep);
  const double expected = ErrorOfReadings(stages, [&](std::span<const double> truth, auto& random) {
    const double phase = Uniform(random, 0, 1);
    std::vector<double> reading;
    for (const double x : truth) {
      reading.push_back(kStep * (std::round(x / kStep + phase) - phase));
    }
    return reading;
  });
  EXPECT_NEAR(ErrorOfASpring(stages) / expected, 1.0, kDrawn);
}

}  // namespace
}  // namespace mindahl::identification::reweighting_test
