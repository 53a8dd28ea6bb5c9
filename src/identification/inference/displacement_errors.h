#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <vector>

#include "identification/inference/local.h"
#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {

/// Simulates the effect of errors of the displacement on a model's force: readings of the smoothed
/// record are drawn, with its noise or its encoder's phase, and smoothed and settled as the record
/// was.
///
/// An error of a turning point goes along with the whole branch that starts there, one of an
/// encoder with all turning points at that count, and smoothing ties neighbours together: no
/// variance of a sample represents that; a drawn record has it all.
class DisplacementErrors {
 public:
  /// @param data  the prepared records, scaled; must outlive this
  DisplacementErrors(const loop::PreparedRecords& records, const ScaledRecords& data);

  /// True if the displacement of a record is inexact.
  [[nodiscard]] bool any() const { return !draws_.empty(); }

  /// T(drawn) − T(as smoothed) of the problem's model at θ, in units of the data: one row a sample,
  /// one column a drawn set of records. The same draws every time. Their mean is not taken off: the
  /// outermost of several noisy samples lies a little too far out, and that too is an error.
  [[nodiscard]] Eigen::MatrixXd ForceErrors(const Problem& problem,
                                            std::span<const double> theta) const;

 private:
  struct Drawn {
    std::vector<double> displacement;
    std::vector<std::size_t> reversals;
  };

  const ScaledRecords& data_;
  std::vector<std::vector<Drawn>> draws_;  // of all records each
};

/// Returns the effect of these errors on a solution's weighted residuals; empty if exact.
DisplacementEffect EffectOf(const DisplacementErrors& errors, const Problem& problem,
                            const Solution& solution, const Noise& noise);

}  // namespace mindahl::identification
