#include "identification/force_residual.h"

#include "identification/parameter_layout.h"
#include "mindahl/models/response.h"

namespace mindahl {

ForceResidual::ForceResidual(const ScaledRecords& data, const FrictionModel& model,
                             InitialState state)
    : data_(data), model_(model), state_(state) {
  if (state_ == InitialState::kVirgin) return;
  for (const ScaledRecord& record : data_.records) {
    steady_paths_.push_back(MakeLoadingPath(record.displacement, record.reversals, model_.memory,
                                            {.state = InitialState::kSteady}));
  }
}

LoadingPath ForceResidual::PathOf(std::size_t record, const std::vector<double>& theta) const {
  if (state_ == InitialState::kSteady) return steady_paths_[record];
  const ScaledRecord& scaled = data_.records[record];
  return MakeLoadingPath(
      scaled.displacement, scaled.reversals, model_.memory,
      {.state = InitialState::kVirgin,
       .unloaded_displacement = theta[ParameterLayout::OfRecord(record, kUnloadedDisplacement)]});
}

void ForceResidual::Evaluate(const std::vector<double>& theta, std::span<double> residual) const {
  const BranchLaw law = ParameterLayout::ScaledLaw(theta);
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data_.records.size(); ++r) {
    const ScaledRecord& record = data_.records[r];
    const std::span<double> part = residual.subspan(begin, record.force.size());
    EvaluateForce(model_, law, PathOf(r, theta), record.displacement, part);
    const double offset = theta[ParameterLayout::OfRecord(r, kForceOffset)];
    const double drift = theta[ParameterLayout::OfRecord(r, kForceDrift)];
    for (std::size_t i = 0; i < part.size(); ++i) {
      part[i] += offset + drift * record.time[i] - record.force[i];
    }
    begin += part.size();
  }
}

void ForceResidual::Differentiate(const std::vector<double>& theta,
                                  std::span<const std::size_t> free, std::span<double> residual,
                                  std::span<double> jacobian) const {
  const BranchLaw law = ParameterLayout::ScaledLaw(theta);
  std::vector<double> gradient;
  std::size_t begin = 0;
  for (std::size_t r = 0; r < data_.records.size(); ++r) {
    const ScaledRecord& record = data_.records[r];
    const std::size_t count = record.force.size();
    const std::span<double> part = residual.subspan(begin, count);
    gradient.resize(count * kGradientColumns);
    EvaluateForceAndGradient(model_, law, PathOf(r, theta), record.displacement, part, gradient);
    const double offset = theta[ParameterLayout::OfRecord(r, kForceOffset)];
    const double drift = theta[ParameterLayout::OfRecord(r, kForceDrift)];
    for (std::size_t i = 0; i < count; ++i) {
      part[i] += offset + drift * record.time[i] - record.force[i];
      const double* model_row = &gradient[i * kGradientColumns];
      double* row = &jacobian[(begin + i) * free.size()];
      for (std::size_t column = 0; column < free.size(); ++column) {
        const std::size_t parameter = free[column];
        if (parameter == kLogStiffness) {
          row[column] = model_row[kPerLogStiffness];
        } else if (parameter == kShapeExponent) {
          row[column] = model_row[kPerShapeExponent];
        } else if (parameter == kLogSlipForce) {
          row[column] = model_row[kPerLogSlipForce];
        } else if (parameter == ParameterLayout::OfRecord(r, kForceOffset)) {
          row[column] = 1.0;
        } else if (parameter == ParameterLayout::OfRecord(r, kUnloadedDisplacement)) {
          row[column] = model_row[kPerUnloadedDisplacement];
        } else if (parameter == ParameterLayout::OfRecord(r, kForceDrift)) {
          row[column] = record.time[i];
        } else {
          row[column] = 0.0;  // another record's
        }
      }
    }
    begin += count;
  }
}

}  // namespace mindahl
