#include "mindahl/report/mapping_tests.h"

#include <cmath>
#include <limits>

#include "core/probability.h"
namespace mindahl::report {

AlphaTest TestAlpha(const identification::FitResult& fit) {
  AlphaTest test;
  const identification::ParameterEstimate& alpha = *fit.Find("alpha");
  if (alpha.status == identification::ParameterStatus::kFixed) return test;
  constexpr double kThird = contact::kMindlinShapeExponent;
  test.minus_third = alpha.value - kThird;
  if (!alpha.is_known()) return test;
  const double error = fit.ErrorTowards(alpha, kThird);
  if (error > 0 && std::isfinite(error)) {
    test.z = *test.minus_third / error;
    test.p_value = PValueOfT(*test.z, fit.ErrorDegreesOfFreedom());
  }
  test.is_rejected = alpha.lower95 > kThird || alpha.upper95 < kThird;
  const auto& likelihood = fit.mindlin_test;
  if (likelihood && (likelihood->p_value < kSignificance) == *test.is_rejected) {
    test.likelihood = likelihood;
  }
  return test;
}

StiffnessTest TestStiffness(std::string_view radius, const contact::PropagatedValue& ratio,
                            double degrees_of_freedom, double confidence) {
  StiffnessTest test;
  test.confidence = confidence;
  test.radius = radius;
  test.ratio = ratio;
  if (!(ratio.standard_error > 0) || std::isinf(ratio.standard_error)) return test;
  const double share = ratio.FitShare();
  const double degrees =
      share > 0 ? degrees_of_freedom / (share * share) : std::numeric_limits<double>::infinity();
  const double half_width = StudentQuantile(degrees, confidence) * ratio.standard_error;
  test.interval95 = {ratio.value - half_width, ratio.value + half_width};
  test.z = (ratio.value - 1) / ratio.standard_error;
  test.p_value = PValueOfT(*test.z, degrees);
  return test;
}

std::vector<StiffnessTest> TestStiffness(const identification::FitResult& fit,
                                         const contact::IdentifiedContact& contact) {
  std::vector<StiffnessTest> tests;
  const bool is_known = fit.Find("sigma")->is_known();
  const auto add = [&](std::string_view radius, const contact::PropagatedValue& ratio) {
    tests.push_back(is_known
                        ? TestStiffness(radius, ratio, fit.ErrorDegreesOfFreedom(), fit.confidence)
                        : StiffnessTest{.radius = radius, .ratio = ratio});
  };
  if (contact.hertz) add("hertz", contact.hertz->sigma_over_hertz_mindlin);
  if (contact.sigma_over_mindlin) add("given", *contact.sigma_over_mindlin);
  return tests;
}

}  // namespace mindahl::report
