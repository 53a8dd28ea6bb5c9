#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <initializer_list>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/core/error.h"

namespace mindahl::contact {

/// @throws InvalidArgument unless −1 < ν <= 0.5, the bounds of a stable isotropic body.
inline void RequirePoissonRatio(std::string_view quantity, double poisson_ratio) {
  if (!(poisson_ratio > -1.0 && poisson_ratio <= 0.5)) {
    ThrowInvalid(quantity, poisson_ratio, "must be > -1 and <= 0.5");
  }
}

/// @throws InvalidArgument on 0 and on what is not a number; planes and seats pass.
inline void RequireSurfaceRadius(std::string_view quantity, double radius) {
  if (std::isnan(radius) || radius == 0.0) {
    ThrowInvalid(
        quantity, radius,
        "must be a number other than 0: infinite for a plane, negative for a concave seat");
  }
}

/// Returns a positive result rounded to double.
/// @throws InvalidArgument where it is beyond the normal doubles
inline double InRange(std::string_view quantity, long double value) {
  using Limits = std::numeric_limits<double>;
  if (!(value >= static_cast<long double>(Limits::min()) &&
        value <= static_cast<long double>(Limits::max()))) {
    ThrowInvalid(quantity, value > 1 ? Limits::infinity() : 0.0,
                 "must be within the range of double, 2.2e-308 to 1.8e308");
  }
  return static_cast<double>(value);
}

// Uncertainty to first order (GUM, JCGM 100:2008, eq. 13) of what follows from a fit and from what
// is known besides it.

/// Names the sources of uncertainty: the fit's two, then the inputs.
enum Source : std::size_t {
  kStiffness,
  kSlipForce,
  kFriction,
  kNormalLoad,
  kYoungsModulus1,
  kPoissonRatio1,
  kRadius1,
  kYoungsModulus2,
  kPoissonRatio2,
  kRadius2,
  kContactRadius,
  kCompliance,
  kSourceCount
};

/// A quantity and, for each source, the relative change that one standard error of the source makes
/// in it, signed. Since every source has a place of its own, what enters twice is counted once.
struct Quantity {
  double value = 0.0;
  std::array<double, kSourceCount> change{};
};

Quantity Independent(const UncertainValue& source, Source place);

struct Factor {
  const Quantity& quantity;
  int power = 1;
};

/// A product of powers, whose value is computed elsewhere: relative changes add, times the powers.
Quantity Product(double value, std::initializer_list<Factor> factors, double root = 1.0);

/// Returns it with the errors of the fit and of the inputs.
/// @param correlation  of σ and Tc
PropagatedValue Total(const Quantity& quantity, double correlation = 0.0);

// Checks the known properties of a contact, derives what follows without a fit, lists the missing.

/// @throws InvalidArgument naming the quantity, its value and the rule
void RequireKnown(std::string_view quantity, const std::optional<UncertainValue>& known);

/// @throws InvalidArgument likewise, for any member
void RequireKnown(const KnownContact& known);

/// Checks a fitted value: its standard error is infinite where the fit does not determine it.
/// @throws InvalidArgument likewise
void RequireFitted(std::string_view quantity, std::string_view unit,
                   const UncertainValue& estimate);

/// Returns a quantity that the caller has found to be known.
template <typename Value>
const Value& Present(const std::optional<Value>& quantity) {
  if (!quantity) throw std::logic_error("a quantity of the contact that is needed is not known");
  return *quantity;
}

/// True if E and ν are known.
inline bool IsElastic(const KnownBody& body) { return body.youngs_modulus && body.poisson_ratio; }

/// Returns 1/E* = Σ (1 − ν²)/E, of bodies whose E and ν are known.
Quantity EffectiveModulusOf(const KnownContact& known);

/// Returns G* = Σ 2(2 − ν)(1 + ν)/E, likewise.
Quantity TangentialComplianceOf(const KnownContact& known);

/// Returns 1/ρ = 1/R₁ + 1/R₂; a plane changes nothing.
Quantity EquivalentRadiusOf(const UncertainValue& radius_1, const UncertainValue& radius_2);

// Names the missing elastic constants, in words: "the radius of body 1".
std::vector<std::string> MissingElasticConstants(const KnownContact& known);
std::vector<std::string> MissingRadii(const KnownContact& known);

}  // namespace mindahl::contact
