// Records of one contact whose noise differs, and noise of the displacement.

#include <map>

#include "identification/inference/noise.h"
#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/disturbances.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

namespace mindahl::identification::record_noise_test {
namespace {

TEST(VariancesOfRecords, AreTheirMeanSquaresOverThatOfAll) {
  Stages two(std::vector<loop::Record>{Loop(), Loop()}, Virgin());
  std::vector<double> residual(two.problem.size(), 3.0);
  std::fill(residual.begin(), residual.begin() + std::ssize(residual) / 2, 1.0);
  const std::vector<double> variances = VariancesOfRecords(two.data, residual);  // 1 and 9 over 5
  EXPECT_DOUBLE_EQ(variances[0], 0.2);
  EXPECT_DOUBLE_EQ(variances[1], 1.8);
}

TEST(Noise, CountsEachRecordByItsVarianceInProducts) {
  Stages two(std::vector<loop::Record>{Loop(), Loop()}, Virgin());
  const auto rows = static_cast<Eigen::Index>(two.problem.size());
  Eigen::MatrixXd column = Eigen::MatrixXd::Constant(rows, 1, 2.0);
  column.topRows(rows / 2).setOnes();
  Noise noise;
  noise.of_records = {0.2, 1.8};
  const double product = noise.Product(two.data.records, {}, column)(0, 0);
  EXPECT_DOUBLE_EQ(product, static_cast<double>(rows) / 2 * (0.2 * 1 + 1.8 * 4));
}

TEST(JointFit, IntervalsCoverTheTruthWhereRecordsDifferInNoise) {
  // The loud record is the longer one: a pooled variance would count its information as quieter.
  constexpr int kFits = 60;
  constexpr double kQuiet = 0.2;  // [N]
  constexpr double kLoud = 2.0;
  std::map<std::string, int> covered;
  for (int k = 0; k < kFits; ++k) {
    Generator generator(100 + k);
    const FitResult fit =
        Fit(std::vector<loop::Record>{WithForceNoise(Loop(), kQuiet, generator),
                                      WithForceNoise(Loop(6.0), kLoud, generator)},
            Virgin(), Depth::kErrors);
    ASSERT_TRUE(fit.converged);
    for (const auto& [name, truth] : ParametersOf(kLaw)) {
      covered[name] += Covers(*fit.Find(name), truth) ? 1 : 0;
    }
  }
  // 95 % of 60 less three standard deviations √(60·0.95·0.05).
  for (const auto& [name, times] : covered) EXPECT_GE(times, 57 - 3 * 1.69) << name;
}

// ---
// These tests concern the effect of displacement noise on a fit, and what the fit reports of it.

constexpr double kForceNoise = 0.005 * 60.0;  // [N]
constexpr std::size_t kReversals = 6;

Record Clean() { return testing::LoopOf(kLaw, Cycling(Wave::kSine, kReach, 3.0, 200)); }

/// @param noise  [m]
Record WithNoise(Record record, double noise, Generator& generator,
                 double force_noise = kForceNoise) {
  record = WithForceNoise(record, force_noise, generator);
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
  const auto truth = testing::ParametersOf(kLaw);
  const Record clean = Clean();
  std::array<double, 3> sum{};
  std::array<double, 3> squares{};
  Honesty honesty;
  for (std::size_t i = 0; i < kLoops; ++i) {
    Generator generator(100 + i);
    const FitResult fit = FitOne(make_noisy(clean, generator), options);
    EXPECT_TRUE(fit.converged) << fit.solver.message;
    EXPECT_EQ(fit.records[0].reversals.size(), kReversals);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const ParameterEstimate& estimate = *fit.Find(truth[k].first);
      honesty.covered[k] += Covers(estimate, truth[k].second) ? 1.0 / kLoops : 0.0;
      const double error = estimate.value - truth[k].second;
      sum[k] += error / kLoops;
      squares[k] += error * error / kLoops;
    }
  }
  for (std::size_t k = 0; k < truth.size(); ++k) {
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
  ExpectHonest(Measure(
      [](const Record& clean, Generator& generator) { return WithNoise(clean, kNoise, generator); },
      {.initial_state = InitialState::kVirgin, .preparation = {.displacement_noise = kNoise}}));
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

/// Cycles that the samples are in step with, whose amplitude is a number of counts or a little
/// more.
Record CountedInStep(double amplitude, double counts, std::uint64_t seed) {
  Generator generator(seed);
  Record record = testing::LoopOf(kLaw, Cycling(Wave::kSine, amplitude, 4.0, 200));
  record.displacement = testing::Quantised(record.displacement, amplitude / counts);
  return WithNoise(record, 0.0, generator, 0.002 * kLaw.slip_force);
}

TEST(DisplacementNoise, OfAnEncoderIsTheSameInEveryCycleAndInTheIntervals) {
  constexpr std::uint64_t kManyLoops = 12;
  std::size_t missed = 0;
  for (std::uint64_t seed = 1; seed <= kManyLoops; ++seed) {
    const double amplitude = (0.5 + 0.15 * static_cast<double>(seed)) * kReach;
    const FitResult fit = FitOne(CountedInStep(amplitude, 40.0, seed));
    missed += Covers(*fit.Find("sigma"), kLaw.tangential_stiffness) ? 0 : 1;
    missed += Covers(*fit.Find("alpha"), kLaw.shape_exponent) ? 0 : 1;
  }
  // More than four of 24 intervals of 95 % miss the truth with a probability of 1 in 180.
  EXPECT_LE(missed, 4U);
}

TEST(DisplacementNoise, OfAFineEncoderIsNoMisfit) {
  for (const double counts : {800.3, 1500.7, 4000.2}) {
    const FitResult fit = FitOne(CountedInStep(1.5 * kReach, counts, 3));
    EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kAdequate) << counts;
  }
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
    const FitResult fit =
        FitOne(WithNoise(clean, 0.03 * 0.6 * kReach, generator, 0.001 * kLaw.slip_force));
    const ParameterEstimate& sigma = *fit.Find("sigma");
    ASSERT_TRUE(sigma.lower95 && sigma.upper95) << i;
    EXPECT_GT(*sigma.upper95 / *sigma.lower95, 1.005) << i;
    covered += Covers(sigma, kLaw.tangential_stiffness) ? 1 : 0;
  }
  // More than three of twelve 95 % intervals miss the truth with a probability of 1 in 450.
  EXPECT_GE(covered, kManyLoops - 3);
}

}  // namespace
}  // namespace mindahl::identification::record_noise_test
