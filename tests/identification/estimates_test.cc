// Standard errors, intervals and correlations against the formulas of a linearised fit, whose
// Jacobian is found here by central differences of the model's force.

#include "identification/inference/estimates.h"

#include <Eigen/Dense>

#include "core/probability.h"
#include "identification/sample_loop.h"
#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "support/prelude.h"

namespace mindahl::identification::estimates_test {
namespace {

/// Central differences of a step of 1e-5 leave 1e-10 of the third derivative and 1e-11 of rounding
/// over the step: 1e-6 of a column, which the condition of the fit, 1e2, may magnify.
constexpr double kDifferences = 1e-4;

FitResult IntervalsOf(const Record& record, const FitOptions& options) {
  const RecordView view = record;
  return Fitter(options).Fit(view, Depth::kIntervals);
}

/// R of a series, by the correlations of an autoregressive process of order one.
Eigen::MatrixXd CorrelationMatrix(double rho, Eigen::Index size) {
  Eigen::MatrixXd matrix(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j < size; ++j) {
      matrix(i, j) = std::pow(rho, static_cast<double>(std::abs(i - j)));
    }
  }
  return matrix;
}

struct Sandwich {
  Eigen::MatrixXd covariance;  // of θ at unit variance
  double absorbed = 0.0;
};

/// (JᵀJ)⁻¹JᵀRJ(JᵀJ)⁻¹ and the trace of (JᵀJ)⁻¹JᵀRJ.
Sandwich SandwichOf(const Eigen::MatrixXd& jacobian, double rho) {
  const Eigen::MatrixXd inverse = (jacobian.transpose() * jacobian).inverse();
  const Eigen::MatrixXd correlated =
      jacobian.transpose() * CorrelationMatrix(rho, jacobian.rows()) * jacobian;
  return {inverse * correlated * inverse, (inverse * correlated).trace()};
}

TEST(Estimates, OfWhiteNoiseAreThoseOfTheNormalEquations) {
  const Record record = NoisyLoop(5);
  const FitResult fit = IntervalsOf(record, Virgin());
  ASSERT_EQ(fit.residuals.effective_samples, static_cast<double>(record.size()))
      << "the case needs white residuals";
  Stages stages(record, Virgin());
  const std::vector<double> theta = stages.ThetaOf(fit);
  const auto& free = stages.problem.parameters.free();
  const Eigen::VectorXd residual = stages.ResidualsAt(theta);
  const auto degrees = static_cast<double>(record.size() - free.size());
  const double variance = residual.squaredNorm() / degrees;
  EXPECT_NEAR(fit.force_noise, std::sqrt(variance) * stages.data.force, 1e-9 * fit.force_noise);
  EXPECT_EQ(fit.degrees_of_freedom, degrees);
  const Eigen::MatrixXd covariance =
      variance * SandwichOf(stages.DifferencesAt(theta), 0.0).covariance;
  for (std::size_t j = 0; j < free.size(); ++j) {
    const auto place = static_cast<Eigen::Index>(j);
    const Parameter& parameter = stages.problem.parameters[free[j]];
    const ParameterEstimate& estimate = *fit.Find(stages.problem.parameters.NameOf(free[j]));
    SCOPED_TRACE(estimate.name);
    const double error = std::sqrt(covariance(place, place));
    const double unit = parameter.term->positive ? estimate.value : std::abs(parameter.scale);
    ASSERT_TRUE(estimate.standard_error && estimate.lower95 && estimate.upper95);
    EXPECT_NEAR(*estimate.standard_error / (unit * error), 1.0, kDifferences);
    // Symmetric in θ: in the logarithm of what is positive.
    const double half = StudentQuantile(degrees, 0.95) * error;
    EXPECT_NEAR((parameter.ToTheta(*estimate.upper95) - theta[free[j]]) /
                    std::copysign(half, parameter.scale),
                1.0, kDifferences);
    EXPECT_NEAR((theta[free[j]] - parameter.ToTheta(*estimate.lower95)) /
                    std::copysign(half, parameter.scale),
                1.0, kDifferences);
    for (std::size_t k = 0; k < free.size(); ++k) {
      const auto other = static_cast<Eigen::Index>(k);
      const double expected =
          covariance(place, other) / std::sqrt(covariance(place, place) * covariance(other, other));
      const auto row = static_cast<std::size_t>(&estimate - fit.parameters.data());
      const auto column = static_cast<std::size_t>(
          fit.Find(stages.problem.parameters.NameOf(free[k])) - fit.parameters.data());
      EXPECT_NEAR(fit.correlation[row * fit.parameters.size() + column], expected, kDifferences);
    }
  }
}

TEST(Estimates, AtABoundReachOneSidedFromIt) {
  FitOptions options = Virgin();
  for (const Interval& bounds : {Interval{0.45, 2.0}, Interval{0.0, 0.35}}) {
    options.bounds["alpha"] = bounds;
    Stages stages(NoisyLoop(5), options);
    const Solution solution = stages.Solve();
    const bool is_lower = bounds.lower > 0;
    ASSERT_EQ(SideOf(stages.problem.parameters[kShape], solution.theta[kShape]),
              is_lower ? BoundSide::kLower : BoundSide::kUpper);
    const Noise noise = KnownNoise(1e-4, stages.data.counted);
    const Estimates estimates = testing::EstimatesOf(stages, solution, noise);
    const Eigen::MatrixXd jacobian = stages.DifferencesAt(solution.theta);
    const Eigen::MatrixXd all = SandwichOf(jacobian, 0.0).covariance;
    ParameterEstimate alpha;
    alpha.value = solution.theta[kShape];
    estimates.Fill(kShape, alpha);
    EXPECT_FALSE(alpha.standard_error);
    ASSERT_TRUE(alpha.lower95 && alpha.upper95);
    EXPECT_NEAR(is_lower ? *alpha.lower95 : *alpha.upper95, solution.theta[kShape], 1e-12);
    const double reach = 1.959964 * std::sqrt(1e-4 * all(kShape, kShape));
    EXPECT_NEAR((*alpha.upper95 - *alpha.lower95) / reach, 1.0, kDifferences);
  }
}

TEST(Estimates, MisfitThatRepeatsIsNotAveragedAwayByMoreStrokes) {
  // 100 strokes of a loop with a force that stands in its middle: by the share q that repeats, the
  // variance of an estimate is 1 + q·(N − 1) times what the noise would leave.
  Record record = MakeRecord(Cycling(Wave::kSine, testing::kReach, 50.25, 40), {});
  record.force = Respond(Model("mindlin-dahl"), kLaw, record.displacement);
  Generator generator(3);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double x = record.displacement[i] / testing::kReach;
    record.force[i] += 1.2 * std::exp(-9 * x * x) + 0.6 * testing::Normal(generator);
  }
  const FitResult fit = IntervalsOf(record, Virgin());
  const ResidualStructure& structure = fit.records[0].structure;
  EXPECT_EQ(std::ranges::max(structure.strokes), 50U);
  ASSERT_GT(structure.repeatable_share, 0.1);
  const double repeating = 1 + structure.repeatable_share * 49;
  Stages stages(record, Virgin());
  const Autocorrelation process =
      EstimateAutocorrelation(stages.data.records, fit.records[0].residual);
  EXPECT_NEAR(fit.residuals.effective_samples * repeating * process.SquaredCorrelations() /
                  static_cast<double>(record.size()),
              1.0, 1e-6);
  // The same noise without what repeats.
  const Solution solution = stages.Solve();
  const auto parameters = stages.problem.parameters.free().size();
  Noise noise =
      KnownNoise(solution.sum_of_squares / static_cast<double>(stages.data.counted - parameters),
                 stages.data.counted);
  noise.is_known = false;
  noise.autocorrelation = process;
  const Estimates estimates = testing::EstimatesOf(stages, solution, noise);
  const double once = estimates.ErrorOfTheta(kShape);
  EXPECT_NEAR(*fit.Find("alpha")->standard_error / (std::sqrt(repeating) * once), 1.0, 1e-4);
}

