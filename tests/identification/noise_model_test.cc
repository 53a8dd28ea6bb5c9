#include <Eigen/Dense>
#include <deque>

#include "identification/inference/noise.h"
#include "identification/problem/scaled_records.h"
#include "identification/stages.h"
#include "recovery/recovered.h"
#include "support/prelude.h"

// The noise of a loop as an autoregressive process, and the standard errors that follow from it.
namespace mindahl::identification::noise_model_test {
namespace {

constexpr std::size_t kSamples = 5000;

/// Of records whose samples all count.
Autocorrelation EstimateNoise(const std::vector<std::vector<double>>& records,
                              const std::vector<std::vector<unsigned char>>& counts = {}) {
  std::vector<ScaledRecord> scaled(records.size());
  std::vector<double> residual;
  for (std::size_t r = 0; r < records.size(); ++r) {
    scaled[r].first = residual.size();
    scaled[r].force = records[r];
    residual.insert(residual.end(), records[r].begin(), records[r].end());
    scaled[r].counts.assign(records[r].size(), 1);
    if (!counts.empty()) scaled[r].counts = counts[r];
  }
  return EstimateAutocorrelation(scaled, residual);
}

/// A series of the process, stationary from its first sample on.
std::vector<double> Autoregressive(const std::vector<double>& coefficients, std::size_t samples,
                                   Generator& generator) {
  constexpr std::size_t kForgetting = 1000;  // 0.9^1000 = 1e-46
  std::deque<double> recent(coefficients.size(), 0.0);
  std::vector<double> series;
  for (std::size_t i = 0; i < kForgetting + samples; ++i) {
    double value = Normal(generator);
    for (std::size_t k = 0; k < coefficients.size(); ++k) value += coefficients[k] * recent[k];
    recent.push_front(value);
    recent.pop_back();
    if (i >= kForgetting) series.push_back(value);
  }
  return series;
}

/// ρ_0 … ρ_{count−1} of φ₁, φ₂: ρ₁ = φ₁/(1 − φ₂), then the recursion.
std::vector<double> SecondOrderCorrelations(double first, double second, std::size_t count) {
  std::vector<double> rho = {1.0, first / (1 - second)};
  while (rho.size() < count) {
    rho.push_back(first * rho[rho.size() - 1] + second * rho[rho.size() - 2]);
  }
  return rho;
}

/// Variance of the innovations over that of the process: 1 − φ₁ρ₁ − φ₂ρ₂.
double SecondOrderShare(double first, double second) {
  const std::vector<double> rho = SecondOrderCorrelations(first, second, 3);
  return 1 - first * rho[1] - second * rho[2];
}

/// Normal estimates are off by this many standard deviations once in 1.7 million.
constexpr double kSurely = 5.0;

TEST(NoiseModel, ProcessIsRecoveredWithinItsSamplingError) {
  // Brockwell and Davis, Time Series (1991) §8.1: Var φ̂ = (1 − φ_p²)/n of either coefficient. The
  // share of the innovations of the first order is 1 − ρ̂², twice ρ times as uncertain.
  for (const std::vector<double>& process : {std::vector{0.9}, {1.2, -0.5}}) {
    const double error = std::sqrt((1 - process.back() * process.back()) / kSamples);
    const bool is_first = process.size() == 1;
    const double share = is_first ? 1 - 0.9 * 0.9 : SecondOrderShare(process[0], process[1]);
    const double share_error = is_first ? kSurely * 2 * 0.9 * error : 0.03;
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      Generator generator(seed);
      const Autocorrelation noise = EstimateNoise({Autoregressive(process, kSamples, generator)});
      ASSERT_EQ(noise.coefficients.size(), process.size()) << seed;
      for (std::size_t k = 0; k < process.size(); ++k) {
        EXPECT_NEAR(noise.coefficients[k], process[k], kSurely * error) << seed;
      }
      EXPECT_NEAR(noise.innovation_share, share, share_error) << seed;
    }
  }
}

TEST(NoiseModel, WhiteNoiseHasOrderZero) {
  // Schwarz's criterion takes one more order where χ²₁ exceeds ln n = 5.7: 1.7 % of the time, and
  // higher ones seldom. Of 200, more than 20 come with a probability below 1e-6.
  constexpr int kSeeds = 200;
  int white = 0;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Generator generator(static_cast<std::uint64_t>(seed));
    const std::vector<std::vector<double>> series = {Autoregressive({}, 300, generator)};
    const Autocorrelation noise = EstimateNoise(series);
    if (!noise.coefficients.empty()) continue;
    ++white;
    EXPECT_EQ(noise.innovation_share, 1.0);
    EXPECT_EQ(noise.SquaredCorrelations(), 1.0);
  }
  EXPECT_GE(white, kSeeds * 9 / 10);
}

TEST(NoiseModel, SquaredCorrelationsAreThoseOfTheProcess) {
  constexpr double kForgotten = 1e-7;  // what the sum over lags leaves off, relative
  for (const double rho : {-0.6, 0.3, 0.9, 0.99}) {
    const Autocorrelation noise = testing::FirstOrder(rho);
    const double exact = (1 + rho * rho) / (1 - rho * rho);
    EXPECT_NEAR(noise.SquaredCorrelations(), exact, kForgotten * exact) << rho;
  }
  double exact = 1.0;
  const std::vector<double> rho = SecondOrderCorrelations(1.2, -0.5, 400);
  for (std::size_t k = 1; k < rho.size(); ++k) exact += 2 * rho[k] * rho[k];
  const Autocorrelation noise{.coefficients = {1.2, -0.5},
                              .correlations = {rho[0], rho[1], rho[2]},
                              .innovation_share = SecondOrderShare(1.2, -0.5)};
  EXPECT_NEAR(noise.SquaredCorrelations(), exact, kForgotten * exact);
}

