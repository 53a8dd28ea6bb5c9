#include "identification/inference/estimates.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/probability.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {

namespace {

ParameterStatus StatusOf(const Parameter& parameter, BoundSide side) {
  if (parameter.fixed) return ParameterStatus::kFixed;
  if (side == BoundSide::kInside) return ParameterStatus::kFree;
  const bool mirrored = parameter.scale < 0;
  return (side == BoundSide::kLower) != mirrored ? ParameterStatus::kAtLowerBound
                                                 : ParameterStatus::kAtUpperBound;
}

}  // namespace

std::vector<ParameterEstimate> ValuesOf(const Problem& problem, const Solution& solution) {
  const Parameters& parameters = problem.parameters;
  const bool timed = !problem.data->records.front().velocity.empty();
  std::vector<ParameterEstimate> values;
  values.reserve(parameters.reported().size());
  for (const std::size_t p : parameters.reported()) {
    values.push_back({.name = parameters.NameOf(p),
                      .unit = parameters.UnitOf(p, timed),
                      .value = parameters[p].ToValue(solution.theta[p]),
                      .standard_error = {},
                      .lower95 = {},
                      .upper95 = {},
                      .status = StatusOf(parameters[p], solution.side[p])});
  }
  return values;
}

Estimates::Estimates(const Problem& problem, const Solution& solution, const Noise& noise,
                     Eigen::MatrixXd drawn, const FitOptions& options, Linearization at)
    : problem_(problem),
      solution_(solution),
      noise_(noise),
      drawn_(std::move(drawn)),
      confidence_(options.confidence),
      quantile_(StudentQuantile(noise.degrees_of_freedom(problem.parameters.free().size()),
                                options.confidence)),
      variance_(noise.variance * noise.repeating),
      at_(std::move(at)) {
  local_ = AnalyseJacobian(problem, at_.jacobian, noise, drawn_);
  // A fit absorbs more of correlated residuals than the number of its parameters, and leaves less
  // than the noise's variance; beyond most_absorbed no more is corrected.
  if (noise.is_known || drawn_.size() > 0) return;
  const auto count = static_cast<double>(noise.samples);
  const auto parameters = static_cast<double>(problem.parameters.free().size());
  const double absorbed = std::min(local_.absorbed, options.thresholds.most_absorbed * count);
  if (absorbed > parameters) variance_ *= (count - parameters) / (count - absorbed);
}

std::optional<Eigen::Index> Estimates::PlaceOf(std::size_t parameter) const {
  const std::vector<std::size_t>& free = problem_.parameters.free();
  const auto place = std::ranges::find(free, parameter) - free.begin();
  if (place == std::ssize(free) || !local_.determined[static_cast<std::size_t>(place)]) return {};
  return place;
}

double Estimates::ErrorOfTheta(std::size_t parameter) const {
  if (problem_.parameters[parameter].fixed) return 0.0;
  const std::optional<Eigen::Index> place = PlaceOf(parameter);
  if (!place) return std::numeric_limits<double>::infinity();
  return std::sqrt(local_.factor(*place, *place) * variance_);
}

std::vector<double> Estimates::Beside(std::size_t parameter, double step) const {
  std::vector<double> theta = solution_.theta;
  theta[parameter] += step;
  const std::optional<Eigen::Index> place = PlaceOf(parameter);
  if (!place) return theta;
  const Eigen::VectorXd others =
      local_.white_factor.col(*place) / local_.white_factor(*place, *place);
  for (Eigen::Index j = 0; j < others.size(); ++j) {
    if (j != *place)
      theta[problem_.parameters.free()[static_cast<std::size_t>(j)]] += step * others[j];
  }
  return theta;
}