TEST(Estimates, OfADirectionWithoutEffectAreNone) {
  // A straight line knows the ratio of nothing: its plateau slope is σ.
  Stages stages(NoisyLoop(5), Virgin());
  const Solution solution = stages.Solve();
  Linearization at{.jacobian = stages.DifferencesAt(solution.theta),
                   .residual = stages.ResidualsAt(solution.theta)};
  at.jacobian.col(1) = 2 * at.jacobian.col(0);
  const Noise noise = KnownNoise(1.0, stages.data.counted);
  const Estimates estimates(stages.problem, solution, noise, stages.options, std::move(at));
  EXPECT_EQ(estimates.open_directions(), 1U);
  const auto& free = stages.problem.parameters.free();
  for (std::size_t k = 0; k < 4; ++k) {
    EXPECT_EQ(std::isinf(estimates.ErrorOfTheta(free[k])), k < 2) << k;
  }
}

TEST(Intervals, AreTheUnionOfTheirParts) {
  ParameterEstimate estimate;
  estimate.name = "alpha";
  estimate.value = 0.5;
  Include(estimate, {.lower = 0.1, .upper = 0.9});
  EXPECT_FALSE(estimate.lower95 || estimate.upper95) << "what is held has none";
  SetInterval(estimate, {.lower = 0.4, .upper = 0.6});
  Include(estimate, {.lower = 0.45, .upper = 0.8});
  EXPECT_EQ(estimate.lower95, 0.4);
  EXPECT_EQ(estimate.upper95, 0.8);
  Include(estimate, {.lower = 0.5, .upper = HUGE_VAL});
  EXPECT_EQ(estimate.lower95, 0.4);
  EXPECT_FALSE(estimate.upper95) << "an end that is no number is open";
  Include(estimate, {.lower = 0.5, .upper = 0.5});
  EXPECT_FALSE(estimate.upper95) << "and stays open";
  SetInterval(estimate, {});
  EXPECT_FALSE(estimate.lower95 || estimate.upper95);
}

