

#include "identification/inference/sampled_time.h"
#include "identification/sample_loop.h"
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
