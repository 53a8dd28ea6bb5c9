#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "identification/scaled_records.h"
#include "mindahl/identification/fit.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {

/// One parameter as the solver sees it: θ, non-dimensional and of order one.
///   value = reference + scale·θ,  or  value = scale·exp(θ) where logarithmic
struct ScaledParameter {
  std::string name;
  std::string unit;
  bool logarithmic = false;
  double reference = 0.0;
  double scale = 1.0;
  double theta = 0.0;
  double lower = 0.0;  // of θ
  double upper = 0.0;
  bool fixed = false;
  bool estimated_elsewhere = false;  // fixed by the data, not by the user
  bool absent = false;               // a term that was not asked for: not reported

  [[nodiscard]] double ToValue(double at_theta) const;
  [[nodiscard]] double ToTheta(double value) const;
};

/// Positions in the vector of parameters: five shared, then three a record.
enum ParameterIndex : std::size_t {
  kLogStiffness = 0,
  kShapeExponent = 1,
  kLogSlipForce = 2,
  kLogRigStiffness = 3,
  kPlateauSlope = 4,
  kSharedParameters = 5,
  kForceOffset = 0,  // within a record
  kUnloadedDisplacement = 1,
  kForceDrift = 2,
  kRecordParameters = 3,
};

class ParameterLayout {
 public:
  /// @throws InvalidArgument for names, values and bounds of `options` that break a rule
  ParameterLayout(const ScaledRecords& data, const FitOptions& options, models::InitialState state);

  /// A copy with one more free parameter a reversal: how far the turning point lies beyond the
  /// outermost sample, in units of the data, at most the longer of the steps beside it.
  [[nodiscard]] ParameterLayout WithOvershoots(const ScaledRecords& data) const;

  /// Parameters that a result reports: all but the overshoots, which come last.
  [[nodiscard]] std::size_t reported() const { return reported_; }

  static std::size_t OfRecord(std::size_t record, std::size_t index) {
    return kSharedParameters + record * kRecordParameters + index;
  }

  [[nodiscard]] const std::vector<ScaledParameter>& parameters() const { return parameters_; }
  /// Positions of the free ones.
  [[nodiscard]] const std::vector<std::size_t>& free() const { return free_; }

  /// A copy in which one more parameter is held at θ.
  [[nodiscard]] ParameterLayout WithFixed(std::size_t index, double theta) const;

  /// σ, α, Tc in the units of the data.
  static models::BranchLaw ScaledLaw(const std::vector<double>& theta);
  /// The spring in series with the contact, in SI; rigid where it is absent.
  [[nodiscard]] models::SeriesSpring Rig(const std::vector<double>& theta) const;
  [[nodiscard]] bool has_rig() const { return !parameters_[kLogRigStiffness].absent; }
  /// Positions of the parameters that a result reports.
  [[nodiscard]] std::vector<std::size_t> Reported() const;
  /// σ, α, Tc in SI.
  [[nodiscard]] models::BranchLaw Law(const std::vector<double>& theta) const;

 private:
  void ApplyOptions(const FitOptions& options);
  void CollectFree();

  std::vector<ScaledParameter> parameters_;
  std::vector<std::size_t> free_;
  std::size_t reported_ = 0;
};

}  // namespace mindahl::identification
