#pragma once

#include <ceres/cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/problem.h>

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "identification/problem/problem.h"

namespace mindahl::identification {

/// The weighted residuals of one record of a problem, model − measured over a unit, as a function
/// of the θ of the contact's parameters and its own, with the analytic Jacobian. Keeps the last
/// evaluation, so that its samples can be asked for one by one.
class UnprojectedRecord {
 public:
  /// @param problem  is copied, as far as the record is concerned
  /// @param unit     by which residuals are divided [units of the data]
  UnprojectedRecord(const Problem& problem, std::size_t record, double unit);
  UnprojectedRecord(const UnprojectedRecord&) = delete;
  UnprojectedRecord& operator=(const UnprojectedRecord&) = delete;

  /// Positions of the parameter blocks among the problem's parameters, all of size one: those that
  /// the fit reports, but for the reference position of a steady contact, which has no effect.
  [[nodiscard]] std::span<const std::size_t> blocks() const { return blocks_; }
  [[nodiscard]] std::size_t samples() const { return problem_.size(); }
  [[nodiscard]] bool Counts(std::size_t sample) const {
    return data_.records.front().counts[sample] != 0;
  }

  /// Evaluates at the blocks' θ, unless it has been done there.
  void MoveTo(double const* const* theta, bool with_jacobian);
  [[nodiscard]] std::span<const double> residual() const { return residual_; }
  /// ∂residual/∂θ of a block.
  [[nodiscard]] std::span<const double> Derivative(std::size_t block) const {
    return {jacobian_.data() + block * samples(), samples()};
  }

 private:
  ScaledRecords data_;
  std::vector<std::size_t> blocks_;  // among the parameters of the whole problem
  std::vector<std::size_t> own_;     // among those of this record
  Problem problem_;
  double unit_;
  Response response_;
  std::vector<double> theta_;
  std::vector<double> at_;  // of the blocks
  bool has_jacobian_ = false;
  std::vector<double> residual_;
  std::vector<double> jacobian_;
};

/// The cost function of all samples of a record.
std::unique_ptr<ceres::CostFunction> CostOfRecord(std::shared_ptr<UnprojectedRecord> record);

/// Adds a residual block of the record; with a loss one a sample that counts, which share the
/// evaluations of the record, so that they belong to one thread.
/// @param blocks  θ of the record's blocks, in order
/// @param loss    may be null; the problem takes it as its options have it
void AddRecord(std::shared_ptr<UnprojectedRecord> record, const std::vector<double*>& blocks,
               ceres::LossFunction* loss, ceres::Problem& problem);

/// Bounds a parameter block of one θ, or holds it, where the problem has it.
void BoundBlock(double* theta, bool fixed, double lower, double upper, ceres::Problem& problem);

}  // namespace mindahl::identification
