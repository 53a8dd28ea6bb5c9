#include "identification/estimator.h"

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <utility>

namespace mindahl::identification {
namespace {

constexpr double kConfidence = 0.95;
/// Of half a normal law, that share lies within this many standard deviations: Φ⁻¹(0.975).
constexpr double kOneSided = 1.959963984540054;

double TwoSidedQuantile(double degrees_of_freedom) {
  return boost::math::quantile(boost::math::students_t(degrees_of_freedom), 0.5 + kConfidence / 2);
}

ParameterStatus StatusOf(const ScaledParameter& parameter, double theta) {
  constexpr double kAtBound = 1e-9;
  if (parameter.fixed) return ParameterStatus::kFixed;
  const double tolerance = kAtBound * std::max(1.0, parameter.upper - parameter.lower);
  const bool mirrored = parameter.scale < 0;
  if (theta - parameter.lower <= tolerance) {
    return mirrored ? ParameterStatus::kAtUpperBound : ParameterStatus::kAtLowerBound;
  }
  if (parameter.upper - theta <= tolerance) {
    return mirrored ? ParameterStatus::kAtLowerBound : ParameterStatus::kAtUpperBound;
  }
  return ParameterStatus::kFree;
}

}  // namespace

Estimator::Estimator(const Candidate& candidate, double variance, const NoiseModel& noise,
                     std::span<const std::size_t> rows, double degrees_of_freedom,
                     const DisplacementEffect& displacement, std::size_t samples)
    : candidate_(candidate), quantile_(TwoSidedQuantile(degrees_of_freedom)), variance_(variance) {
  const auto& parameters = candidate.layout.parameters();
  std::vector<std::size_t> inside;
  for (const std::size_t i : candidate.layout.free()) {
    if (StatusOf(parameters[i], candidate.solution.theta[i]) == ParameterStatus::kFree) {
      inside.push_back(i);
    }
  }
  const bool none_at_a_bound = inside.size() == candidate.layout.free().size();
  const std::vector<double>& theta = candidate.solution.theta;
  conditional_ =
      AnalyseJacobian(candidate.residual, theta, std::move(inside), noise, rows, displacement);
  full_ = none_at_a_bound ? conditional_
                          : AnalyseJacobian(candidate.residual, theta, candidate.layout.free(),
                                            noise, rows, displacement);
  // Of correlated residuals a fit takes up more than its parameters' number, and leaves less than
  // the noise's variance; where it takes up most, that is all that can be said.
  constexpr double kMostAbsorbed = 0.5;
  if (samples == 0 || displacement.residuals.size() > 0) return;
  const auto count = static_cast<double>(samples);
  const auto parameters_free = static_cast<double>(full_.columns.size());
  const double absorbed = std::min(full_.absorbed, kMostAbsorbed * count);
  if (absorbed > parameters_free) variance_ *= (count - parameters_free) / (count - absorbed);
}

ParameterEstimate Estimator::Estimate(std::size_t index) const {
  const ScaledParameter& parameter = candidate_.layout.parameters()[index];
  const double theta = candidate_.solution.theta[index];
  ParameterEstimate estimate;
  estimate.name = parameter.name;
  estimate.unit = parameter.unit;
  estimate.value = parameter.ToValue(theta);
  estimate.status = StatusOf(parameter, theta);
  if (estimate.status == ParameterStatus::kFixed) {
    estimate.identifiability = Identifiability::kIdentifiable;
    return estimate;
  }
  const bool at_bound = estimate.status != ParameterStatus::kFree;
  const LocalUncertainty& local = at_bound ? full_ : conditional_;
  const auto column = std::ranges::find(local.columns, index) - local.columns.begin();
  const auto j = static_cast<std::size_t>(column);
  if (!local.determined[j]) return estimate;
  const double error = std::sqrt(local.Factor(j, j) * variance_);
  estimate.identifiability = Identifiability::kIdentifiable;
  if (at_bound) {
    // Half the normal law lies beyond the bound: the interval is one-sided, from the bound.
    const double reach = kOneSided * error;
    const double inner = parameter.ToValue(
        theta <= parameter.lower + (parameter.upper - parameter.lower) / 2 ? theta + reach
                                                                           : theta - reach);
    estimate.lower95 = std::min(estimate.value, inner);
    estimate.upper95 = std::max(estimate.value, inner);
    if (index == kShapeExponent) estimate.lower95 = std::max(*estimate.lower95, 0.0);
    return estimate;
  }
  estimate.standard_error =
      parameter.logarithmic ? estimate.value * error : std::abs(parameter.scale) * error;
  const double lower = parameter.ToValue(theta - quantile_ * error);
  const double upper = parameter.ToValue(theta + quantile_ * error);
  estimate.lower95 = std::min(lower, upper);
  estimate.upper95 = std::max(lower, upper);
  if (index == kShapeExponent) estimate.lower95 = std::max(*estimate.lower95, 0.0);
  return estimate;
}

double Estimator::Correlation(std::size_t row, std::size_t column) const {
  const auto& columns = conditional_.columns;
  const auto i = static_cast<std::size_t>(std::ranges::find(columns, row) - columns.begin());
  const auto j = static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin());
  if (i == columns.size() || j == columns.size() || !conditional_.determined[i] ||
      !conditional_.determined[j]) {
    return std::numeric_limits<double>::quiet_NaN();
  }
  if (i == j) return 1.0;
  const double sign = ScaleSign(row) * ScaleSign(column);
  return sign * conditional_.Factor(i, j) /
         std::sqrt(conditional_.Factor(i, i) * conditional_.Factor(j, j));
}

double Estimator::WhiteShare(std::size_t index, double white_variance) const {
  const auto found = std::ranges::find(full_.columns, index);
  const auto j = static_cast<std::size_t>(found - full_.columns.begin());
  if (found == full_.columns.end() || !full_.determined[j]) return 1.0;
  return white_variance * full_.white_factor[j] / (variance_ * full_.Factor(j, j));
}

double Estimator::ScaleSign(std::size_t index) const {
  return candidate_.layout.parameters()[index].scale < 0 ? -1.0 : 1.0;
}

}  // namespace mindahl::identification
