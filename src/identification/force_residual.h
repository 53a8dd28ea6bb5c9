#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "identification/scaled_records.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"

namespace mindahl {

/// The residuals of a fit, model − measured, in units of the data: all records, one after the
/// other.
class ForceResidual {
 public:
  /// @param data  must outlive this
  ForceResidual(const ScaledRecords& data, const FrictionModel& model, InitialState state);

  [[nodiscard]] std::size_t size() const { return data_.samples(); }

  /// @param theta     all parameters, in the order of ParameterLayout, with or without overshoots
  /// @param residual  written, size() values
  void Evaluate(const std::vector<double>& theta, std::span<double> residual) const;

  /// Σ of the squared residuals.
  [[nodiscard]] double SumOfSquares(const std::vector<double>& theta) const;

  /// @param free      positions in theta of the columns wanted
  /// @param jacobian  written, row-major, size() × free.size()
  void Differentiate(const std::vector<double>& theta, std::span<const std::size_t> free,
                     std::span<double> residual, std::span<double> jacobian) const;

 private:
  /// One record's response: EvaluateForce or EvaluateForceAndGradient at its samples.
  void Respond(std::size_t record, const std::vector<double>& theta, std::span<double> force,
               std::vector<double>* gradient) const;
  [[nodiscard]] LoadingPath PathOf(std::size_t record, const std::vector<double>& theta) const;

  const ScaledRecords& data_;
  const FrictionModel& model_;
  InitialState state_;
  std::vector<LoadingPath> steady_paths_;     // a virgin contact's path moves with δ₀
  std::vector<std::size_t> first_overshoot_;  // position in theta of each record's first
};

}  // namespace mindahl
