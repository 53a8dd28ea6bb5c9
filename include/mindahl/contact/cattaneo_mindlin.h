#pragma once

#include "mindahl/contact/hertz.h"

namespace mindahl::contact {

// Tangential contact of two spheres under a constant normal load (Cattaneo 1938, Mindlin 1949,
// Mindlin & Deresiewicz 1953). Coulomb's law holds point by point: an annulus c < r < a slips, the
// disc r < c sticks, and the whole contact slides at the slip force Tc = μN, from δ = δc on. δ is
// the relative displacement of distant points, and T the force that the contact returns.
//
// G* here is a COMPLIANCE [1/Pa], as in Peyret et al. (2017). Many texts write G* for its inverse,
// an effective shear modulus [Pa]. Steel on steel has G* ≈ 4.2e-11 1/Pa.
//
// Parameters are finite and, but for the displacement δ [m], > 0; InvalidArgument names the one
// that is not, its value and the rule, or the result that is beyond the normal doubles.

/// All that the tangential law needs of a contact.
struct MindlinContact {
  double contact_radius = 0.0;         ///< a [m], finite, > 0
  double tangential_compliance = 0.0;  ///< G* [1/Pa], finite, > 0
  double slip_force = 0.0;             ///< Tc = μN [N], finite, > 0
};

/// @throws InvalidArgument naming the first member that is not finite and > 0
void Validate(const MindlinContact& contact);

/// Returns the tangential compliance G* [1/Pa] of the pair.
///   G* = (2 − ν₁)/G₁ + (2 − ν₂)/G₂
/// Johnson (1985) §7.2; Peyret et al. (2017) eq. 7. A compliance: see above. It leaves out that
/// shear changes the pressure between dissimilar bodies, an effect that is nil for (1 − 2ν₁)/G₁ =
/// (1 − 2ν₂)/G₂.
/// @throws InvalidArgument as ShearModulus, for either body
/// Relative error < 2 ε.
double TangentialCompliance(const Body& body_1, const Body& body_2);

/// Returns the force Tc [N] at which the whole contact slips.
///   Tc = μN, of μ [-] and N [N]
/// Relative error < 1 ε.
double GrossSlipForce(double friction_coefficient, double normal_load);

/// Returns the stiffness σ [N/m] of the contact before any slip.
///   σ = 8a/G*, of a [m] and G* [1/Pa]
/// Relative error < 1 ε.
double MindlinTangentialStiffness(double contact_radius, double tangential_compliance);

/// Returns the displacement δc [m] at which a virgin contact slips as a whole.
///   δc = 3·Tc·G*/(16a)
/// Eq. 6 at T = Tc; the paper's eq. 23 prints 12a. Relative error < 1 ε = 2.2e-16.
/// @throws InvalidArgument as Validate
double GrossSlipDisplacement(const MindlinContact& contact);

/// Returns the force T₀ [N] on the virgin curve, odd in δ; ±Tc beyond ±δc.
///   T₀ = Tc·[1 − z√z] = Tc·w(1 + z + z²)/(1 + z√z),  w = δ/δc,  z = 1 − w
/// Eq. 13 of the paper.
/// Relative error < 6 ulp for every δ: the second form, used here, does not cancel as δ → 0.
double MindlinVirginForce(const MindlinContact& contact, double displacement);

/// Returns the force T₁ [N] on the unloading branch of the loop with extremes ±δ*.
///   T₁ = T₀(δ*) − 2·T₀((δ* − δ)/2)
/// Eq. 14 of the paper, whose (1 − T*/Tc)^{2/3} is 1 − δ*/δc. Written in δ* it also covers δ* > δc,
/// the loop in gross slip, and does not lose the digits of δ* that T* near Tc no longer carries.
/// @param displacement            δ [m], |δ| <= δ*
/// @param displacement_amplitude  δ* [m], finite, >= 0
/// Absolute error < 18 ulp of T₀(δ*).
double MindlinUnloadingForce(const MindlinContact& contact, double displacement,
                             double displacement_amplitude);

/// Returns the force T₂ [N] on the reloading branch of the loop with extremes ±δ*.
///   T₂(δ) = −T₁(−δ) = −T₀(δ*) + 2·T₀((δ* + δ)/2)
/// Eq. 15 of the paper with its sign corrected (printed +16aδ/(3μNG*), must be −).
/// Parameters, errors and accuracy as MindlinUnloadingForce.
double MindlinReloadingForce(const MindlinContact& contact, double displacement,
                             double displacement_amplitude);

}  // namespace mindahl::contact
