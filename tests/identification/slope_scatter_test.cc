

#include "identification/inference/sampled_time.h"
#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "support/prelude.h"

// Noise of the displacement that the record does not show by stepping back, and the residuals do.
namespace mindahl::identification::slope_scatter_test {
namespace {

constexpr double kForceNoise = 0.001 * 60.0;           // [N]
constexpr double kDisplacementNoise = 0.003 * kReach;  // [m]

/// Two cycles of 40 samples.
loop::Record Noisy(double force_noise, double displacement_noise, std::uint64_t seed) {
  const testing::History displacement = Cycling(Wave::kSine, kReach, 2.0, 40);
  loop::Record record = testing::MakeRecord(
      displacement, testing::Respond(testing::Model("mindlin-dahl"), kLaw, displacement));
  Generator generator(seed);
  for (double& force : record.force) force += force_noise * Normal(generator);
  for (double& place : record.displacement) place += displacement_noise * Normal(generator);
  return record;
}

TEST(SlopeScatter, DisplacementNoiseIsFoundAndTakenIntoAccount) {
  constexpr int kLoops = 20;
  int found = 0;
  int adequate = 0;
  for (int seed = 1; seed <= kLoops; ++seed) {
    const FitResult fit = FitOne(Noisy(kForceNoise, kDisplacementNoise, seed));
    adequate += fit.adequacy.verdict == AdequacyVerdict::kAdequate ? 1 : 0;
    const Finding* finding = fit.FindFinding("displacement_noise_estimated");
    if (finding == nullptr) continue;
    ++found;
    // 81 readings tell a standard deviation by the median of their differences to some 15 %.
    EXPECT_NEAR(fit.records[0].displacement_noise / kDisplacementNoise, 1.0, 0.6) << seed;
  }
  EXPECT_GE(found, 18);
  EXPECT_GE(adequate, 18) << "not told, one loop in twenty or so was called adequate";
}

TEST(SlopeScatter, IsTheLikeliestDivisionOfSecondDifferences) {
  testing::Stages stages(Noisy(kForceNoise, kDisplacementNoise, 4));
  const std::vector<double> theta = stages.Solve().theta;
  const Eigen::VectorXd residual = stages.ResidualsAt(theta);
  const auto scatter = FindSlopeScatter(
      stages.prepared, stages.problem, theta,
      {residual.data(), static_cast<std::size_t>(residual.size())}, stages.buffers.response);
  ASSERT_TRUE(scatter);
  models::OriginSensitivity sensitivity;
  stages.buffers.response.Bind(stages.problem);
  stages.buffers.response.DifferentiateByOrigins(PointAt(stages.problem, theta), 0, sensitivity);
  const double scale = std::exp(LogScaleAt(stages.problem, theta));
  const ScaledRecord& record = stages.data.records.front();
  // −2 ln L of normal differences over their number, of variances of force and displacement.
  std::size_t count = 0;
  const auto deviance = [&](double of_force, double of_displacement) {
    double sum = 0.0;
    count = 0;
    for (std::size_t i = 1; i + 1 < record.size(); ++i) {
      if (std::ranges::binary_search(record.reversals, i) ||
          std::ranges::binary_search(record.reversals, i - 1)) {
        continue;
      }
      const std::array<double, 3> weights = {1, -2, 1};
      double difference = 0.0;
      double variance = of_force;
      for (std::size_t k = 0; k < 3; ++k) {
        const double weight = weights[k] / std::sqrt(6.0);
        const double slope = scale * sensitivity.sample_slope[i + k - 1];
        difference += weight * residual[static_cast<Eigen::Index>(i + k - 1)];
        variance += weight * weight * slope * slope * of_displacement;
      }
      sum += std::log(variance) + difference * difference / variance;
      ++count;
    }
    return sum / static_cast<double>(count);
  };
  // The least on grids that close in.
  const auto least_of = [&](double log_force, double log_displacement, bool has_displacement) {
    double least = HUGE_VAL;
    for (double step = 2.0; step > 1e-6; step *= 0.7) {
      const double at_force = log_force;
      const double at_displacement = log_displacement;
      for (int i = -3; i <= 3; ++i) {
        for (int j = has_displacement ? -3 : 0; j <= (has_displacement ? 3 : 0); ++j) {
          const double x = at_force + i * step / 3;
          const double y = at_displacement + j * step / 3;
          const double value = deviance(std::exp(x), has_displacement ? std::exp(y) : 0.0);
          if (!(value < least)) continue;
          least = value;
          log_force = x;
          log_displacement = y;
        }
      }
    }
    return std::pair(least, std::exp(log_displacement));
  };
  const auto [with, variance] = least_of(-12.0, -12.0, true);
  const auto [without, none] = least_of(-12.0, 0.0, false);
  EXPECT_NEAR(scatter->deviation / (std::sqrt(variance) * stages.data.length), 1.0, 1e-3);
  // Neighbours share samples: 1 + 2(4/9 + 1/36) of them are one.
  const double ratio =
      static_cast<double>(count) / (1 + 2 * (4.0 / 9 + 1.0 / 36)) * (without - with);
  EXPECT_NEAR(scatter->p_value / (std::erfc(std::sqrt(ratio / 2)) / 2), 1.0, 1e-3);
}

TEST(SlopeScatter, NoiseIsTriedThatResidualsShowOrReadingsShowOfADoubtedModel) {
  const Thresholds thresholds;
  SlopeScatter scatter{
      .deviation = 1.2e-9, .p_value = 1e-4, .of_readings = 1e-9, .p_of_readings = 0.5};
  EXPECT_EQ(NoiseToTry(scatter, false, thresholds), 1e-9) << "the readings know it better";
  scatter.deviation = 0.3e-9;
  EXPECT_EQ(NoiseToTry(scatter, false, thresholds), 0.3e-9) << "they are not that smooth otherwise";
  scatter.deviation = 2e-9;
  EXPECT_EQ(NoiseToTry(scatter, false, thresholds), std::nullopt) << "they are smoother";
  scatter.p_value = 0.2;
  EXPECT_EQ(NoiseToTry(scatter, false, thresholds), std::nullopt);
  EXPECT_EQ(NoiseToTry(scatter, true, thresholds), 1e-9);
  scatter.p_of_readings = 1e-4;
  EXPECT_EQ(NoiseToTry(scatter, true, thresholds), std::nullopt) << "the residuals deny it";
}

TEST(SlopeScatter, NoiseOfTheForceIsNotTakenForIt) {
  for (int seed = 1; seed <= 20; ++seed) {
    const FitResult fit = FitOne(Noisy(5 * kForceNoise, 0.0, seed));
    EXPECT_EQ(fit.FindFinding("displacement_noise_estimated"), nullptr) << seed;
    EXPECT_EQ(fit.records[0].displacement_noise, 0.0) << seed;
  }
}

TEST(SlopeScatter, ReadingsThatAreSaidToBeExactAreTakenSo) {
  FitOptions options;
  options.preparation.displacement_noise = 0.0;
  const FitResult fit = FitOne(Noisy(kForceNoise, kDisplacementNoise, 1), options);
  EXPECT_EQ(fit.FindFinding("displacement_noise_estimated"), nullptr);
  EXPECT_EQ(fit.records[0].displacement_noise, 0.0);
}

}  // namespace
}  // namespace mindahl::identification::slope_scatter_test