/// Root mean square of Tc's stated standard errors, and of its errors, over many loops.
struct Tally {
  double stated = 0.0;
  double scatter = 0.0;
};

Tally TallyOf(const std::vector<double>& coefficients, int loops) {
  constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
  constexpr double kNoise = 0.01;                                     // of Tc
  const History displacement = Cycling(Wave::kSine, 3e-6, 2.0, 400);  // twice gross slip
  const Record clean = testing::LoopOf(kLaw, displacement);
  const double first = coefficients.empty() ? 0.0 : coefficients[0];
  const double unit = std::sqrt(1 - first * first);  // of the process
  const FitOptions options{.initial_state = InitialState::kVirgin};
  Generator generator(20250301);
  Tally tally;
  for (int loop = 0; loop < loops; ++loop) {
    Record record = clean;
    const std::vector<double> noise = Autoregressive(coefficients, record.size(), generator);
    for (std::size_t i = 0; i < record.size(); ++i) {
      record.force[i] += kNoise * kLaw.slip_force * unit * noise[i];
    }
    const FitResult fit = FitOne(record, options);
    const ParameterEstimate& slip_force = *fit.Find("slip_force");
    EXPECT_TRUE(fit.converged && slip_force.standard_error) << loop;
    if (!slip_force.standard_error) continue;
    tally.stated += *slip_force.standard_error * *slip_force.standard_error / loops;
    const double error = slip_force.value - kLaw.slip_force;
    tally.scatter += error * error / loops;
  }
  return {std::sqrt(tally.stated), std::sqrt(tally.scatter)};
}

TEST(NoiseModel, StandardErrorsAreTheScatterOfLoopsWithCorrelatedNoise) {
  constexpr int kLoops = 100;
  // A scatter over 100 loops is itself known to 1/√200 = 7 %.
  constexpr double kCorrelated = 0.20;
  constexpr double kWhite = 0.15;
  const Tally correlated = TallyOf({0.9}, kLoops);
  const Tally white = TallyOf({}, kLoops);
  EXPECT_NEAR(correlated.stated / correlated.scatter, 1.0, kCorrelated);
  EXPECT_NEAR(white.stated / white.scatter, 1.0, kWhite);
  // Noise of the same size taken as white would be off by more than this.
  EXPECT_GT(correlated.scatter / white.stated, 1.5);
}

// ---
// The one comparison of fits, by hand.

constexpr double kRounding = 1e-13;  // of numbers up to a hundred

TEST(Evidence, LikelihoodRatioIsThatOfTheEffectiveSamples) {
  // n_eff·ln(SS₀/SS₁), whatever the samples' number.
  EXPECT_NEAR((Evidence{100, 40.0}.LikelihoodRatio(3.0, 2.0)), 40 * std::log(1.5), kRounding);
  EXPECT_NEAR((Evidence{50, 40.0}.LikelihoodRatio(3.0, 2.0)), 40 * std::log(1.5), kRounding);
  EXPECT_LT((Evidence{100, 40.0}.LikelihoodRatio(2.0, 3.0)), 0.0) << "the larger sum loses";
}

TEST(Evidence, RoundingErrorsSayNothing) {
  const Evidence evidence{100, 40.0};
  const double floor = 100 * kRoundingRms * kRoundingRms;
  EXPECT_EQ(evidence.LikelihoodRatio(floor / 2, 0.0), 0.0);
  EXPECT_NEAR(evidence.LikelihoodRatio(4 * floor, floor / 8), 40 * std::log(4.0), 1e-10);
  EXPECT_EQ(evidence.Aicc(floor / 2, 3), evidence.Aicc(0.0, 3));
  EXPECT_LT(evidence.Aicc(floor, 3), evidence.Aicc(2 * floor, 3));
}

TEST(Evidence, AiccHasTheSmallSampleTermOfAllSamplesAndTheVarianceForAParameter) {
  // k = 3 + 1: 8·ln(5/20) + 2·4 + 2·4·5/(20 − 4 − 1)
  EXPECT_NEAR((Evidence{20, 8.0}.Aicc(5.0, 3)), 8 * std::log(0.25) + 8 + 40.0 / 15, kRounding);
  // Nothing is divided by less than one.
  EXPECT_NEAR((Evidence{5, 5.0}.Aicc(5.0, 4)), 10 + 60, kRounding);
}

TEST(Noise, DegreesOfFreedomAreEffectiveSamplesLessParameters) {
  Noise noise = testing::KnownNoise(1.0, 1000);
  EXPECT_GE(noise.degrees_of_freedom(5), 1e5) << "known is known";
  noise.is_known = false;
  EXPECT_EQ(noise.degrees_of_freedom(5), 995.0);
  noise.autocorrelation = testing::FirstOrder(0.95);
  const double share = (1 + 0.95 * 0.95) / (1 - 0.95 * 0.95);
  EXPECT_NEAR(noise.effective_samples(), 1000 / share, 1e-6 * 1000 / share);
  EXPECT_NEAR(noise.degrees_of_freedom(5), 1000 / share - 5, 1e-4);
  noise.repeating = 4.0;
  EXPECT_NEAR(noise.degrees_of_freedom(5), 1000 / share / 4 - 5, 1e-4);
  noise.repeating = 1000.0;
  EXPECT_EQ(noise.effective_samples(), 1.0);
  EXPECT_EQ(noise.degrees_of_freedom(5), 1.0);
}

}  // namespace
}  // namespace mindahl::identification::noise_model_test
