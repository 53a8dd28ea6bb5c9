
#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>

#include "mindahl/report/contact.h"
#include "report/made_report.h"
#include "support/prelude.h"

// Is the fitted contact Mindlin's? Student's t with the degrees of freedom that each error has.
namespace mindahl::report::mapping_tests_test {
namespace {

using namespace contact;
using namespace identification;

using report::StiffnessTest;
using report::TestAlpha;
using report::TestStiffness;

constexpr double kRounding = 1e-13;  // of quantiles, good to some hundred ulp

PropagatedValue Ratio(double value, double fit_error, double input_error) {
  PropagatedValue ratio;
  ratio.value = value;
  ratio.fit_error = fit_error;
  ratio.input_error = input_error;
  ratio.standard_error = std::hypot(fit_error, input_error);
  return ratio;
}

TEST(StiffnessTest, HasTheDegreesOfFreedomOfWelchAndSatterthwaite) {
  constexpr double kFitDegrees = 4;
  for (const auto& [fit_error, input_error] :
       {std::pair{0.03, 0.04}, std::pair{0.04, 0.03}, std::pair{0.05, 0.0}}) {
    const PropagatedValue ratio = Ratio(1.1, fit_error, input_error);
    const double error = std::hypot(fit_error, input_error);
    // u⁴/ν = Σ uᵢ⁴/νᵢ, with ν infinite for inputs.
    const double degrees = kFitDegrees * std::pow(error, 4) / std::pow(fit_error, 4);
    const boost::math::students_t distribution(degrees);
    const double half_width = boost::math::quantile(distribution, 0.975) * error;
    const StiffnessTest test = TestStiffness("hertz", ratio, kFitDegrees);
    ASSERT_TRUE(test.interval95);
    EXPECT_NEAR((test.interval95->upper - 1.1) / half_width, 1, kRounding);
    EXPECT_NEAR((1.1 - test.interval95->lower) / half_width, 1, kRounding);
    EXPECT_NEAR(*test.z, 0.1 / error, kRounding);
    const double tail = boost::math::cdf(boost::math::complement(distribution, 0.1 / error));
    EXPECT_NEAR(*test.p_value / (2 * tail), 1, kRounding);
  }
}

TEST(StiffnessTest, IsNormalWhereInputsAloneAreUncertain) {
  const StiffnessTest test = TestStiffness("given", Ratio(0.9, 0.0, 0.05), 4);
  const double quantile = boost::math::quantile(boost::math::normal(), 0.975);
  EXPECT_NEAR(test.interval95->upper, 0.9 + 0.05 * quantile, kRounding);
}

TEST(StiffnessTest, IsSkippedForExactOrOpenValues) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double error : {0.0, infinity}) {
    const StiffnessTest test = TestStiffness("given", Ratio(0.9, error, 0.0), 4);
    EXPECT_FALSE(test.interval95 || test.z || test.p_value) << error;
    EXPECT_EQ(test.ratio.value, 0.9);
  }
}

/// A fit whose α lies `above` 1/3, with the interval of the parabola of an error of 0.01 and what
/// is given beyond it.
FitResult FitWithAlpha(double above, double below_lower_end = 0.0) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  ParameterEstimate& alpha = fit.parameters[1];
  const boost::math::students_t distribution(fit.residuals.degrees_of_freedom);
  const double half = 0.01 * boost::math::quantile(distribution, 0.975);
  alpha.value = 1.0 / 3 + above;
  alpha.lower95 = alpha.value - half - below_lower_end;
  alpha.upper95 = alpha.value + half;
  return fit;
}

TEST(AlphaTest, ComparesWithAThirdByStudentsT) {
  const FitResult fit = FitWithAlpha(0.025);
  const report::AlphaTest test = TestAlpha(fit);
  EXPECT_NEAR(*test.minus_third, 0.025, kRounding);
  EXPECT_NEAR(*test.z, 2.5, 1e-12);
  const boost::math::students_t distribution(fit.residuals.degrees_of_freedom);
  EXPECT_NEAR(*test.p_value, 2 * boost::math::cdf(boost::math::complement(distribution, 2.5)),
              1e-12);
  EXPECT_EQ(test.is_rejected, true);
}

