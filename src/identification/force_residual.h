#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "identification/parameter_layout.h"
#include "identification/scaled_records.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {

/// The residuals of a fit, model − measured, in units of the data, each times the root of its
/// sample's weight: all records, one after the other.
///   T = T_model·N/N̄ + F₀ + drift·t + slope·δ
class ForceResidual {
 public:
  /// @param data    must outlive this; its weights may change between evaluations
  /// @param layout  tells whether there is a rig; need not outlive this
  ForceResidual(const ScaledRecords& data, const models::FrictionModel& model,
                models::InitialState state, const ParameterLayout& layout);

  [[nodiscard]] std::size_t size() const { return data_->samples(); }
  [[nodiscard]] const models::FrictionModel& model() const { return *model_; }

  /// @param theta     all parameters, in the order of ParameterLayout, with or without overshoots
  /// @param residual  written, size() values
  void Evaluate(const std::vector<double>& theta, std::span<double> residual) const;

  /// The forces of the whole model [units of the data]; no weight.
  void Predict(const std::vector<double>& theta, std::span<double> force) const;

  /// The loading path of a record, without overshoots.
  [[nodiscard]] models::LoadingPath PathOf(std::size_t record,
                                           const std::vector<double>& theta) const;

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
  [[nodiscard]] models::SeriesSpring RigOf(const std::vector<double>& theta) const;
  /// Adds what is linear in its parameters to a record's response.
  void Complete(std::size_t record, const std::vector<double>& theta,
                std::span<double> force) const;

  const ScaledRecords* data_;
  const models::FrictionModel* model_;
  models::InitialState state_;
  bool has_rig_;
  std::vector<models::LoadingPath> steady_paths_;  // a virgin contact's path moves with δ₀
  std::vector<std::size_t> first_overshoot_;       // position in theta of each record's first
};

}  // namespace mindahl::identification
