#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>

#include "mindahl/contact/mindlin_dahl_mapping.h"

// Uncertainty to first order (GUM, JCGM 100:2008, eq. 13) of what follows from a fit and from what
// is known besides it.
namespace mindahl::contact {

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

}  // namespace mindahl::contact