TEST(AlphaTest, NeverContradictsTheIntervalOfAlpha) {
  // Whatever widened the interval: of 2.5 standard errors 1/3 is rejected by the parabola alone.
  for (const double above : {-0.05, -0.025, -0.01, 0.01, 0.025, 0.05}) {
    for (const double widened : {0.0, 0.001, 0.01, 0.1}) {
      for (const double p_value : {1e-6, 0.5}) {
        FitResult fit = FitWithAlpha(above, widened);
        fit.mindlin_test.emplace().p_value = p_value;
        const ParameterEstimate& alpha = fit.parameters[1];
        const bool is_inside = *alpha.lower95 <= 1.0 / 3 && 1.0 / 3 <= *alpha.upper95;
        const report::AlphaTest test = TestAlpha(fit);
        SCOPED_TRACE(std::to_string(above) + ", widened by " + std::to_string(widened));
        EXPECT_EQ(test.is_rejected, !is_inside);
        EXPECT_EQ(*test.p_value < kSignificance, !is_inside);
        EXPECT_EQ(test.likelihood.has_value(), (p_value < kSignificance) == !is_inside);
      }
    }
  }
}

TEST(AlphaTest, IsNotMadeOfAnExponentThatIsNotIdentifiable) {
  FitResult fit = FitWithAlpha(0.2);
  fit.mindlin_test = {.likelihood_ratio = 100.0, .p_value = 1e-9, .rig_stiffness = 1e7};
  fit.parameters[1].identifiability = identification::Identifiability::kNotIdentifiable;
  const report::AlphaTest test = TestAlpha(fit);
  EXPECT_FALSE(test.z || test.p_value || test.is_rejected || test.likelihood);
}

TEST(AlphaTest, SkipsFixedExponentAndHasNoZWithoutStandardError) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  fit.parameters[1].standard_error.reset();
  EXPECT_TRUE(TestAlpha(fit).minus_third);
  EXPECT_FALSE(TestAlpha(fit).z || TestAlpha(fit).p_value);
  fit.parameters[1].status = ParameterStatus::kFixed;
  EXPECT_FALSE(TestAlpha(fit).minus_third);
}

TEST(StiffnessTest, IsNotMadeOfAStiffnessThatIsNotIdentifiable) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  contact::IdentifiedContact contact;
  contact.sigma_over_mindlin = Ratio(2.0, 0.01, 0.0);
  ASSERT_TRUE(TestStiffness(fit, contact).front().p_value);
  fit.parameters[0].identifiability = identification::Identifiability::kNotIdentifiable;
  const StiffnessTest test = TestStiffness(fit, contact).front();
  EXPECT_FALSE(test.interval95 || test.z || test.p_value);
  EXPECT_EQ(test.ratio.value, 2.0);
}

TEST(StiffnessTest, TakesTheIntervalOfTheStiffnessAndNotItsStandardErrorAlone) {
  // σ is stated to 1 %, and its interval reaches 30 % down: a ratio of 1.2 is none that is
  // rejected.
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  ParameterEstimate& sigma = fit.parameters[0];
  sigma.lower95 = 0.7 * sigma.value;
  contact::KnownContact known;
  known.contact_radius = 1e-4;
  known.tangential_compliance = 8e-4 / (sigma.value / 1.2);
  const StiffnessTest test = TestStiffness(fit, IdentifyFittedContact(fit, known)).front();
  EXPECT_NEAR(test.ratio.value, 1.2, 1e-12);
  EXPECT_LT(test.interval95->lower, 1.0);
  EXPECT_GT(*test.p_value, kSignificance);
}

}  // namespace
}  // namespace mindahl::report::mapping_tests_test
