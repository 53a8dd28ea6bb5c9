#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// Names the stiffness of a loop that a rig reports.
enum class SweepStiffness {
  kSecant,   ///< T*/X between the loop's extremes
  kTangent,  ///< dT/dδ of first loading, as of a small oscillation at a force that was reached
};

struct SweepOptions {
  SweepStiffness stiffness = SweepStiffness::kSecant;
  bool over_force = false;     ///< amplitudes are forces [N], and not displacements [m]
  bool is_compliance = false;  ///< responses are 1/K [m/N]
  /// Fixed parameters, "sigma" [N/m], "alpha" and "slip_force" [N].
  std::map<std::string, double> fixed = {};
  double confidence = 0.95;
};

struct SweepFit {
  bool converged = false;
  std::string message;                        ///< message of the solver
  std::vector<ParameterEstimate> parameters;  ///< sigma, alpha, slip_force
  std::vector<double> fitted;                 ///< one a point
  double rms = 0.0;                           ///< rms of the residuals, in the unit of the response
  double r_squared = 0.0;
  /// Chance that independent residuals have as much correlation from one point to the next, in
  /// order of the amplitude, or more.
  double correlation_p_value = 1.0;
  std::size_t degrees_of_freedom = 0;

  [[nodiscard]] const ParameterEstimate& parameter(std::string_view name) const;
};

/// Returns the stiffness [N/m] of a Masing law at an amplitude, a force F or a displacement X.
/// With τ = T/Tc, dT/dδ = σ(1 − τ)^α and x = σδ/Tc = (1 − (1 − τ)^(1 − α))/(1 − α):
///   secant σ·τ/x, tangent σ(1 − τ)^α
/// docs/theory.md §14. Of small amplitudes they are σ(1 − ατ/2) and σ(1 − ατ).
/// @param sigma [N/m] > 0, alpha >= 0, slip_force [N] > 0, amplitude > 0
double SweepStiffnessAt(const SweepOptions& options, double sigma, double alpha, double slip_force,
                        double amplitude);

/// Fits σ, α and Tc to stiffness or compliance over the amplitude, by least squares of the
/// response (ceres::Solve, from nine starts). Intervals are those of the profile likelihood, F(1,
/// n − p); a parameter whose interval does not close is bounded on one side, or not identifiable.
/// @param amplitude  [m] or [N], > 0
/// @param response   [N/m] or [m/N], > 0, likewise
/// @throws InvalidArgument for sizes that differ, values beyond these and fewer points than free
///   parameters and one
SweepFit FitSweep(std::span<const double> amplitude, std::span<const double> response,
                  const SweepOptions& options = {});

}  // namespace mindahl::identification
