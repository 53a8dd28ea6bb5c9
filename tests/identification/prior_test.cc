#include "identification/sample_loop.h"
#include "identification/solve/projected_residual.h"
#include "identification/stages.h"
#include "mindahl/identification/fit.h"
#include "support/prelude.h"

// Priors on parameters, and the log-likelihood that a sampler takes.
namespace mindahl::identification::prior_test {
namespace {

constexpr double kNoise =
    0.002;  // of Tc: steps of a standard error are small, and cost is a parabola

/// A loop in slip, with time, whose noise is known: the fit's residuals decide no weight.
Record TimedLoop(double reach = 1.5, double noise = kNoise) {
  const testing::History displacement = Cycling(Wave::kSine, reach * testing::kReach, 2.0, 240);
  Generator generator(7);
  return Timed(WithForceNoise(LoopOf(kLaw, displacement), noise * kLaw.slip_force, generator),
               0.01);
}

FitOptions Options() {
  return {.initial_state = InitialState::kVirgin,
          .preparation = {.force_sense = 1, .displacement_noise = 0.0},
          .force_noise = kNoise * kLaw.slip_force};
}

TEST(Prior, OfAlphaBelowAThirdTriesNoRigAtAThird) {
  const BranchLaw law{4e7, 0.1, 40.0};
  const testing::History displacement = Cycling(Wave::kSine, 3e-6, 2.0, 240);
  Generator generator(7);
  const Record record = WithForceNoise(LoopOf(law, displacement), 0.1, generator);
  const FitResult fit = FitOne(record, {.priors = {{"alpha", {0.1, 1.0}}}});
  EXPECT_NEAR(fit.Find("alpha")->value, 0.1, 0.01);
  EXPECT_EQ(fit.FindFinding("shape_or_rig"), nullptr);
}

/// Value and variance of what a normal law and a reading of a parameter say together.
struct Combined {
  double value;
  double variance;
};

Combined Combine(double value, double error, const Prior& prior) {
  const double reading = 1 / (error * error);
  const double before = 1 / (prior.standard_uncertainty * prior.standard_uncertainty);
  return {(reading * value + before * prior.value) / (reading + before), 1 / (reading + before)};
}

/// A residual that repeats in every cycle enlarges the error of the record's estimate; the standard
/// uncertainty of the prior stays as it was given.
TEST(Prior, KeepsItsUncertaintyBesideAMisfitThatRepeats) {
  const testing::History displacement = Cycling(Wave::kSine, 1.5 * testing::kReach, 20.0, 100);
  Generator generator(7);
  Record record = WithForceNoise(LoopOf(kLaw, displacement), kNoise * kLaw.slip_force, generator);
  for (std::size_t i = 0; i < record.size(); ++i) {
    record.force[i] += 0.03 * kLaw.slip_force *
                       std::sin(2 * std::numbers::pi * displacement[i] / (0.5 * testing::kReach));
  }
  for (const double uncertainty : {1e-4, 1e-5}) {  // less than what the record says
    const FitResult fit =
        FitOne(record, {.priors = {{"alpha", {kLaw.shape_exponent, uncertainty}}}});
    EXPECT_GT(fit.records[0].structure.Widening(), 3.0);
    EXPECT_LE(*fit.Find("alpha")->standard_error, 1.1 * uncertainty);
  }
}

/// A prior two standard errors off, as sharp as the record: value and error are those of two normal
/// laws, for law, linear and nonlinear terms alike. Steps are 1 % at most of a parameter, the
/// parabola's third-order term as much of the step.
TEST(Prior, OfEveryKindOfParameterIsCombinedWithTheRecordByItsPrecision) {
  constexpr double kThirdOrder = 0.03;
  const Record record = TimedLoop();
  FitOptions options = Options();
  options.terms = {"viscous", "force_drift", "lag"};
  const FitResult without = FitOne(record, options);
  for (const char* name : {"sigma", "alpha", "slip_force", "force_offset", "viscous", "force_drift",
                           "lag", "displacement_offset"}) {
    const ParameterEstimate& alone = *without.Find(name);
    ASSERT_TRUE(alone.standard_error) << name;
    const double error = *alone.standard_error;
    const Prior prior{alone.value + 2 * error, error};
    FitOptions with = options;
    with.priors[name] = prior;
    const FitResult fit = FitOne(record, with);
    const ParameterEstimate& estimate = *fit.Find(name);
    const Combined expected = Combine(alone.value, error, prior);
    EXPECT_NEAR(estimate.value, expected.value, kThirdOrder * error) << name;
    ASSERT_TRUE(estimate.standard_error) << name;
    EXPECT_NEAR(*estimate.standard_error, std::sqrt(expected.variance), kThirdOrder * error)
        << name;
    EXPECT_NEAR((estimate.value - alone.value) / error, 1.0, kThirdOrder) << name;
    EXPECT_EQ(fit.FindFinding("prior_contradicted"), nullptr) << name;
  }
}

TEST(Prior, OfARigThatTheRecordDoesNotHaveIsContradicted) {
  FitOptions options = Options();
  options.terms = {"rig_stiffness"};
  options.priors["rig_stiffness"] = {kLaw.tangential_stiffness, 0.1 * kLaw.tangential_stiffness};
  const FitResult fit = FitOne(TimedLoop(), options);
  ASSERT_NE(fit.FindFinding("prior_contradicted"), nullptr);
  EXPECT_GT(fit.Find("rig_stiffness")->value, 1.3 * kLaw.tangential_stiffness);
}

/// A prior that shifts a parameter leaves a misfit, as a parameter does that is held at that value.
/// The distance of the prior counts both uncertainties, however small that of the prior is.
TEST(Prior, ThatTheRecordContradictsIsAMisfit) {
  constexpr double kOff = 0.027;
  const FitResult without = FitOne(TimedLoop(), Options());
  const double error = *without.Find("alpha")->standard_error;
  ASSERT_GT(kOff, 20 * error);
  for (const double uncertainty : {1e-2 * error, 1e-4 * error}) {
    FitOptions options = Options();
    options.priors = {{"alpha", {without.law.shape_exponent + kOff, uncertainty}}};
    const FitResult fit = FitOne(TimedLoop(), options);
    EXPECT_NE(fit.adequacy.verdict, AdequacyVerdict::kAdequate) << uncertainty;
    const Finding* const finding = fit.FindFinding("prior_contradicted");
    ASSERT_NE(finding, nullptr) << uncertainty;
    EXPECT_NEAR(finding->numbers.front().second, kOff / error, 0.5 * kOff / error);
  }
}

TEST(Prior, OfAValueThatIsHeldIsContradictedWhereTheModelDoesNotDescribeTheRecord) {
  const double error = *FitOne(TimedLoop(), Options()).Find("alpha")->standard_error;
  for (const double off : {1.0, 20.0}) {
    FitOptions options = Options();
    options.fixed["alpha"] = kLaw.shape_exponent + off * error;
    const FitResult fit = FitOne(TimedLoop(), options);
    const Finding* const finding = fit.FindFinding("prior_contradicted", "held");
    EXPECT_EQ(finding != nullptr, off > 10) << off;
    if (finding == nullptr) continue;
    EXPECT_NEAR(finding->numbers.front().second, off, 0.5 * off);
  }
}

/// The look from which a search starts weighs the prior of the place that it looks at.
TEST(Prior, CountsWhereASearchLooks) {
  FitOptions options = Options();
  testing::Stages stages(TimedLoop(), options);
  options.priors = {{"alpha", {kLaw.shape_exponent, 1e-3}}};
  stages.data.prior_noise = 1e-3;
  const Problem with(stages.data, options, InitialState::kVirgin);
  std::vector<double> theta;
  for (std::size_t p = 0; p < with.parameters.size(); ++p) {
    theta.push_back(with.parameters[p].theta);
  }
  theta[kShape] = 0.6;
  std::vector<double> copy = theta;
  const double without_prior = ProjectedResidual(stages.problem).EvaluateFreely(copy);
  const double cost = ProjectedResidual(with).EvaluateFreely(theta);
  EXPECT_GT(with.parameters.PriorCost(theta), 0.01);
  EXPECT_NEAR(cost - without_prior, with.parameters.PriorCost(theta), 1e-9 * cost);
}

TEST(Prior, IsRefusedOfWhatIsNotFittedAndWithoutAnUncertainty) {
  const Record record = TimedLoop();
  const auto refusal = [&](const FitOptions& with) { return RefusalOf({record}, with); };
  FitOptions options = Options();
  options.priors["viscous"] = {1.0, 0.1};
  EXPECT_THAT(refusal(options), HasSubstr("a prior of viscous has no effect"));
  options.priors = {{"sigma", {kLaw.tangential_stiffness, 0.0}}};
  EXPECT_THAT(refusal(options), HasSubstr("standard uncertainty of sigma [N/m] = 0"));
  options.priors = {{"alpha", {-0.1, 0.1}}};
  EXPECT_THAT(refusal(options), HasSubstr("alpha"));
  options.fixed["alpha"] = 0.3;
  options.priors = {{"alpha", {0.3, 0.1}}};
  EXPECT_THAT(refusal(options), HasSubstr("a prior of alpha has no effect"));
}

}  // namespace
}  // namespace mindahl::identification::prior_test
