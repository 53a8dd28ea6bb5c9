#include "mindahl/identification/ceres_problem.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <ranges>
#include <utility>

#include "core/refuse.h"
#include "identification/problem/problem.h"
#include "identification/solve/unprojected_residual.h"
#include "identification/solved_fit.h"

namespace mindahl::identification {

double CeresParameter::Value() const {
  return positive ? scale * std::exp(theta) : reference + scale * theta;
}

double CeresParameter::ThetaAt(double value) const {
  return positive ? std::log(value / scale) : (value - reference) / scale;
}

struct CeresProblem::State {
  ScaledRecords data;
  std::optional<Problem> problem;
  double residual_unit = 1.0;  // [units of the data]
  std::vector<CeresParameter> parameters;
};

CeresProblem::CeresProblem(std::span<const loop::RecordView> records, const FitOptions& options,
                           const FitResult& fit, double residual_unit)
    : state_(std::make_unique<State>()) {
  RequirePositive("residual unit", residual_unit);
  auto& [data, problem, unit, values] = *state_;
  data = ScaledAsFitted(records, options, options, fit);
  problem.emplace(data, options, fit.initial_state);
  unit = residual_unit / data.response_unit();
  const Parameters& parameters = problem->parameters;
  for (const std::size_t p : parameters.reported()) {
    const Parameter& parameter = parameters[p];
    values.push_back({.name = parameters.NameOf(p),
                      .unit = parameters.UnitOf(p),
                      .theta = parameter.theta,
                      .lower = parameter.lower,
                      .upper = parameter.upper,
                      .fixed = parameter.fixed,
                      .positive = parameter.term->positive,
                      .reference = parameter.reference,
                      .scale = parameter.scale});
    CeresParameter& value = values.back();
    const ParameterEstimate* const estimate = fit.Find(value.name);
    if (estimate == nullptr || parameter.fixed) continue;
    value.theta = std::clamp(value.ThetaAt(estimate->value), value.lower, value.upper);
  }
}

CeresProblem::CeresProblem(CeresProblem&&) noexcept = default;
CeresProblem& CeresProblem::operator=(CeresProblem&&) noexcept = default;
CeresProblem::~CeresProblem() = default;

std::span<CeresParameter> CeresProblem::parameters() { return state_->parameters; }

CeresParameter& CeresProblem::Find(std::string_view name) {
  const auto found = std::ranges::find(state_->parameters, name, &CeresParameter::name);
  if (found != state_->parameters.end()) return *found;
  throw InvalidArgument(
      "parameter " +
      UnknownAmong(name, state_->parameters | std::views::transform(&CeresParameter::name)));
}

void CeresProblem::AddTo(ceres::Problem& problem, std::unique_ptr<ceres::LossFunction> loss) {
  const Problem& of_fit = *state_->problem;
  const auto block_of = [&](std::size_t p) { return &Find(of_fit.parameters.NameOf(p)).theta; };
  AddResidualBlock(of_fit, state_->residual_unit, std::move(loss), block_of, problem);
  for (CeresParameter& parameter : state_->parameters) {
    BoundBlock(&parameter.theta, parameter.fixed, parameter.lower, parameter.upper, problem);
  }
}

}  // namespace mindahl::identification
