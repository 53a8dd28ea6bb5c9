#include "core/probability.h"
#include "identification/sample_loop.h"
#include "mindahl/identification/fit.h"
#include "support/prelude.h"

// The confidence of intervals is one setting: what it changes, and whether it is kept.
namespace mindahl::identification::confidence_test {
namespace {

FitResult FitWith(double confidence, const loop::Record& record, Depth depth) {
  FitOptions options;
  options.confidence = confidence;
  return Fit(std::vector{record}, options, depth);
}

TEST(Confidence, IntervalsAreInProportionToStudentsQuantile) {
  const loop::Record record = NoisyLoop(1);
  const FitResult usual = FitWith(0.95, record, Depth::kErrors);
  const double degrees = usual.ErrorDegreesOfFreedom();
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
  const std::vector<std::pair<const char*, double>> truth = {{"sigma", kLaw.tangential_stiffness},
                                                             {"alpha", kLaw.shape_exponent},
                                                             {"slip_force", kLaw.slip_force}};
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
    EXPECT_THROW(FitWith(confidence, record, Depth::kEstimate), InvalidArgument) << confidence;
  }
}

}  // namespace
}  // namespace mindahl::identification::confidence_test
