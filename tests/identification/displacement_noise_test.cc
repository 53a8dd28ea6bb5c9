#include "identification/sample_loop.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/disturbances.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// What noise of the displacement does to a fit, and what the fit says of it.
namespace mindahl::identification::displacement_noise_test {
namespace {

using namespace loop;
using namespace models;

constexpr double kForceNoise = 0.005 * 60.0;  // [N]
constexpr std::size_t kReversals = 6;

Record Clean() {
  const testing::History displacement = Cycling(Wave::kSine, kReach, 3.0, 200);
  return testing::LoopOf(kLaw, displacement);
}

/// @param noise  [m]
Record WithNoise(Record record, double noise, Generator& generator) {
  for (double& force : record.force) force += kForceNoise * Normal(generator);
  for (double& displacement : record.displacement) displacement += noise * Normal(generator);
  return record;
}

/// @param step  [m]
Record Counted(Record record, double step, Generator& generator) {
  record = WithNoise(record, 0.0, generator);
  const double phase = Uniform(generator, 0, 1);
  for (double& displacement : record.displacement) {
    displacement = step * (std::round(displacement / step + phase) - phase);
  }
  return record;
}

/// Over seeded loops: the share of 95 % intervals that cover the truth and the mean error over its
/// scatter, of σ, α and Tc.
struct Honesty {
  std::array<double, 3> covered{};
  std::array<double, 3> bias{};
};

constexpr std::size_t kLoops = 40;
// 95 % of 40 loops less three standard deviations √(0.95·0.05/40).
constexpr double kLeastCovered = 0.95 - 3 * 0.0345;
// A bias of half the scatter, and three standard deviations 1/√40 of its mean.
constexpr double kMostBias = 0.5 + 3 * 0.158;

template <typename MakeNoisy>
Honesty Measure(MakeNoisy make_noisy, const FitOptions& options) {
  const std::array<std::string, 3> names = {"sigma", "alpha", "slip_force"};
  const std::array<double, 3> truth = {kLaw.tangential_stiffness, kLaw.shape_exponent,
                                       kLaw.slip_force};
  const Record clean = Clean();
  std::array<double, 3> sum{};
  std::array<double, 3> squares{};
  Honesty honesty;
  for (std::size_t i = 0; i < kLoops; ++i) {
    Generator generator(100 + i);
    const FitResult fit = FitOne(make_noisy(clean, generator), options);
    EXPECT_TRUE(fit.converged) << fit.solver.message;
    EXPECT_EQ(fit.records[0].reversals.size(), kReversals);
    for (std::size_t k = 0; k < names.size(); ++k) {
      const ParameterEstimate& estimate = *fit.Find(names[k]);
      honesty.covered[k] += Covers(estimate, truth[k]) ? 1.0 / kLoops : 0.0;
      const double error = estimate.value - truth[k];
      sum[k] += error / kLoops;
      squares[k] += error * error / kLoops;
    }
  }
  for (std::size_t k = 0; k < names.size(); ++k) {
    honesty.bias[k] = sum[k] / std::sqrt(squares[k] - sum[k] * sum[k]);
  }
  return honesty;
}

void ExpectHonest(const Honesty& honesty) {
  for (std::size_t k = 0; k < honesty.covered.size(); ++k) {
    EXPECT_GE(honesty.covered[k], kLeastCovered) << "parameter " << k;
    EXPECT_LE(std::abs(honesty.bias[k]), kMostBias) << "parameter " << k;
  }
}

TEST(DisplacementNoise, IntervalsCoverTheTruthWhereItIsKnown) {
  constexpr double kNoise = 0.02 * kReach;
  FitOptions options = Virgin();
  options.preparation.displacement_noise = kNoise;
  ExpectHonest(Measure(
      [](const Record& clean, Generator& generator) { return WithNoise(clean, kNoise, generator); },
      options));
}

TEST(DisplacementNoise, IntervalsCoverTheTruthWhereItIsFound) {
  ExpectHonest(
      Measure([](const Record& clean,
                 Generator& generator) { return WithNoise(clean, 0.02 * kReach, generator); },
              Virgin()));
}

TEST(DisplacementNoise, IntervalsCoverTheTruthWhereAnEncoderMakesIt) {
  ExpectHonest(
      Measure([](const Record& clean,
                 Generator& generator) { return Counted(clean, 0.01 * kReach, generator); },
              Virgin()));
}

TEST(DisplacementNoise, IsNoneInACleanRecord) {
  const FitResult fit = FitOne(Clean(), Virgin());
  EXPECT_EQ(fit.records[0].displacement_noise, 0.0);
  EXPECT_TRUE(testing::Recovers(fit, kLaw, testing::kNoiseFree));
}

TEST(DisplacementNoise, ThatIsAllNoiseLeavesIntervalsAWidth) {
  // The maximum-likelihood estimate of the force noise is zero here; weights must not be scaled by
  // it.
  constexpr std::size_t kManyLoops = 12;
  const Record clean = testing::LoopOf(kLaw, Cycling(Wave::kSine, 0.6 * kReach, 3.5, 100));
  std::size_t covered = 0;
  for (std::size_t i = 0; i < kManyLoops; ++i) {
    Generator generator(500 + i);
    Record record = clean;
    for (double& force : record.force) force += 0.001 * kLaw.slip_force * Normal(generator);
    for (double& x : record.displacement) x += 0.03 * 0.6 * kReach * Normal(generator);
    const FitResult fit = FitOne(record);
    const ParameterEstimate& sigma = *fit.Find("sigma");
    ASSERT_TRUE(sigma.lower95 && sigma.upper95) << i;
    EXPECT_GT(*sigma.upper95 / *sigma.lower95, 1.005) << i;
    covered += Covers(sigma, kLaw.tangential_stiffness) ? 1 : 0;
  }
  // More than three of twelve 95 % intervals miss the truth with a probability of 1 in 450.
  EXPECT_GE(covered, kManyLoops - 3);
}

}  // namespace
}  // namespace mindahl::identification::displacement_noise_test
