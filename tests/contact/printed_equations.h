#pragma once

#include <boost/multiprecision/cpp_bin_float.hpp>

#include "mindahl/contact/cattaneo_mindlin.h"

/// The equations of Peyret et al. (2017) in the form they are printed, errata corrected where a
/// comment says so, in 100 digits.
namespace mindahl::printed {

using Real = boost::multiprecision::cpp_bin_float_100;

inline Real TwoThirdsPower(const Real& x) { return x > 0 ? Real(pow(x, Real(2) / 3)) : Real(0); }
inline Real ThreeHalvesPower(const Real& x) { return x > 0 ? Real(x * sqrt(x)) : Real(0); }

struct Contact {
  explicit Contact(const contact::MindlinContact& contact)
      : contact_radius(contact.contact_radius),
        tangential_compliance(contact.tangential_compliance),
        slip_force(contact.slip_force) {}

  Real contact_radius, tangential_compliance, slip_force;

  /// Eq. 23 with 16a for the printed 12a.
  [[nodiscard]] Real GrossSlipDisplacement() const {
    return 3 * slip_force * tangential_compliance / (16 * contact_radius);
  }
  /// 16aδ/(3μNG*).
  [[nodiscard]] Real Share(const Real& displacement) const {
    return 16 * contact_radius * displacement / (3 * slip_force * tangential_compliance);
  }
  /// Eq. 6.
  [[nodiscard]] Real VirginDisplacement(const Real& force) const {
    return GrossSlipDisplacement() * (1 - TwoThirdsPower(1 - force / slip_force));
  }
  /// Eq. 9.
  [[nodiscard]] Real ReloadingDisplacement(const Real& force, const Real& peak) const {
    return -GrossSlipDisplacement() * (2 * TwoThirdsPower(1 - (peak + force) / (2 * slip_force)) -
                                       TwoThirdsPower(1 - peak / slip_force) - 1);
  }
  /// Eq. 13; Tc beyond gross slip.
  [[nodiscard]] Real VirginForce(const Real& displacement) const {
    return slip_force * (1 - ThreeHalvesPower(1 - Share(displacement)));
  }
  /// Eq. 14.
  [[nodiscard]] Real UnloadingForce(const Real& displacement, const Real& peak) const {
    const Real base = (Share(displacement) + TwoThirdsPower(1 - peak / slip_force) + 1) / 2;
    return peak - 2 * slip_force * (1 - ThreeHalvesPower(base));
  }
  /// Eq. 15 with its printed sign, +1, or the corrected one, −1.
  [[nodiscard]] Real ReloadingForce(const Real& displacement, const Real& peak, int sign) const {
    const Real base = (sign * Share(displacement) + TwoThirdsPower(1 - peak / slip_force) + 1) / 2;
    return -peak + 2 * slip_force * (1 - ThreeHalvesPower(base));
  }
};

/// Error of a double in units of `scale`·2⁻⁵², against a value of 100 digits.
inline double ErrorInUlps(double computed, const Real& exact, const Real& scale) {
  return static_cast<double>(abs(Real(computed) - exact) / abs(scale) * ldexp(Real(1), 52));
}
inline double ErrorInUlps(double computed, const Real& exact) {
  return ErrorInUlps(computed, exact, exact);
}

}  // namespace mindahl::printed
