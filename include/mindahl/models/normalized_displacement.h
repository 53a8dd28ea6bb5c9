#pragma once

#include <span>
#include <vector>

#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::models {

/// Holds the parameters on which a displacement over Tc/σ depends along a path of forces: the
/// displacement itself is linear in the compliance 1/σ.
struct ForcedLaw {
  double slip_force = 0.0;            ///< Tc [N], finite, > 0
  double shape_exponent = 1.0 / 3.0;  ///< α [–], finite, >= 0
};

/// Derivatives of d = σδ/Tc, a column each; an empty one is not wanted.
struct DisplacementGradient {
  std::span<double> log_slip_force;  ///< ∂d/∂ln Tc
  std::span<double> shape_exponent;  ///< ∂d/∂α
  std::span<double> unloaded_force;  ///< ∂d/∂T₀ [1/N], of a virgin contact
};

/// The inverse of NormalizedResponse: d = σδ/Tc, from where the contact is unloaded, of a contact
/// whose force is imposed (imposed_force.h has the equations), and its gradient, for solvers. On a
/// branch from the reading T_r, which is where the force without its offset is t_r·Tc,
///
///   d = d_r + s·m·v^β·y(φ),   φ = |T − T_r|/(m·v·Tc),   v = 1, or 1 − s·t_r of Dahl's own law
///
/// m = 1 on the virgin branch, 2 after a reversal (1 of Dahl's own law). Keeps its buffer: nothing
/// is allocated once it is large enough. Cost: three powers a sample with the gradient.
class NormalizedDisplacement {
 public:
  /// @param model  any of FrictionModels() that is not scaled by the peak
  /// @param path   as from MakeLoadingPath on the same forces, for the model's memory: the branches
  ///               follow from the forces as they do from displacements
  /// @param force  [N], its offset included
  /// @param d      written, of the same size
  /// @returns false where a force is at slip or beyond: no displacement belongs to it, and d holds
  ///   nothing of use
  /// @throws InvalidArgument for sizes that differ and a model that is scaled by the peak
  bool Evaluate(const FrictionModel& model, const ForcedLaw& law, const LoadingPath& path,
                std::span<const double> force, std::span<double> d) {
    return Differentiate(model, law, path, force, d, {});
  }

  /// @param gradient  columns of the same size, or empty
  bool Differentiate(const FrictionModel& model, const ForcedLaw& law, const LoadingPath& path,
                     std::span<const double> force, std::span<double> d,
                     const DisplacementGradient& gradient);

 private:
  struct Branch {
    double origin = 0.0;     // T_r [N]
    double height = 0.0;     // m·v·Tc [N]
    double span = 1.0;       // m
    double remaining = 1.0;  // v
    bool is_virgin = false;
    // v and d at the origin, and their derivatives:
    double remaining_per_log_rate = 0.0;  // of 1/Tc
    double remaining_per_zero = 0.0;      // of T₀/Tc
    double d = 0.0;
    double per_log_rate = 0.0;
    double per_shape = 0.0;
    double per_zero = 0.0;
  };
  struct Point {
    double d = 0.0;
    double per_log_rate = 0.0;
    double per_shape = 0.0;
    double per_zero = 0.0;
  };
  static bool PointOn(const Branch& branch, const ForcedLaw& law, double force, bool with_gradient,
                      Point& point);

  std::vector<Branch> branches_;
};

}  // namespace mindahl::models
