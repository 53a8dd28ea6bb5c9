#include "recovery/recovered.h"
#include "support/prelude.h"

// Outliers must not move the parameters, and expecting them must cost little where there are none.
namespace mindahl::identification::robust_loss_test {
namespace {

constexpr BranchLaw kLaw{4e7, 1.0 / 3, 40.0};
constexpr double kNoise = 0.005 * 40.0;  // [N]
constexpr double kOutliers = 0.1;        // of the samples
constexpr std::array kParameters = {"sigma", "alpha", "slip_force"};

Record NoisyLoop(std::uint64_t seed) {
  Generator generator(seed);
  // Twice gross slip, its turns on samples: those between them are looked for without a loss only.
  const History displacement = Cycling(Wave::kSine, 3e-6, 3.0, 152);
  return WithForceNoise(testing::LoopOf(kLaw, displacement), kNoise, generator);
}

struct Spoilt {
  Record record;
  std::size_t outliers = 0;
};

/// A tenth of the samples off by 3 to 8 slip forces, to both sides or upwards only.
Spoilt WithOutliers(Record record, bool one_sided, std::uint64_t seed) {
  Generator generator(seed);
  Spoilt spoilt{std::move(record)};
  for (double& force : spoilt.record.force) {
    if (Uniform(generator, 0, 1) >= kOutliers) continue;
    const double sign = one_sided || Uniform(generator, 0, 1) < 0.5 ? 1.0 : -1.0;
    force += sign * Uniform(generator, 3, 8) * kLaw.slip_force;
    ++spoilt.outliers;
  }
  return spoilt;
}

FitResult FitWith(const Record& record, Loss loss) {
  return FitOne(record, {.initial_state = InitialState::kVirgin, .loss = loss});
}

constexpr std::array kTruth = {kLaw.tangential_stiffness, kLaw.shape_exponent, kLaw.slip_force};

std::array<double, 3> ValuesOf(const FitResult& fit) {
  return {fit.law.tangential_stiffness, fit.law.shape_exponent, fit.law.slip_force};
}

/// Largest distance of σ, α, Tc of a fit from others, in standard errors of `unit`.
double WorstDistance(const FitResult& fit, const std::array<double, 3>& from,
                     const FitResult& unit) {
  double worst = 0.0;
  for (std::size_t k = 0; k < from.size(); ++k) {
    const double error = unit.Find(kParameters[k])->standard_error.value_or(0.0);
    worst = std::max(worst, std::abs(ValuesOf(fit)[k] - from[k]) / error);
  }
  return worst;
}

double WorstShift(const FitResult& fit, const FitResult& other) {
  return WorstDistance(fit, ValuesOf(other), fit);
}

TEST(RobustLoss, OutliersToBothSidesMoveNoParameterByTwoStandardErrors) {
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const Record clean = NoisyLoop(seed);
    const Spoilt spoilt = WithOutliers(clean, /*one_sided=*/false, seed + 100);
    for (const Loss loss : {Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
      SCOPED_TRACE("loss " + std::to_string(static_cast<int>(loss)) + ", seed " +
                   std::to_string(seed));
      const FitResult fit = FitWith(spoilt.record, loss);
      EXPECT_TRUE(fit.converged) << fit.solver.message;
      EXPECT_LT(WorstShift(fit, FitWith(clean, loss)), 2.0);
      // One of 27 normal estimates is beyond 3.5 standard errors once in 80 such tests.
      EXPECT_LT(WorstDistance(fit, kTruth, fit), 3.5);
    }
    // The test can fail: least squares is moved by hundreds of the errors that a clean loop has.
    const FitResult clean_fit = FitWith(clean, Loss::kNone);
    EXPECT_GT(WorstDistance(FitWith(spoilt.record, Loss::kNone), kTruth, clean_fit), 100.0);
  }
}

TEST(RobustLoss, OutliersToOneSideMoveOnlyHubersOffset) {
  const Record clean = NoisyLoop(4);
  const Spoilt spoilt = WithOutliers(clean, /*one_sided=*/true, 104);
  for (const Loss loss : {Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
    SCOPED_TRACE("loss " + std::to_string(static_cast<int>(loss)));
    const FitResult fit = FitWith(spoilt.record, loss);
    EXPECT_TRUE(fit.converged) << fit.solver.message;
    EXPECT_LT(WorstShift(fit, FitWith(clean, loss)), 2.0);
    const ParameterEstimate& offset = *fit.Find("force_offset");
    // ψ of Huber's loss stays at 1.345 however far the outlier: ε/(1 − ε)·1.345/P(|z| < 1.345) =
    // 0.18 standard deviations of the noise, whose scale ε itself raises by a sixth. Those of
    // Cauchy and Tukey come back towards 0.
    const double bias = loss == Loss::kHuber ? 0.25 * kNoise : 0.0;
    EXPECT_LT(std::abs(offset.value), bias + 3 * *offset.standard_error);
  }
}

TEST(RobustLoss, OutliersAreCountedAndGoodSamplesMostlyNot) {
  for (const Loss loss : {Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
    const Spoilt spoilt = WithOutliers(NoisyLoop(5), /*one_sided=*/false, 105);
    const FitResult fit = FitWith(spoilt.record, loss);
    EXPECT_GE(fit.outliers, spoilt.outliers);
    // Half the weight is lost beyond 2.385 standard deviations at the least (Cauchy; 2.69 Huber,
    // 2.54 Tukey): 1.7 % of 400 normal samples, that is 7 ± 2.6.
    EXPECT_LE(fit.outliers, spoilt.outliers + 20);
    EXPECT_NEAR(fit.force_noise / kNoise, 1.0, 0.35) << "the noise of the good samples";
  }
  EXPECT_EQ(FitWith(NoisyLoop(5), Loss::kNone).outliers, 0U);
}

TEST(RobustLoss, WithoutOutliersLittleIsLost) {
  // At 95 % efficiency the estimate differs from that of least squares by √(1/0.95 − 1) = 0.23 of
  // its standard error.
  constexpr double kFourDeviations = 0.92;
  for (const std::uint64_t seed : {6U, 7U}) {
    const Record clean = NoisyLoop(seed);
    const FitResult plain = FitWith(clean, Loss::kNone);
    for (const Loss loss : {Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
      SCOPED_TRACE("loss " + std::to_string(static_cast<int>(loss)));
      const FitResult fit = FitWith(clean, loss);
      EXPECT_TRUE(fit.converged) << fit.solver.message;
      EXPECT_LT(WorstShift(fit, plain), kFourDeviations);
    }
  }
}

TEST(RobustLoss, ErrorsAreThoseOfNinetyFivePercentEfficiency) {
  // 1/√0.95, and of ten loops the median deviations scatter by 1.166/√4570 = 1.7 %: three of these.
  constexpr std::uint64_t kLoops = 10;
  constexpr double kScaleScatter = 0.052;
  for (const Loss loss : {Loss::kHuber, Loss::kCauchy, Loss::kTukey}) {
    double ratio = 0.0;
    for (std::uint64_t seed = 31; seed < 31 + kLoops; ++seed) {
      const Record clean = NoisyLoop(seed);
      const double plain = *FitWith(clean, Loss::kNone).Find("slip_force")->standard_error;
      ratio += *FitWith(clean, loss).Find("slip_force")->standard_error / plain / kLoops;
    }
    EXPECT_NEAR(ratio, 1 / std::sqrt(0.95), kScaleScatter) << static_cast<int>(loss);
  }
}

}  // namespace
}  // namespace mindahl::identification::robust_loss_test
