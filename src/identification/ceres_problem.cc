#include "mindahl/identification/ceres_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "core/nearest_name.h"
#include "identification/problem/problem.h"
#include "identification/solve/unprojected_residual.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {

/// The problem of a fit, made again from its records.
struct ProblemOfFit {
  ProblemOfFit(std::span<const loop::RecordView> records, FitOptions options, const FitResult& fit);
  ProblemOfFit(const ProblemOfFit&) = delete;
  ProblemOfFit& operator=(const ProblemOfFit&) = delete;

  loop::PreparedRecords prepared;
  ScaledRecords data;
  std::optional<Problem> problem;
  std::vector<double> theta;  // of the fit, within the bounds
};

ProblemOfFit::ProblemOfFit(std::span<const loop::RecordView> records, FitOptions options,
                           const FitResult& fit) {
  options.preparation.force_sense = fit.force_sense;
  prepared = loop::Prepare(records, options.preparation);
  LeaveOutBeyondLags(options, prepared);
  data = Scale(prepared, options);
  AddColumns(options, prepared, /*with_others=*/false, data);
  std::vector<models::InitialState> states;
  states.reserve(data.records.size());
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    states.push_back(fit.records[r].initial_state);
    // Records whose noise differs weigh as in the fit.
    const double own = fit.records[r].response_noise;
    if (own == fit.ResponseNoise() || !(own > 0)) continue;
    for (double& weight : data.records[r].root_weight) weight *= fit.ResponseNoise() / own;
  }
  problem = Problem{&data, options.model, states, Parameters(data, options, states)};
  for (std::size_t p = 0; p < problem->parameters.size(); ++p) {
    const Parameter& parameter = problem->parameters[p];
    const ParameterEstimate* const estimate = fit.Find(problem->parameters.NameOf(p));
    theta.push_back(
        estimate == nullptr || parameter.fixed
            ? parameter.theta
            : std::clamp(parameter.ToTheta(estimate->value), parameter.lower, parameter.upper));
  }
}

double CeresParameter::Value() const {
  return positive ? scale * std::exp(theta) : reference + scale * theta;
}

double CeresParameter::ThetaAt(double value) const {
  return positive ? std::log(value / scale) : (value - reference) / scale;
}

struct CeresProblem::State {
  State(std::span<const loop::RecordView> records, const FitOptions& options, const FitResult& fit,
        double residual_unit)
      : of(records, options, fit),
        residual(std::make_shared<UnprojectedResidual>(*of.problem,
                                                       residual_unit / of.data.response_unit())) {}

  ProblemOfFit of;
  std::shared_ptr<UnprojectedResidual> residual;
  std::vector<CeresParameter> parameters;
  std::vector<std::size_t> blocks;  // among the parameters
};

CeresProblem::CeresProblem(std::span<const loop::RecordView> records, const FitOptions& options,
                           const FitResult& fit, double residual_unit) {
  RequirePositive("residual unit", residual_unit);
  state_ = std::make_unique<State>(records, options, fit, residual_unit);
  State& state = *state_;
  const Parameters& parameters = state.of.problem->parameters;
  const std::span<const std::size_t> blocks = state.residual->blocks();
  for (const std::size_t p : parameters.reported()) {
    const Parameter& parameter = parameters[p];
    if (std::ranges::find(blocks, p) != blocks.end()) {
      state.blocks.push_back(state.parameters.size());
    }
    state.parameters.push_back(
        {.name = parameters.NameOf(p),
         .unit = parameters.UnitOf(p, !state.of.data.records.front().velocity.empty()),
         .theta = state.of.theta[p],
         .lower = parameter.lower,
         .upper = parameter.upper,
         .fixed = parameter.fixed,
         .positive = parameter.term->positive,
         .reference = parameter.reference,
         .scale = parameter.scale});
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

std::unique_ptr<ceres::CostFunction> CeresProblem::MakeCostFunction() const {
  return CostOf(state_->residual);
}

void CeresProblem::AddTo(ceres::Problem& problem, std::unique_ptr<ceres::LossFunction> loss) {
  std::vector<double*> theta;
  for (const std::size_t place : blocks()) theta.push_back(&state_->parameters[place].theta);
  // Ceres deletes a loss once, however many blocks share it.
  AddResidual(state_->residual, theta, loss.release(), problem);
  for (CeresParameter& parameter : state_->parameters) {
    BoundBlock(&parameter.theta, parameter.fixed, parameter.lower, parameter.upper, problem);
  }
}

struct LogLikelihood::State {
  State(std::span<const loop::RecordView> records, const FitOptions& options, const FitResult& fit)
      : of(records, options, fit), residual(of.problem->size()) {}

  ProblemOfFit of;
  double per_square = 0.0;  // ln L by a squared residual in units of the data
  std::vector<std::string> names;
  Response response;
  std::vector<double> residual;
};

LogLikelihood::LogLikelihood(std::span<const loop::RecordView> records, const FitOptions& options,
                             const FitResult& fit) {
  RequirePositive("noise of the fit", fit.ResponseNoise());
  const bool is_forced = fit.response == loop::Channel::kDisplacement;
  const bool is_inexact =
      !is_forced && std::ranges::any_of(fit.records, [](const RecordFit& record) {
        return record.displacement_noise > 0;
      });
  if (options.loss != Loss::kNone || is_inexact) {
    throw InvalidArgument(
        "a log-likelihood needs samples of equal weight: fit without a robust loss and without "
        "noise of the displacement");
  }
  state_ = std::make_unique<State>(records, options, fit);
  const Problem& problem = *state_->of.problem;
  const double effective =
      std::min(fit.residuals.effective_samples / static_cast<double>(problem.data->counted), 1.0);
  const double unit = fit.ResponseNoise() / problem.data->response_unit();
  state_->per_square = -effective / (2 * unit * unit);
  for (const std::size_t p : problem.parameters.free()) {
    state_->names.push_back(problem.parameters.NameOf(p));
  }
}

LogLikelihood::LogLikelihood(LogLikelihood&&) noexcept = default;
LogLikelihood& LogLikelihood::operator=(LogLikelihood&&) noexcept = default;
LogLikelihood::~LogLikelihood() = default;

std::span<const std::string> LogLikelihood::names() const { return state_->names; }

double LogLikelihood::operator()(std::span<const double> values) {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  const Problem& problem = *state_->of.problem;
  const std::vector<std::size_t>& free = problem.parameters.free();
  RequireSameSize("values", values.size(), "free parameters", free.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const Parameter& parameter = problem.parameters[free[i]];
    if (parameter.term->positive && !(values[i] > 0)) return kNone;
    const double theta = parameter.ToTheta(values[i]);
    if (!(theta >= parameter.lower && theta <= parameter.upper)) return kNone;
    state_->of.theta[free[i]] = theta;
  }
  try {
    EvaluateResidual(problem, state_->of.theta, state_->response, state_->residual);
  } catch (const InvalidArgument&) {  // no law
    return kNone;
  }
  double squares = 0.0;
  for (const double r : state_->residual) squares += r * r;
  return std::isfinite(squares) ? state_->per_square * squares : kNone;
}

}  // namespace mindahl::identification
