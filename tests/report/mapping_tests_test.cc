#include "mindahl/report/mapping_tests.h"

#include <gtest/gtest.h>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "report/made_report.h"

// Is the fitted contact Mindlin's? Student's t with the degrees of freedom that each error has.
namespace mindahl::report::mapping_tests_test {
namespace {

using namespace contact;
using namespace identification;

using report::StiffnessTest;
using report::TestAlpha;
using report::TestStiffness;
using testing::MadeFit;
using testing::MadeRecord;

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

TEST(StiffnessTest, DoesNotTestWhatIsExactOrOpen) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double error : {0.0, infinity}) {
    const StiffnessTest test = TestStiffness("given", Ratio(0.9, error, 0.0), 4);
    EXPECT_FALSE(test.interval95 || test.z || test.p_value) << error;
    EXPECT_EQ(test.ratio.value, 0.9);
  }
}

TEST(AlphaTest, ComparesWithAThirdByStudentsT) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  fit.parameters[1].value = 1.0 / 3 + 0.025;  // the error is 0.01
  const report::AlphaTest test = TestAlpha(fit);
  EXPECT_NEAR(*test.minus_third, 0.025, kRounding);
  EXPECT_NEAR(*test.z, 2.5, 1e-12);
  const boost::math::students_t distribution(fit.residuals.degrees_of_freedom);
  EXPECT_NEAR(*test.p_value, 2 * boost::math::cdf(boost::math::complement(distribution, 2.5)),
              1e-12);
}

TEST(AlphaTest, SaysNothingOfAHeldExponentAndNoZWithoutAnError) {
  FitResult fit = MadeFit({MadeRecord(1e-6)}, 1e-6);
  fit.parameters[1].standard_error.reset();
  EXPECT_TRUE(TestAlpha(fit).minus_third);
  EXPECT_FALSE(TestAlpha(fit).z || TestAlpha(fit).p_value);
  fit.parameters[1].status = ParameterStatus::kFixed;
  EXPECT_FALSE(TestAlpha(fit).minus_third);
}

}  // namespace
}  // namespace mindahl::report::mapping_tests_test
