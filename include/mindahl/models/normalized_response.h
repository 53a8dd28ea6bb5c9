#pragma once

#include <memory>
#include <span>
#include <vector>

#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::models {

/// Holds the parameters on which T/Tc depends: the force itself is linear in Tc.
struct NormalizedLaw {
  double rate = 0.0;                  ///< κ = σ/Tc [1/m], finite, > 0
  double shape_exponent = 1.0 / 3.0;  ///< α [–], finite, >= 0
  double spring_travel = 0.0;         ///< c = Tc/k_r [m] of a spring in series; 0 without one
};

/// Derivatives of t = T/Tc, a column each; an empty one is not wanted.
struct NormalizedGradient {
  std::span<double> log_rate;               ///< ∂t/∂ln κ
  std::span<double> shape_exponent;         ///< ∂t/∂α
  std::span<double> unloaded_displacement;  ///< ∂t/∂δ₀ [1/m], of a virgin contact
  std::span<double> log_spring_travel;      ///< ∂t/∂ln c
  std::span<double> asymmetry = {};         ///< ∂t/∂a of slip forces Tc(1 ± a)
};

/// How forces over Tc follow the places where branches start, for those who move them.
struct OriginSensitivity {
  std::vector<double> origin_force;  ///< t at each branch's origin
  // Per branch, at its origin and on the branch that it starts from; 0 where there is none:
  std::vector<double> slope;          ///< ∂t/∂δ [1/m]
  std::vector<double> gain;           ///< by t at that branch's own origin
  std::vector<double> per_amplitude;  ///< ∂t/∂X [1/m] of a branch that starts at a steady extreme
  // Per sample:
  std::vector<double> sample_slope;  ///< ∂t/∂δ [1/m]
  std::vector<double> sample_gain;   ///< by t at the origin of its branch
};

/// EvaluateForce and its gradient over Tc (response.h has the equations and the accuracy), for
/// solvers: columns instead of rows, and buffers that are kept, so that nothing is allocated once
/// they are large enough. Tc itself and all other linear terms are the caller's.
class NormalizedResponse {
 public:
  NormalizedResponse();
  NormalizedResponse(NormalizedResponse&&) noexcept;
  NormalizedResponse& operator=(NormalizedResponse&&) noexcept;
  ~NormalizedResponse();

  /// @param path  as from MakeLoadingPath on the same displacements, for the model's memory
  /// @param t     written, of the same size
  /// @throws InvalidArgument as EvaluateForce
  void Evaluate(const FrictionModel& model, const NormalizedLaw& law, const LoadingPath& path,
                std::span<const double> displacement, std::span<double> t);

  /// @param gradient  columns of the same size, or empty
  void Differentiate(const FrictionModel& model, const NormalizedLaw& law, const LoadingPath& path,
                     std::span<const double> displacement, std::span<double> t,
                     const NormalizedGradient& gradient);

  void DifferentiateByOrigins(const FrictionModel& model, const NormalizedLaw& law,
                              const LoadingPath& path, std::span<const double> displacement,
                              OriginSensitivity& sensitivity);

 private:
  struct Buffers;
  std::unique_ptr<Buffers> buffers_;
};

}  // namespace mindahl::models