// ---
// The confidence of intervals is one setting: what it changes, and whether it is kept.

FitResult FitWith(double confidence, const loop::Record& record, Depth depth) {
  return Fit(std::vector{record}, {.confidence = confidence}, depth);
}

TEST(Confidence, IntervalsAreInProportionToStudentsQuantile) {
  const loop::Record record = NoisyLoop(1);
  const FitResult usual = FitWith(0.95, record, Depth::kErrors);
  const double degrees = usual.degrees_of_freedom;
  for (const double confidence : {0.68, 0.99}) {
    const FitResult fit = FitWith(confidence, record, Depth::kErrors);
    EXPECT_EQ(fit.confidence, confidence);
    const ParameterEstimate& alpha = *fit.Find("alpha");
    const ParameterEstimate& same = *usual.Find("alpha");
    EXPECT_EQ(alpha.value, same.value);
    EXPECT_EQ(alpha.standard_error, same.standard_error);
    const double ratio = StudentQuantile(degrees, confidence) / StudentQuantile(degrees, 0.95);
    EXPECT_NEAR((*alpha.upper95 - alpha.value) / (*same.upper95 - same.value), ratio, 1e-9);
  }
}

TEST(Confidence, FractionOfIntervalsThatContainTheTruthIsIt) {
  constexpr int kLoops = 300;
  const auto truth = ParametersOf(kLaw);
  for (const double confidence : {0.5, 0.68, 0.95}) {
    std::vector<int> covered(truth.size(), 0);
    for (int seed = 1; seed <= kLoops; ++seed) {
      const auto record = NoisyLoop(static_cast<std::uint64_t>(seed));
      const FitResult fit = FitWith(confidence, record, Depth::kFull);
      for (std::size_t k = 0; k < truth.size(); ++k) {
        const ParameterEstimate& estimate = *fit.Find(truth[k].first);
        ASSERT_TRUE(estimate.lower95 && estimate.upper95);
        covered[k] += Covers(estimate, truth[k].second) ? 1 : 0;
      }
    }
    // Four standard deviations of a binomial count: beyond them once in 16 000.
    const double scatter = std::sqrt(confidence * (1 - confidence) / kLoops);
    for (std::size_t k = 0; k < truth.size(); ++k) {
      EXPECT_NEAR(static_cast<double>(covered[k]) / kLoops, confidence, 4 * scatter)
          << truth[k].first << " " << confidence;
    }
  }
}

TEST(Confidence, VerdictsDoNotDependOnIt) {
  const loop::Record record = NoisyLoop(2);
  const FitResult usual = FitWith(0.95, record, Depth::kFull);
  for (const double confidence : {0.5, 0.999}) {
    const FitResult fit = FitWith(confidence, record, Depth::kFull);
    for (const ParameterEstimate& estimate : usual.parameters) {
      EXPECT_EQ(fit.Find(estimate.name)->identifiability, estimate.identifiability)
          << estimate.name << " at " << confidence;
    }
    EXPECT_EQ(fit.adequacy.verdict, usual.adequacy.verdict);
  }
}

TEST(Confidence, OneThatIsNoProbabilityIsRefused) {
  const loop::Record record = NoisyLoop(3);
  for (const double confidence : {0.0, 1.0, -0.5, 95.0, std::nan("")}) {
    EXPECT_THAT(RefusalOf({record}, {.confidence = confidence}), HasSubstr("confidence [-]"));
  }
}

}  // namespace
}  // namespace mindahl::identification::estimates_test
