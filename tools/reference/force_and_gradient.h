#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mindahl/models/response.h"
#include "models/normalized_response.h"

namespace mindahl::models {

/// Columns of the gradient that EvaluateForceAndGradient writes.
enum GradientColumn : std::size_t {
  kPerLogStiffness = 0,   ///< ∂T/∂ln σ [N]
  kPerShapeExponent = 1,  ///< ∂T/∂α [N]
  kPerLogSlipForce = 2,   ///< ∂T/∂ln Tc [N]
  kPerUnloadedDisplacement = 3,  ///< ∂T/∂δ₀ [N/m], δ₀ the unloaded displacement of a virgin contact
  kPerLogSeriesStiffness = 4,  ///< ∂T/∂ln k_r [N]; 0 for a rigid rig
  kGradientColumns = 5,
};

/// Computes the force and its gradient by what the law says from those over Tc, which fits use.
/// @param gradient  written, row-major, displacement.size() × kGradientColumns
inline void EvaluateForceAndGradient(const FrictionModel& model, const BranchLaw& law,
                                     const LoadingPath& path, std::span<const double> displacement,
                                     std::span<double> force, std::span<double> gradient,
                                     const SeriesSpring& rig = {}) {
  const std::size_t size = displacement.size();
  std::vector<double> columns(4 * size);
  const auto column = [&](std::size_t index) {
    return std::span(columns).subspan(index * size, size);
  };
  EvaluateNormalizedForce(model,
                          {.rate = law.tangential_stiffness / law.slip_force,
                           .shape_exponent = law.shape_exponent,
                           .spring_travel = law.slip_force / rig.stiffness},
                          path, displacement, force, {column(0), column(1), column(2), column(3)});
  for (std::size_t i = 0; i < size; ++i) {
    double* row = &gradient[i * kGradientColumns];
    const double per_rate = column(0)[i];
    const double per_travel = column(3)[i];
    row[kPerLogStiffness] = law.slip_force * per_rate;
    row[kPerShapeExponent] = law.slip_force * column(1)[i];
    row[kPerLogSlipForce] = law.slip_force * (force[i] - per_rate + per_travel);
    row[kPerUnloadedDisplacement] = law.slip_force * column(2)[i];
    row[kPerLogSeriesStiffness] = -law.slip_force * per_travel;
    force[i] *= law.slip_force;
  }
}

}  // namespace mindahl::models
