#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/fit.h"

namespace mindahl::report {

/// Tests the fitted exponent against Mindlin's 1/3, which is rejected if and only if it lies
/// outside the interval of α. No test is made where α was held or is not identifiable.
struct AlphaTest {
  std::optional<double> minus_third;  ///< α − 1/3; empty where α was held
  std::optional<bool> is_rejected;
  std::optional<double> z;  ///< over FitResult::ErrorTowards(1/3); empty where α is at a bound
  std::optional<double> p_value;  ///< two-sided, of Student's t
  /// Likelihood ratio of the model with α = 1/3; empty where α's interval includes more than this
  /// model and says otherwise.
  std::optional<identification::MindlinTest> likelihood;
};

/// Tests whether the fitted stiffness is 8a/G*.
struct StiffnessTest {
  std::string_view radius;         ///< whence a: "hertz", or "given"
  contact::PropagatedValue ratio;  ///< σ/(8a/G*): 1 where Hertz and Mindlin hold
  std::optional<identification::Interval> interval95 =
      {};                              ///< empty, as the rest, where the ratio's error is 0 or open
  double confidence = 0.95;            ///< of the interval
  std::optional<double> z = {};        ///< (ratio − 1)/SE
  std::optional<double> p_value = {};  ///< two-sided
};

/// Significance of the tests as they are put into words: the usual convention.
inline constexpr double kSignificance = 0.05;

/// @param fit  one that did not fail
AlphaTest TestAlpha(const identification::FitResult& fit);

/// Tests a ratio against 1, by Student's t with the degrees of freedom of Welch and Satterthwaite
///   ν = ν_fit/s²,  s the fit's fraction of the variance
/// (GUM G.4.1): the uncertainties of inputs are taken as known for certain.
/// @param degrees_of_freedom  ν_fit of the fit, > 0
StiffnessTest TestStiffness(std::string_view radius, const contact::PropagatedValue& ratio,
                            double degrees_of_freedom, double confidence = 0.95);

/// Returns one for each radius that is known besides the fit, where G* is known too; with the ratio
/// alone where σ is not identifiable.
std::vector<StiffnessTest> TestStiffness(const identification::FitResult& fit,
                                         const contact::IdentifiedContact& contact);

}  // namespace mindahl::report