void Estimates::Fill(std::size_t p, ParameterEstimate& estimate) const {
  const Parameter& parameter = problem_.parameters[p];
  const double theta = solution_.theta[p];
  const BoundSide side = solution_.side[p];
  WithdrawInterval(estimate);
  if (parameter.fixed) return;
  const double error = ErrorOfTheta(p);
  if (!std::isfinite(error)) return;
  std::optional<double> lower;
  std::optional<double> upper;
  if (side != BoundSide::kInside) {
    // Half the normal law lies beyond the bound: the interval is one-sided, from the bound. Where
    // that is the program's own, nothing is known of what lies beyond it.
    const double inwards = side == BoundSide::kLower ? 1 : -1;
    const double end = parameter.ToValue(theta + inwards * NormalQuantile(confidence_) * error);
    const std::optional<double> bound =
        IsSearchLimit(parameter, side) ? std::nullopt : std::optional(estimate.value);
    const bool is_upwards = end > estimate.value;
    lower = is_upwards ? bound : end;
    upper = is_upwards ? end : bound;
  } else {
    estimate.standard_error =
        parameter.term->positive ? estimate.value * error : std::abs(parameter.scale) * error;
    lower = parameter.ToValue(theta - quantile_ * error);
    upper = parameter.ToValue(theta + quantile_ * error);
    if (*upper < *lower) std::swap(lower, upper);
  }
  SetInterval(estimate, WithinBounds(parameter, {.lower = lower, .upper = upper}));
}

double Estimates::Correlation(std::size_t row, std::size_t column) const {
  const std::optional<Eigen::Index> i = PlaceOf(row);
  const std::optional<Eigen::Index> j = PlaceOf(column);
  if (!i || !j) return std::numeric_limits<double>::quiet_NaN();
  if (i == j) return 1.0;
  const auto sign = [&](std::size_t p) {
    return problem_.parameters[p].scale < 0 ? -1.0 : 1.0;  // the value falls where θ grows
  };
  const Eigen::MatrixXd& factor = local_.factor;
  const double cosine = factor(*i, *j) / std::sqrt(factor(*i, *i) * factor(*j, *j));
  return sign(row) * sign(column) * std::clamp(cosine, -1.0, 1.0);  // but for rounding
}

double Estimates::WhiteShare(std::size_t parameter) const {
  const std::optional<Eigen::Index> place = PlaceOf(parameter);
  if (!place) return 1.0;
  const double variance = variance_ * local_.factor(*place, *place);
  // A correlation that is estimated from a handful of residuals may leave no variance at all.
  if (!(variance > 0)) return 1.0;
  return noise_.variance * local_.white_factor(*place, *place) / variance;
}

namespace {
constexpr double kUnbounded = std::numeric_limits<double>::infinity();
}  // namespace

Ends WithinBounds(const Parameter& parameter, Ends ends) {
  for (const auto& [side, theta] : {std::pair(BoundSide::kLower, parameter.lower),
                                    std::pair(BoundSide::kUpper, parameter.upper)}) {
    if (IsSearchLimit(parameter, side)) continue;
    const double bound = parameter.ToValue(theta);
    const bool is_least = (side == BoundSide::kLower) == (parameter.scale > 0);
    if (is_least && ends.lower) ends.lower = std::max(*ends.lower, bound);
    if (!is_least && ends.upper) ends.upper = std::min(*ends.upper, bound);
  }
  return ends;
}

void SetInterval(ParameterEstimate& estimate, Ends ends) {
  const auto closed = [](double end) {
    return std::isfinite(end) ? std::optional(end) : std::nullopt;
  };
  estimate.lower95 = closed(ends.lower.value_or(-kUnbounded));
  estimate.upper95 = closed(ends.upper.value_or(kUnbounded));
}

void Include(ParameterEstimate& estimate, Ends ends) {
  // std::min and std::max return their first argument where it is NaN, and SetInterval() opens that
  // end.
  const double lower =
      std::min(ends.lower.value_or(-kUnbounded), estimate.lower95.value_or(-kUnbounded));
  const double upper =
      std::max(ends.upper.value_or(kUnbounded), estimate.upper95.value_or(kUnbounded));
  SetInterval(estimate, {.lower = lower, .upper = upper});
}

void IncludeRatios(ParameterEstimate& estimate, std::span<const double> ratios) {
  if (estimate.status == ParameterStatus::kFixed || !estimate.lower95 || !estimate.upper95) return;
  const Ends ends{estimate.lower95, estimate.upper95};
  for (const double ratio : ratios) {
    Include(estimate, {.lower = ratio * *ends.lower, .upper = ratio * *ends.upper});
  }
}

void WithdrawInterval(ParameterEstimate& estimate) {
  estimate.standard_error.reset();
  estimate.lower95.reset();
  estimate.upper95.reset();
}

}  // namespace mindahl::identification
