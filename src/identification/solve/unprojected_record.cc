#include "identification/solve/unprojected_record.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory_resource>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

/// The samples of one record, with the units of all.
ScaledRecords DataOfRecord(const ScaledRecords& data, std::size_t r) {
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
  ScaledRecords one = data.WithoutRecords(memory);
  ScaledRecord& record = one.records.emplace_back(data.records[r].WithoutSamples(memory));
  record.Append(data.records[r], 0, data.records[r].size());
  record.reversals = data.records[r].reversals;
  record.whole = data.records[r].whole;
  for (const unsigned char counts : record.counts) one.counted += counts;
  return one;
}

bool AreFinite(std::span<const double> values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

class RecordCost final : public ceres::CostFunction {
 public:
  explicit RecordCost(std::shared_ptr<UnprojectedRecord> record) : record_(std::move(record)) {
    set_num_residuals(static_cast<int>(record_->samples()));
    mutable_parameter_block_sizes()->assign(record_->blocks().size(), 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    record_->MoveTo(parameters, jacobians != nullptr);
    std::ranges::copy(record_->residual(), residuals);
    bool is_finite = AreFinite(record_->residual());
    for (std::size_t b = 0; jacobians != nullptr && b < record_->blocks().size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      std::ranges::copy(record_->Derivative(b), jacobians[b]);
      is_finite = is_finite && AreFinite(record_->Derivative(b));
    }
    return is_finite;  // Ceres would print what is no number
  }

 private:
  std::shared_ptr<UnprojectedRecord> record_;
};

class SampleCost final : public ceres::CostFunction {
 public:
  SampleCost(std::shared_ptr<UnprojectedRecord> record, std::size_t sample)
      : record_(std::move(record)), sample_(sample) {
    set_num_residuals(1);
    mutable_parameter_block_sizes()->assign(record_->blocks().size(), 1);
  }

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    record_->MoveTo(parameters, jacobians != nullptr);
    residuals[0] = record_->residual()[sample_];
    bool is_finite = std::isfinite(residuals[0]);
    for (std::size_t b = 0; jacobians != nullptr && b < record_->blocks().size(); ++b) {
      if (jacobians[b] == nullptr) continue;
      jacobians[b][0] = record_->Derivative(b)[sample_];
      is_finite = is_finite && std::isfinite(jacobians[b][0]);
    }
    return is_finite;
  }

 private:
  std::shared_ptr<UnprojectedRecord> record_;
  std::size_t sample_;
};

}  // namespace

UnprojectedRecord::UnprojectedRecord(const Problem& problem, std::size_t record, double unit)
    : data_(DataOfRecord(*problem.data, record)),
      problem_{&data_, problem.model, problem.state.Of(record),
               Parameters(problem.parameters, record, std::pmr::get_default_resource())},
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
                       : problem_.parameters.PositionOf(parameter.term->name, 0));
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
  return std::make_unique<RecordCost>(std::move(record));
}

std::unique_ptr<ceres::CostFunction> CostOfSample(std::shared_ptr<UnprojectedRecord> record,
                                                  std::size_t sample) {
  return std::make_unique<SampleCost>(std::move(record), sample);
}

}  // namespace mindahl::identification
