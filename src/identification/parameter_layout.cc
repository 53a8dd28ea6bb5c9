#include "identification/parameter_layout.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

// Default bounds, in units of the data (half ranges of displacement and force). They are far
// outside what a record can tell: a stiffness of 1e9 is a vertical branch, a slip force of 1e4 a
// straight line.
constexpr double kLowestStiffness = 1e-6;
constexpr double kHighestStiffness = 1e9;
constexpr double kLowestSlipForce = 1e-3;
constexpr double kHighestSlipForce = 1e4;
constexpr double kHighestShapeExponent = 20.0;
constexpr double kWidestOffset = 10.0;

std::string Numbered(std::string_view name, std::size_t record, std::size_t records) {
  return records == 1 ? std::string(name) : fmt::format("{}_{}", name, record + 1);
}

ScaledParameter Logarithmic(std::string name, std::string unit, double scale, double lowest,
                            double highest) {
  ScaledParameter parameter;
  parameter.name = std::move(name);
  parameter.unit = std::move(unit);
  parameter.logarithmic = true;
  parameter.scale = scale;
  parameter.lower = std::log(lowest);
  parameter.upper = std::log(highest);
  return parameter;
}

ScaledParameter Linear(std::string name, std::string unit, double reference, double scale,
                       double lowest, double highest) {
  ScaledParameter parameter;
  parameter.name = std::move(name);
  parameter.unit = std::move(unit);
  parameter.reference = reference;
  parameter.scale = scale;
  parameter.lower = lowest;
  parameter.upper = highest;
  return parameter;
}

void Hold(ScaledParameter& parameter, double value) {
  parameter.theta = parameter.ToTheta(value);
  parameter.fixed = true;
}

/// A value for `parameter` from the user must be one that the model takes.
void RequireInDomain(const ScaledParameter& parameter, double value) {
  const std::string quantity = fmt::format("{} [{}]", parameter.name, parameter.unit);
  if (parameter.logarithmic) {
    RequirePositive(quantity, value);
  } else if (parameter.name == "alpha") {
    RequireNonNegative(quantity, value);
  } else {
    RequireFinite(quantity, value);
  }
}

}  // namespace

double ScaledParameter::ToValue(double at_theta) const {
  return logarithmic ? scale * std::exp(at_theta) : reference + scale * at_theta;
}

double ScaledParameter::ToTheta(double value) const {
  return logarithmic ? std::log(value / scale) : (value - reference) / scale;
}

ParameterLayout::ParameterLayout(const ScaledRecords& data, const FitOptions& options,
                                 models::InitialState state) {
  parameters_.push_back(
      Logarithmic("sigma", "N/m", data.force / data.length, kLowestStiffness, kHighestStiffness));
  parameters_.push_back(Linear("alpha", "-", 0.0, 1.0, 0.0, kHighestShapeExponent));
  parameters_.push_back(
      Logarithmic("slip_force", "N", data.force, kLowestSlipForce, kHighestSlipForce));
  if (options.model->shape_exponent) {
    Hold(parameters_[kShapeExponent], *options.model->shape_exponent);
  }

  ScaledParameter rig = Logarithmic("rig_stiffness", "N/m", data.force / data.length,
                                    kLowestStiffness, kHighestStiffness);
  rig.fixed = rig.absent = !options.fit_rig_stiffness;
  parameters_.push_back(rig);
  ScaledParameter plateau =
      Linear("plateau_slope", "N/m", 0.0, data.force / data.length, -kWidestOffset, kWidestOffset);
  plateau.fixed = plateau.absent = !options.plateau_slope;
  parameters_.push_back(plateau);

  const std::size_t count = data.records.size();
  for (std::size_t r = 0; r < count; ++r) {
    const ScaledRecord& record = data.records[r];
    // A single loading curve looks the same wherever its origin is put: no offset can be told.
    const bool has_offsets = options.offsets && !record.reversals.empty();
    ScaledParameter force_offset =
        Linear(Numbered("force_offset", r, count), "N", data.sense * record.force_reference,
               data.sense * data.force, -kWidestOffset, kWidestOffset);
    if (!has_offsets) Hold(force_offset, 0.0);
    parameters_.push_back(force_offset);

    ScaledParameter unloaded =
        Linear(Numbered("displacement_offset", r, count), "m", record.displacement_reference,
               data.length, -kWidestOffset, kWidestOffset);
    if (state == models::InitialState::kSteady) {
      Hold(unloaded, record.displacement_reference);  // the centre of the loop
      unloaded.estimated_elsewhere = true;
    } else if (!has_offsets) {
      Hold(unloaded, 0.0);
    }
    parameters_.push_back(unloaded);

    ScaledParameter drift =
        Linear(Numbered("force_drift", r, count), "N/s", 0.0,
               data.sense * data.force / record.half_duration, -kWidestOffset, kWidestOffset);
    if (!options.drift) Hold(drift, 0.0);
    parameters_.push_back(drift);
  }
  ApplyOptions(options);
  CollectFree();
  reported_ = parameters_.size();
}

