#include "identification/solve/unprojected_record.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

/// The samples of one record, with the units of all.
ScaledRecords DataOfRecord(const ScaledRecords& data, std::size_t r) {
  ScaledRecords one = data;
  one.records = {data.records[r]};
  one.counted = 0;
  for (const unsigned char counts : data.records[r].counts) one.counted += counts;
  return one;
}

/// The cost function of some samples of a record.
class RecordCost final : public ceres::CostFunction {
 public:
  RecordCost(std::shared_ptr<UnprojectedRecord> record, std::size_t first, std::size_t count)
      : record_(std::move(record)), first_(first), count_(count) {
    set_num_residuals(static_cast<int>(count));
    mutable_parameter_block_sizes()->assign(record_->blocks().size(), 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    record_->MoveTo(parameters, jacobians != nullptr);
    bool is_finite = Copy(record_->residual(), residuals);
    for (std::size_t b = 0; jacobians != nullptr && b < record_->blocks().size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      is_finite = Copy(record_->Derivative(b), jacobians[b]) && is_finite;
    }
    return is_finite;  // Ceres would print what is no number
  }

 private:
  /// @returns whether the values are finite
  bool Copy(std::span<const double> values, double* to) const {
    const std::span<const double> some = values.subspan(first_, count_);
    std::ranges::copy(some, to);
    return std::ranges::all_of(some, [](double value) { return std::isfinite(value); });
  }

  std::shared_ptr<UnprojectedRecord> record_;
  std::size_t first_;
  std::size_t count_;
};

}  // namespace

UnprojectedRecord::UnprojectedRecord(const Problem& problem, std::size_t record, double unit)
    : data_(DataOfRecord(*problem.data, record)),
      problem_{&data_, problem.model, problem.state.Of(record),
               Parameters(problem.parameters, record)},
      unit_(unit) {
  const std::size_t origin = problem.parameters.PositionOfOrigin(record);
  for (const Parameter& parameter : problem_.parameters) theta_.push_back(parameter.theta);
  for (const std::size_t p : problem.parameters.reported()) {
    const Parameter& parameter = problem.parameters[p];
    if (parameter.term->scope == Scope::kRecord && parameter.record != record) continue;
    if (p == origin && problem.state.Of(record) == models::InitialState::kSteady) continue;
    blocks_.push_back(p);
    own_.push_back(parameter.term->scope == Scope::kContact
                       ? p
                       : problem_.parameters.PositionOf(parameter.term->id));
  }
  response_.Bind(problem_);
  residual_.resize(samples());
  jacobian_.resize(samples() * blocks_.size());
}

void UnprojectedRecord::MoveTo(double const* const* theta, bool with_jacobian) {
  bool is_there = at_.size() == blocks_.size();
  for (std::size_t b = 0; b < at_.size(); ++b) is_there = is_there && at_[b] == *theta[b];
  if (is_there && (has_jacobian_ || !with_jacobian)) return;
  at_.resize(blocks_.size());
  for (std::size_t b = 0; b < at_.size(); ++b) {
    at_[b] = *theta[b];
    theta_[own_[b]] = at_[b];
  }
  const std::span<const std::size_t> columns =
      with_jacobian ? std::span<const std::size_t>(own_) : std::span<const std::size_t>();
  try {
    Differentiate(problem_, theta_, response_, columns, residual_, jacobian_);
  } catch (const InvalidArgument&) {  // no law: exp(θ) is 0 or infinite
    std::ranges::fill(residual_, std::numeric_limits<double>::quiet_NaN());
  }
  for (double& value : residual_) value /= unit_;
  has_jacobian_ = with_jacobian;
  if (!with_jacobian) return;
  for (double& value : jacobian_) value /= unit_;
}

std::unique_ptr<ceres::CostFunction> CostOfRecord(std::shared_ptr<UnprojectedRecord> record) {
  const std::size_t samples = record->samples();
  return std::make_unique<RecordCost>(std::move(record), 0, samples);
}

void AddRecord(std::shared_ptr<UnprojectedRecord> record, const std::vector<double*>& blocks,
               ceres::LossFunction* loss, ceres::Problem& problem) {
  if (loss == nullptr) {
    problem.AddResidualBlock(CostOfRecord(std::move(record)).release(), nullptr, blocks);
    return;
  }
  for (std::size_t i = 0; i < record->samples(); ++i) {
    if (!record->Counts(i)) continue;
    problem.AddResidualBlock(std::make_unique<RecordCost>(record, i, 1).release(), loss, blocks);
  }
}

void BoundBlock(double* theta, bool fixed, double lower, double upper, ceres::Problem& problem) {
  if (!problem.HasParameterBlock(theta)) return;
  if (fixed) {
    problem.SetParameterBlockConstant(theta);
    return;
  }
  *theta = std::clamp(*theta, lower, upper);
  problem.SetParameterLowerBound(theta, 0, lower);
  problem.SetParameterUpperBound(theta, 0, upper);
}

}  // namespace mindahl::identification
