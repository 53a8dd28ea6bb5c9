#include "mindahl/identification/ceres_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/refuse.h"
#include "identification/problem/problem.h"
#include "identification/solve/unprojected_residual.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {

double CeresParameter::Value() const {
  return positive ? scale * std::exp(theta) : reference + scale * theta;
}

double CeresParameter::ThetaAt(double value) const {
  return positive ? std::log(value / scale) : (value - reference) / scale;
}

/// The problem of a fit, made again from its records.
struct CeresProblem::State {
  loop::PreparedRecords prepared;
  ScaledRecords data;
  std::optional<Problem> problem;
  double residual_unit = 1.0;  // [units of the data]
  std::vector<CeresParameter> parameters;
  std::vector<std::size_t> blocks;  // among the parameters
};

CeresProblem::CeresProblem(std::span<const loop::RecordView> records, const FitOptions& given,
                           const FitResult& fit, double residual_unit)
    : state_(std::make_unique<State>()) {
  RequirePositive("residual unit", residual_unit);
  FitOptions options = given;
  options.preparation.force_sense = fit.force_sense;
  auto& [prepared, data, problem, unit, values, blocks] = *state_;
  prepared = loop::Prepare(records, options.preparation);
  LeaveOutBeyondLags(options, prepared);
  data = Scale(prepared, options);
  AddColumns(options, prepared, data);
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    data.records[r].turns_between = fit.records[r].turns_between;
  }
  problem.emplace(data, options, fit.initial_state);
  unit = residual_unit / data.response_unit();
  const std::vector<std::size_t> of_residual = UnprojectedResidual::BlocksOf(*problem);
  const Parameters& parameters = problem->parameters;
  for (const std::size_t p : parameters.reported()) {
    const Parameter& parameter = parameters[p];
    if (std::ranges::count(of_residual, p) > 0) blocks.push_back(values.size());
    CeresParameter& value = values.emplace_back(
        CeresParameter{.name = parameters.NameOf(p),
                       .unit = parameters.UnitOf(p, !data.records.front().velocity.empty()),
                       .theta = parameter.theta,
                       .lower = parameter.lower,
                       .upper = parameter.upper,
                       .fixed = parameter.fixed,
                       .positive = parameter.term->positive,
                       .reference = parameter.reference,
                       .scale = parameter.scale});
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
  std::vector<std::string> names;
  for (const CeresParameter& parameter : state_->parameters) names.push_back(parameter.name);
  throw InvalidArgument("parameter " + UnknownAmong(name, names));
}

std::span<const std::size_t> CeresProblem::blocks() const { return state_->blocks; }

std::unique_ptr<ceres::CostFunction> CeresProblem::MakeCostFunction(
    std::unique_ptr<ceres::LossFunction> loss) const {
  return std::make_unique<UnprojectedResidual>(*state_->problem, state_->residual_unit,
                                               std::move(loss));
}

void CeresProblem::AddTo(ceres::Problem& problem, std::unique_ptr<ceres::LossFunction> loss) {
  std::vector<double*> theta;
  for (const std::size_t place : blocks()) theta.push_back(&state_->parameters[place].theta);
  problem.AddResidualBlock(MakeCostFunction(std::move(loss)).release(), nullptr, theta);
  for (CeresParameter& parameter : state_->parameters) {
    BoundBlock(&parameter.theta, parameter.fixed, parameter.lower, parameter.upper, problem);
  }
}

}  // namespace mindahl::identification
