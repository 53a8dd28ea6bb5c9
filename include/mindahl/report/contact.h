#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/identification/fit.h"

namespace mindahl::report {

/// Holds a quantity that follows from parameters of a fit and from what is known of the contact.
struct ContactQuantity {
  std::string_view name;    ///< key in the JSON: "friction_coefficient"
  std::string_view symbol;  ///< "μ"
  std::string_view unit;    ///< "-" if it is a ratio
  /// The parameter beside which it is printed; empty of what was given.
  std::string_view parameter{};
  std::optional<double> value{};  ///< empty where it does not follow
  /// Ends of the interval: those of the parameters' intervals, mapped; the uncertainties of known
  /// inputs are added in quadrature to the half width of the logarithm. Empty where one is open.
  std::optional<double> lower{};
  std::optional<double> upper{};
};

/// Returns every quantity of the contact of a fit, in the order of the reports: friction
/// coefficient, slip forces of either direction, contact radius, compliance, equivalent radius,
/// maximum pressure, gross-slip displacement, σ/(8a/G*) and the normal load. Nothing follows from a
/// parameter that the record leaves open; of one that has a limit alone a quantity has one.
/// @param fit  one that did not fail, of a force along the contact
/// @throws InvalidArgument as contact::IdentifyContact()
std::vector<ContactQuantity> DescribeContact(const identification::FitResult& fit,
                                             const contact::KnownContact& known);

/// Tests the fitted exponent against Mindlin's 1/3, which is rejected if and only if it lies
/// outside the interval of α. No test is made where α was held, is not identifiable, or has bounds
/// that exclude 1/3.
struct AlphaTest {
  std::optional<double> minus_third;  ///< α − 1/3; empty where α was held or is not known
  std::optional<bool> is_rejected;
  std::optional<double> p_value;  ///< two-sided, of Student's t; empty where α is at a bound
};
AlphaTest TestAlpha(const identification::FitResult& fit);

/// True if a load series denies Hertz's law: 1/3 lies outside the interval of p, or p was held at
/// another value. Then no ρ and no pressure follow from a contact radius.
bool DeniesHertz(const identification::FitResult& fit);

}  // namespace mindahl::report
