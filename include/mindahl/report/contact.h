#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/record.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::report {

/// Returns the correlation of the errors of two parameters of a fit; 0 where the fit does not say.
double Correlation(const identification::FitResult& fit, std::string_view first,
                   std::string_view second);

/// Identifies the contact of a fit, with its errors and their correlation, and by the rules that
/// keep it from stating what the record does not determine:
///  - errors are those of the parameters' intervals, FitResult::ErrorOf(): a parameter that was
///    held is exact, one that the record leaves open has an infinite error;
///  - no μ from a slip force that is not identifiable: `unidentified` then has the lower limit;
///  - no ρ and no p₀ from a load series that denies Hertz's law.
/// @param fit  one that did not fail
/// @throws InvalidArgument as IdentifyContact()
contact::IdentifiedContact IdentifyFittedContact(const identification::FitResult& fit,
                                                 const contact::KnownContact& known);

/// Identifies the contact by a law that was not fitted, with the same relative errors of σ and Tc.
/// @throws InvalidArgument as IdentifyContact()
contact::IdentifiedContact IdentifyContactOf(const identification::FitResult& fit,
                                             const models::BranchLaw& law,
                                             const contact::KnownContact& known);

/// Returns why μ is withheld though the normal load is known: the slip force is not identifiable.
/// Empty where it is not withheld.
std::optional<std::string> WhyFrictionIsWithheld(const identification::FitResult& fit,
                                                 const contact::KnownContact& known);

/// Returns the mean measured normal load [N], which a steady test keeps to: of the samples in the
/// window where there is one. Empty where a record has no load or no sample counts.
std::optional<double> MeanNormalLoad(std::span<const loop::Record> records,
                                     const std::optional<identification::Interval>& window = {});

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
  std::string_view radius;         ///< source of a: "hertz" or "given"
  contact::PropagatedValue ratio;  ///< σ/(8a/G*): 1 where Hertz and Mindlin hold
  std::optional<identification::Interval> interval95 =
      {};                              ///< empty, as the rest, where the ratio's error is 0 or open
  double confidence = 0.95;            ///< confidence of the interval
  std::optional<double> z = {};        ///< (ratio − 1)/SE
  std::optional<double> p_value = {};  ///< two-sided
};

/// Significance at which tests are called rejected in words: the usual convention.
inline constexpr double kSignificance = 0.05;

/// @param fit  one that did not fail
AlphaTest TestAlpha(const identification::FitResult& fit);

/// Tests a ratio against 1, by Student's t with the degrees of freedom of Welch and Satterthwaite
///   ν = ν_fit/s²,  s the fit's fraction of the variance
/// (GUM G.4.1): the uncertainties of inputs are taken as known for certain.
/// @param degrees_of_freedom  ν_fit of the fit, > 0
StiffnessTest TestStiffness(std::string_view radius, const contact::PropagatedValue& ratio,
                            double degrees_of_freedom, double confidence = 0.95);

/// Returns a test for each radius that is known apart from the fit, if G* is known too; with the
/// ratio alone if σ is not identifiable.
std::vector<StiffnessTest> TestStiffness(const identification::FitResult& fit,
                                         const contact::IdentifiedContact& contact);

/// The force [N] at which a contact slips in one direction of the motion; without an error or an
/// interval where the fit leaves them open or holds both of what it follows from.
struct SlipForce {
  double value = 0.0;
  std::optional<double> standard_error = {};
  std::optional<double> lower95 = {};
  std::optional<double> upper95 = {};
};

struct SlipForces {
  SlipForce positive;  ///< Tc(1 + a) [N], for motion towards positive displacement
  SlipForce negative;  ///< Tc(1 − a) [N]
};

/// Returns the slip forces of a contact whose two differ, from its `slip_force` Tc and `asymmetry`
/// a; empty where the fit has none, or leaves either of the two open.
///   var ln Tc± = var ln Tc + var a/(1 ± a)² ± 2·cov(ln Tc, a)/(1 ± a)
/// Ends of the intervals combine the distances of Tc's and a's ends from the estimate in the same
/// way, so that an inflation of theirs inflates these.
std::optional<SlipForces> DescribeSlipForces(const identification::FitResult& fit);

}  // namespace mindahl::report
