#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mindahl/models/branch_law.h"

namespace mindahl::models {

/// Friction under a normal load N that varies along the path.
///
/// The contact is a set of elements in parallel (docs/theory.md §11): element h is in contact while
/// δc(N) > h, sticks elastically, and slips at |δ − r| = δc(N) − h, with r the displacement at
/// which it carries nothing. With
///   Tc(N) = μN,   σ(N) = σ_ref·(N/N_ref)^α,   δc(N) = Tc/(σ(1−α)) ∝ N^{1−α}
/// the elements of σ(h) add up at constant N to the branch law and its Masing loops, and for
/// α = 1/3 to the Hertz contact of Mindlin & Deresiewicz (1953) under any N(t) and δ(t), as far as
/// Cattaneo's and Mindlin's assumptions go (Jäger 1993, Ciavarella 1998). α alone says how the
/// stiffness follows the load: a circular contact has σ ∝ a ∝ N^{1/3}, a flat punch (α = 0) a
/// constant σ, a cone (α = 1/2) σ ∝ √N.
struct LoadDependentLaw {
  double friction_coefficient = 0.0;  ///< μ [–], finite, > 0
  double reference_load = 0.0;        ///< N_ref [N], finite, > 0
  double reference_stiffness = 0.0;   ///< σ_ref [N/m], at the reference load, finite, > 0
  double shape_exponent = 1.0 / 3.0;  ///< α [–], >= 0, < 1: slip is complete at a finite δc
};

/// Returns the branch law under the reference load.
BranchLaw ReferenceLaw(const LoadDependentLaw& law);

/// @throws InvalidArgument naming the parameter, its value and the rule, also where the branch law
/// at the reference load is invalid
void Validate(const LoadDependentLaw& law);

/// Computes the tangential force [N] at each sample: no time step, exact for a path that runs
/// straight in (δ, δc(N)) from sample to sample, which for samples of a smooth path leaves an error
/// of second order in their spacing, slipping or not.
///   T = Σ r'·[Tc(h₂) − Tc(h₁)]   over zones (h₁, h₂) of elements whose r(h) is a straight line
/// A sample where |Δδ| <= Δδc sticks everywhere and adds the zone Δδ/Δδc at the rim; any other
/// makes a zone ±1 at the rim, that slips, and forgets what it covers (Madelung's rules, where N is
/// constant). docs/theory.md §11 derives it.
///
/// The contact is unloaded (T = 0) at displacement 0 under the first load, before the first sample.
/// At N = 0 it is lifted off: T = 0, and nothing is remembered.
/// @param displacement  δ [m], within ±1e100
/// @param normal_load   N [N], finite, >= 0; same size
/// @param force         T [N], written; same size; |T| <= μN
/// @throws InvalidArgument for an invalid law, sizes that differ, and naming the sample for a
///   displacement or a load out of range
/// Error below 8 ε·(σ·max|δ| + Tc/(1−α)), with the largest σ and Tc of the path. Cost: amortised
/// one branch law a sample and, where N changes, one power; 40 bytes a remembered zone.
void EvaluateForceUnderLoad(const LoadDependentLaw& law, std::span<const double> displacement,
                            std::span<const double> normal_load, std::span<double> force);

/// Elements from `inner` outward, to the next zone or the rim, whose rest positions lie on the
/// line r(h) = intercept + slope·h (docs/theory.md §11). Real is double, or has derivatives.
template <typename Real>
struct LoadZone {
  Real inner{};       ///< h₁ [m]
  Real slope{};       ///< r' [–], within ±1; ±1 where the last slip was in that direction
  Real intercept{};   ///< r(0) [m], of the line
  Real force{};       ///< Σ r'·ΔTc [N] over the zones within
  Real slip_force{};  ///< Tc(h₁) [N]

  [[nodiscard]] Real RestAt(const Real& h) const { return intercept + slope * h; }
};

/// The rim of the contact under a load.
template <typename Real>
struct LoadRim {
  Real slip_displacement{};  ///< δc(N) [m], of the outermost elements
  Real slip_force{};         ///< Tc(N) [N]
};

/// A contact under a load that is moved from step to step.
template <typename Real>
struct ZonedContact {
  /// Cover 0 <= h < δc, innermost first; the elements at the rim carry nothing, so that δ need not
  /// be kept with them.
  std::vector<LoadZone<Real>> zones;
  LoadRim<Real> rim{};
  double displacement = 0.0;  ///< δ [m]
  Real force{};               ///< T [N]
};

/// The contact before its first step: T = 0.
struct InitialLoading {
  double normal_load = 0.0;            ///< N₀ [N], finite, >= 0; 0 for bodies yet to touch
  double unloaded_displacement = 0.0;  ///< δ₀ [m], within ±1e100
};

/// A contact under a varying normal load that is moved step by step: the law of
/// EvaluateForceUnderLoad, which is a loop over Move, for loops in which the next displacement and
/// load follow from this force.
///
/// Exact for steps that are straight in (δ, δc(N)): variable_load.h and docs/theory.md §11 say what
/// it solves. A state is a value: copies go on by themselves, so that one tries a step.
class LoadedContactState {
 public:
  /// @throws InvalidArgument for an invalid law, load or displacement
  explicit LoadedContactState(const LoadDependentLaw& law, const InitialLoading& initial = {});

  /// Moves on to δ and N and returns the force there. At N = 0 the contact is lifted off: T = 0,
  /// and nothing is remembered.
  /// @param displacement  δ [m], within ±1e100
  /// @param normal_load   N [N], finite, >= 0
  /// @returns T [N]; |T| <= μN
  /// @throws InvalidArgument, the state being left as it was, for a displacement or a load out of
  ///   range
  /// Error as of EvaluateForceUnderLoad. Cost: amortised one branch law and, where N changes, one
  /// power. Memory: 40 bytes a remembered zone, and nothing else is allocated. At constant N zones
  /// are as many as the nesting is deep; each step on which N rises without slip may add one, until
  /// slip or a falling load covers it.
  double Move(double displacement, double normal_load);

  /// Returns T [N] after the last step.
  [[nodiscard]] double Force() const { return contact_.force; }

  /// Returns δ [m].
  [[nodiscard]] double Displacement() const { return contact_.displacement; }

  /// Returns N [N].
  [[nodiscard]] double NormalLoad() const { return normal_load_; }

  /// Zones that are remembered.
  [[nodiscard]] std::size_t RememberedZones() const { return contact_.zones.size(); }

 private:
  [[nodiscard]] LoadRim<double> RimUnder(double normal_load) const;

  LoadDependentLaw law_;
  double reference_slip_displacement_;
  ZonedContact<double> contact_;
  double normal_load_ = 0.0;
};

}  // namespace mindahl::models
