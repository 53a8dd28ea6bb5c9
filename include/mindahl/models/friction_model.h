#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace mindahl::models {

/// Names the part of the history on which a branch depends.
enum class Memory {
  kReturnPoint,  ///< every surviving extremum (Masing with Madelung's rules)
  kNone,         ///< the force at the last reversal only
};

/// How the branch law is scaled on a branch, in units of Tc:
///   t(x) = t₀ + span·v·φ(k·x),   k = (σ/Tc)·v^{α−1}/span,
/// i.e. the branch law with stiffness σ·v^α that would slip after a further span·v·Tc. v is 1 for a
/// Masing law, which always restarts with the virgin stiffness.
struct BranchScale {
  double remaining = 1.0;            ///< v >= 0
  double span = 1.0;                 ///< 1 or 2
  double remaining_per_force = 0.0;  ///< ∂v/∂(s·t₀), s the branch's direction
};

/// Force over Tc at the extremes of the steady loop between ±X, y = σX/Tc, with its derivatives.
struct SteadyPeak {
  double force = 0.0;              ///< t*
  double per_log_stiffness = 0.0;  ///< ∂t*/∂ln y
  double per_shape = 0.0;          ///< ∂t*/∂α
  double per_log_travel = 0.0;     ///< ∂t*/∂ln c of a spring in series, 0 without one
};

/// A friction model: how a branch of the one law starts. All else follows from these few entries,
/// so that a new model is one row of the table in friction_model.cc.
struct FrictionModel {
  std::string_view name;   ///< on the command line
  std::string_view title;  ///< in reports
  Memory memory = Memory::kReturnPoint;
  std::optional<double> shape_exponent = std::nullopt;  ///< α where the model prescribes it

  /// @param signed_force  s·T₀/Tc at the branch's origin, s its direction
  /// @param virgin        the branch starts at the unloaded contact
  BranchScale (*scale)(double signed_force, bool virgin) = nullptr;
  SteadyPeak (*steady_peak)(double y, double shape_exponent) = nullptr;
};

/// Returns all models, in the order of the documentation.
std::span<const FrictionModel> FrictionModels();

/// Returns nullptr when there is no such model.
const FrictionModel* FindFrictionModel(std::string_view name);

}  // namespace mindahl::models
