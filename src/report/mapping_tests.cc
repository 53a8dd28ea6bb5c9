#include "mindahl/report/mapping_tests.h"

#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

namespace mindahl::report {
namespace {

double TwoSided(const boost::math::students_t& distribution, double z) {
  return 2 * boost::math::cdf(boost::math::complement(distribution, std::abs(z)));
}

}  // namespace

AlphaTest TestAlpha(const identification::FitResult& fit) {
  AlphaTest test;
  const identification::ParameterEstimate& alpha = *fit.Find("alpha");
  if (alpha.status == identification::ParameterStatus::kFixed) return test;
  test.minus_third = alpha.value - contact::kMindlinShapeExponent;
  if (!alpha.standard_error || !(*alpha.standard_error > 0)) return test;
  test.z = *test.minus_third / *alpha.standard_error;
  test.p_value = TwoSided(boost::math::students_t(fit.residuals.degrees_of_freedom), *test.z);
  return test;
}

StiffnessTest TestStiffness(std::string_view radius, const contact::PropagatedValue& ratio,
                            double degrees_of_freedom) {
  StiffnessTest test;
  test.radius = radius;
  test.ratio = ratio;
  if (!(ratio.standard_error > 0) || std::isinf(ratio.standard_error)) return test;
  const double share = ratio.FitShare();
  const boost::math::students_t distribution(share > 0 ? degrees_of_freedom / (share * share)
                                                       : std::numeric_limits<double>::infinity());
  constexpr double kUpperEnd = 0.975;
  const double half_width = boost::math::quantile(distribution, kUpperEnd) * ratio.standard_error;
  test.interval95 = {ratio.value - half_width, ratio.value + half_width};
  test.z = (ratio.value - 1) / ratio.standard_error;
  test.p_value = TwoSided(distribution, *test.z);
  return test;
}

std::vector<StiffnessTest> TestStiffness(const identification::FitResult& fit,
                                         const contact::IdentifiedContact& contact) {
  std::vector<StiffnessTest> tests;
  const double degrees_of_freedom = fit.residuals.degrees_of_freedom;
  if (contact.hertz) {
    tests.push_back(
        TestStiffness("hertz", contact.hertz->sigma_over_hertz_mindlin, degrees_of_freedom));
  }
  if (contact.sigma_over_mindlin) {
    tests.push_back(TestStiffness("given", *contact.sigma_over_mindlin, degrees_of_freedom));
  }
  return tests;
}

}  // namespace mindahl::report
