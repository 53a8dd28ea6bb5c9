// Records of one contact whose noise differs, and records that another past precedes.

#include <boost/math/distributions/chi_squared.hpp>

#include "identification/inference/noise.h"
#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/disturbances.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

namespace mindahl::identification::record_noise_test {
namespace {

constexpr double kQuiet = 0.2;  // [N]
constexpr double kLoud = 2.0;

std::vector<loop::Record> Noisy(double one, double other, std::uint64_t seed = 7) {
  Generator generator(seed);
  return {WithForceNoise(Loop(), one, generator), WithForceNoise(Loop(), other, generator)};
}

TEST(ChanceOfOneNoise, IsOneOfOneRecordAndOfRoundingErrors) {
  Stages one(Loop(), Virgin());
  const std::vector<double> residual(one.problem.size(), 0.01);
  EXPECT_EQ(ChanceOfOneNoise(one.problem, residual), 1.0);
  Stages two(std::vector<loop::Record>{Loop(), Loop()}, Virgin());
  std::vector<double> rounding(two.problem.size(), 1e-16);
  std::fill(rounding.begin(), rounding.begin() + 241, 1e-14);
  EXPECT_EQ(ChanceOfOneNoise(two.problem, rounding), 1.0);
}

TEST(JointFit, GivesEachRecordItsOwnNoise) {
  const FitResult fit = Fit(Noisy(kQuiet, kLoud), Virgin());
  ASSERT_TRUE(fit.converged);
  // A standard deviation of 241 samples is known to 1/√(2·241) = 4.6 %; four of these.
  constexpr double kError = 4 * 0.046;
  EXPECT_NEAR(fit.records[0].response_noise / kQuiet, 1.0, kError);
  EXPECT_NEAR(fit.records[1].response_noise / kLoud, 1.0, kError);
  // Of all samples the mean variance.
  const double mean = std::sqrt((kQuiet * kQuiet + kLoud * kLoud) / 2);
  EXPECT_NEAR(fit.force_noise / mean, 1.0, kError);
  EXPECT_NEAR(fit.rms / mean, 1.0, kError) << "the rms is of the residuals as they are";
}

TEST(JointFit, NoisyRecordTakesNothingFromAQuietOne) {
  const std::vector<loop::Record> records = Noisy(kQuiet, kLoud);
  const FitResult joint = Fit(records, Virgin());
  const FitResult alone = Fit({records.data(), 1}, Virgin());
  for (const char* name : {"sigma", "alpha", "slip_force"}) {
    const double of_both = *joint.Find(name)->standard_error;
    const double of_one = *alone.Find(name)->standard_error;
    // The other one, of a hundredth of the information, adds 0.5 %; both know their noise to 5 %.
    constexpr double kNoiseIsKnown = 0.15;
    EXPECT_NEAR(of_both / of_one, 1.0, kNoiseIsKnown) << name;
  }
}

TEST(JointFit, RecordsOfOneNoiseArePooled) {
  const FitResult fit = Fit(Noisy(kLoud, kLoud), Virgin());
  EXPECT_EQ(fit.records[0].response_noise, fit.force_noise);
  EXPECT_EQ(fit.records[1].response_noise, fit.force_noise);
}

TEST(JointFit, KnownNoiseIsThatOfAllRecords) {
  const FitResult fit =
      Fit(Noisy(kQuiet, kLoud), {.initial_states = {InitialState::kVirgin}, .force_noise = kLoud});
  EXPECT_DOUBLE_EQ(fit.records[0].response_noise, kLoud);
}

TEST(JointFit, FindsThatTheFirstRecordIsVirginAndTheOthersAreSteady) {
  Generator generator(11);
  std::vector<loop::Record> records = {Loop(), From(Loop(3.0), 120), From(Loop(3.0), 120)};
  for (loop::Record& record : records) record = WithForceNoise(record, kQuiet, generator);
  const FitResult fit = Fit(records, {});
  ASSERT_TRUE(fit.converged);
  EXPECT_TRUE(fit.has_mixed_states());
  EXPECT_EQ(fit.records[0].initial_state, InitialState::kVirgin);
  EXPECT_EQ(fit.records[1].initial_state, InitialState::kSteady);
  EXPECT_EQ(fit.records[2].initial_state, InitialState::kSteady);
  EXPECT_EQ(fit.adequacy.verdict, AdequacyVerdict::kAdequate);
  for (const auto& [name, truth] : ParametersOf(kLaw)) {
    const ParameterEstimate& estimate = *fit.Find(name);
    EXPECT_NEAR(estimate.value, truth, 4 * *estimate.standard_error) << name;
  }
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
      {.initial_states = {InitialState::kVirgin}, .preparation = {.displacement_noise = kNoise}}));
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
