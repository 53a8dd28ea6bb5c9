#pragma once

#include <Eigen/Dense>
#include <cstddef>
#include <span>
#include <vector>

#include "identification/candidate.h"
#include "identification/scaled_records.h"
#include "mindahl/loop/displacement_noise.h"

namespace mindahl::identification {

/// How a record's displacement was read, in units of the data.
struct DisplacementReading {
  loop::DisplacementSmoother smoother;
  double noise = 0.0;         // standard deviation of a sample; 0 where the record counts as exact
  double encoder_step = 0.0;  // 0 where it is no encoder's
  std::vector<bool> repeats;  // samples that say what the one before said: one error
};

/// What errors of the displacement do to the force of a model: readings of the smoothed record are
/// drawn, with the noise or the encoder's phase that it was read with, smoothed and settled as the
/// record was.
///
/// An error of a turning point goes along with the whole branch that starts there, one of an
/// encoder with all turning points at that count, and smoothing ties neighbours together: no
/// variance of a sample tells that, a drawn record has it all.
class DisplacementErrors {
 public:
  /// @param data      as smoothed; must outlive this
  /// @param readings  of each record
  DisplacementErrors(const ScaledRecords& data, std::span<const DisplacementReading> readings);

  /// Is any record's displacement inexact?
  [[nodiscard]] bool any() const { return !draws_.empty(); }

  /// T(drawn) − T(as smoothed) of the candidate's model at its solution, in units of the data: one
  /// row a sample, one column a drawn set of records. The same draws every time. Their mean is not
  /// taken off: the outermost of several noisy samples lies a little too far out, and that too is
  /// an error.
  [[nodiscard]] Eigen::MatrixXd ForceErrors(const Candidate& candidate) const;

 private:
  struct Drawn {
    std::vector<double> displacement;
    std::vector<std::size_t> reversals;
  };

  const ScaledRecords& data_;
  std::vector<std::vector<Drawn>> draws_;  // of all records each
};

}  // namespace mindahl::identification