ParameterLayout ParameterLayout::WithOvershoots(const ScaledRecords& data) const {
  ParameterLayout copy = *this;
  for (const ScaledRecord& record : data.records) {
    const std::vector<double>& x = record.displacement;
    for (const std::size_t i : record.reversals) {
      const double step = std::max(std::abs(x[i] - x[i - 1]), std::abs(x[i + 1] - x[i]));
      copy.parameters_.push_back(Linear("overshoot", "m", 0.0, data.length, 0.0, step));
    }
  }
  copy.CollectFree();
  return copy;
}

void ParameterLayout::ApplyOptions(const FitOptions& options) {
  const auto find = [&](const std::string& name) -> ScaledParameter& {
    const auto found = std::ranges::find(parameters_, name, &ScaledParameter::name);
    if (found != parameters_.end()) return *found;
    std::vector<std::string> names;
    for (const ScaledParameter& parameter : parameters_) names.push_back(parameter.name);
    throw InvalidArgument(
        fmt::format("parameter '{}' is unknown: must be one of {}", name, fmt::join(names, ", ")));
  };
  for (const auto& [name, interval] : options.bounds) {
    ScaledParameter& parameter = find(name);
    RequireInDomain(parameter, interval.upper);
    RequireInDomain(parameter, parameter.logarithmic && interval.lower == 0.0 ? interval.upper
                                                                              : interval.lower);
    if (!(interval.lower < interval.upper)) {
      throw InvalidArgument(fmt::format("bounds {}:{} of {} are invalid: the first must be smaller",
                                        interval.lower, interval.upper, name));
    }
    const double lower = interval.lower == 0.0 && parameter.logarithmic
                             ? parameter.lower
                             : parameter.ToTheta(interval.lower);
    const double upper = parameter.ToTheta(interval.upper);
    parameter.lower = std::min(lower, upper);
    parameter.upper = std::max(lower, upper);
  }
  for (const auto& [name, value] : options.fixed) {
    ScaledParameter& parameter = find(name);
    RequireInDomain(parameter, value);
    if (name == "alpha" && options.model->shape_exponent &&
        *options.model->shape_exponent != value) {
      throw InvalidArgument(fmt::format(
          "alpha cannot be fixed at {}: the model '{}' prescribes alpha = {}; use mindlin-dahl",
          value, options.model->name, *options.model->shape_exponent));
    }
    if (parameter.estimated_elsewhere) {
      throw InvalidArgument(
          fmt::format("{} cannot be fixed: that of a steady contact is the centre of its loop; fix "
                      "it for a virgin contact",
                      name));
    }
    Hold(parameter, value);
    parameter.absent = false;
  }
  for (const auto& [name, value] : options.start) {
    const ScaledParameter& parameter = find(name);
    RequireInDomain(parameter, value);
    const double theta = parameter.ToTheta(value);
    if (parameter.fixed || (theta >= parameter.lower && theta <= parameter.upper)) continue;
    const double one_end = parameter.ToValue(parameter.lower);
    const double other_end = parameter.ToValue(parameter.upper);
    ThrowInvalid(fmt::format("start of {} [{}]", name, parameter.unit), value,
                 fmt::format("must lie within its bounds {:.6g} … {:.6g}",
                             std::min(one_end, other_end), std::max(one_end, other_end)));
  }
}

void ParameterLayout::CollectFree() {
  free_.clear();
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (!parameters_[i].fixed) free_.push_back(i);
  }
}

ParameterLayout ParameterLayout::WithFixed(std::size_t index, double theta) const {
  ParameterLayout copy = *this;
  copy.parameters_[index].theta = theta;
  copy.parameters_[index].fixed = true;
  copy.CollectFree();
  return copy;
}

models::SeriesSpring ParameterLayout::Rig(const std::vector<double>& theta) const {
  if (!has_rig()) return {};
  return {.stiffness = parameters_[kLogRigStiffness].ToValue(theta[kLogRigStiffness])};
}

std::vector<std::size_t> ParameterLayout::Reported() const {
  std::vector<std::size_t> positions;
  for (std::size_t i = 0; i < reported_; ++i) {
    if (!parameters_[i].absent) positions.push_back(i);
  }
  return positions;
}

models::BranchLaw ParameterLayout::ScaledLaw(const std::vector<double>& theta) {
  return {.tangential_stiffness = std::exp(theta[kLogStiffness]),
          .shape_exponent = theta[kShapeExponent],
          .slip_force = std::exp(theta[kLogSlipForce])};
}

models::BranchLaw ParameterLayout::Law(const std::vector<double>& theta) const {
  return {.tangential_stiffness = parameters_[kLogStiffness].ToValue(theta[kLogStiffness]),
          .shape_exponent = theta[kShapeExponent],
          .slip_force = parameters_[kLogSlipForce].ToValue(theta[kLogSlipForce])};
}

}  // namespace mindahl::identification
