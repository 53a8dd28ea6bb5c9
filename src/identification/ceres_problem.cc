#include "mindahl/identification/ceres_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/nearest_name.h"
#include "identification/problem/problem.h"
#include "identification/solve/unprojected_record.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {
namespace {

/// Returns the initial states that a fit found.
RecordStates StatesOf(const FitResult& fit) {
  std::vector<models::InitialState> states;
  states.reserve(fit.records.size());
  for (const RecordFit& record : fit.records) states.push_back(record.initial_state);
  return RecordStates(std::move(states));
}

/// Weighs records whose noise differs as the fit does.
void WeighAsFit(const FitResult& fit, ScaledRecords& data) {
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const double own = fit.records[r].response_noise;
    if (own == fit.ResponseNoise() || !(own > 0)) continue;
    for (double& weight : data.records[r].root_weight) weight *= fit.ResponseNoise() / own;
  }
}

ScaledRecords ScaleAsFit(loop::PreparedRecords& prepared, const FitOptions& options,
                         const FitResult& fit) {
  LeaveOutBeyondLags(options, prepared);
  ScaledRecords data = Scale(prepared, options);
  AddColumns(options, prepared, /*with_others=*/false, data);
  WeighAsFit(fit, data);
  return data;
}

loop::PreparedRecords PrepareAsFit(std::span<const loop::RecordView> records,
                                   const FitOptions& options, const FitResult& fit) {
  loop::PreparationOptions preparation = options.preparation;
  preparation.force_sense = fit.force_sense;
  return loop::Prepare(records, preparation);
}

}  // namespace

double CeresParameter::ValueAt(double at_theta) const {
  return positive ? scale * std::exp(at_theta) : reference + scale * at_theta;
}

double CeresParameter::ThetaAt(double value) const {
  return positive ? std::log(value / scale) : (value - reference) / scale;
}

struct CeresProblem::State {
  State(std::span<const loop::RecordView> views, const FitOptions& given, const FitResult& fit,
        double residual_unit)
      : options(given),
        prepared(PrepareAsFit(views, options, fit)),
        data(ScaleAsFit(prepared, options, fit)),
        problem{&data, options.model, StatesOf(fit), Parameters(data, options, StatesOf(fit))},
        unit(residual_unit / data.response_unit()) {}

  FitOptions options;
  loop::PreparedRecords prepared;
  ScaledRecords data;
  Problem problem;
  double unit;  // of residuals [units of the data]
  std::vector<CeresParameter> parameters;
  std::vector<std::vector<std::size_t>> blocks;  // of each record, among the parameters
  std::vector<std::shared_ptr<UnprojectedRecord>> records;
};

CeresProblem::CeresProblem(std::span<const loop::RecordView> records, const FitOptions& options,
                           const FitResult& fit, double residual_unit) {
  RequirePositive("residual unit", residual_unit);
  state_ = std::make_unique<State>(records, options, fit, residual_unit);
  const Parameters& parameters = state_->problem.parameters;
  std::vector<std::size_t> place(parameters.size());  // of the problem's among the reported
  for (const std::size_t p : parameters.reported()) {
    const Parameter& parameter = parameters[p];
    place[p] = state_->parameters.size();
    CeresParameter& block = state_->parameters.emplace_back();
    block = {.name = parameters.NameOf(p),
             .unit = parameters.UnitOf(p, !state_->data.records.front().velocity.empty()),
             .theta = parameter.theta,
             .lower = parameter.lower,
             .upper = parameter.upper,
             .fixed = parameter.fixed,
             .positive = parameter.term->positive,
             .reference = parameter.reference,
             .scale = parameter.scale};
    const ParameterEstimate* estimate = fit.Find(block.name);
    if (estimate != nullptr && !parameter.fixed) {
      block.theta = std::clamp(block.ThetaAt(estimate->value), block.lower, block.upper);
    }
  }
  for (std::size_t r = 0; r < state_->data.records.size(); ++r) {
    std::vector<std::size_t>& blocks = state_->blocks.emplace_back();
    const auto& record = state_->records.emplace_back(
        std::make_shared<UnprojectedRecord>(state_->problem, r, state_->unit));
    for (const std::size_t p : record->blocks()) blocks.push_back(place[p]);
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

std::size_t CeresProblem::records() const { return state_->blocks.size(); }

std::span<const std::size_t> CeresProblem::BlocksOf(std::size_t record) const {
  return state_->blocks.at(record);
}

std::unique_ptr<ceres::CostFunction> CeresProblem::MakeCostFunction(std::size_t record) const {
  return CostOfRecord(state_->records.at(record));
}

void CeresProblem::AddTo(ceres::Problem& problem, std::unique_ptr<ceres::LossFunction> loss) {
  // Ceres deletes a loss once, however many blocks share it.
  ceres::LossFunction* const shared_loss = loss.release();
  for (std::size_t r = 0; r < records(); ++r) {
    std::vector<double*> blocks;
    for (const std::size_t place : BlocksOf(r)) {
      blocks.push_back(&state_->parameters[place].theta);
    }
    AddRecord(state_->records[r], blocks, shared_loss, problem);
  }
  for (CeresParameter& parameter : state_->parameters) {
    BoundBlock(&parameter.theta, parameter.fixed, parameter.lower, parameter.upper, problem);
  }
}

struct LogLikelihood::State {
  State(std::span<const loop::RecordView> records, const FitOptions& options, const FitResult& fit)
      : residuals(records, options, fit, fit.ResponseNoise()) {
    residuals.AddTo(problem);
  }

  CeresProblem residuals;
  ceres::Problem problem;
  double effective_fraction = 1.0;  // of the samples
  std::vector<std::string> names;
  std::vector<CeresParameter*> parameters;  // of these
};

LogLikelihood::LogLikelihood(std::span<const loop::RecordView> records, const FitOptions& options,
                             const FitResult& fit) {
  RequirePositive("noise of the fit", fit.ResponseNoise());
  const bool is_forced = fit.response == loop::Channel::kDisplacement;
  std::size_t counted = 0;
  for (const RecordFit& record : fit.records) {
    counted += record.residual.size() - record.left_out;
    if (options.loss == Loss::kNone && (is_forced || !(record.displacement_noise > 0))) {
      continue;
    }
    throw InvalidArgument(
        "a log-likelihood needs samples of equal weight: fit without a robust loss and without "
        "noise of the displacement");
  }
  state_ = std::make_unique<State>(records, options, fit);
  state_->effective_fraction =
      std::min(fit.residuals.effective_samples / static_cast<double>(counted), 1.0);
  for (CeresParameter& parameter : state_->residuals.parameters()) {
    if (parameter.fixed || !state_->problem.HasParameterBlock(&parameter.theta)) continue;
    state_->names.push_back(parameter.name);
    state_->parameters.push_back(&parameter);
  }
}

LogLikelihood::LogLikelihood(LogLikelihood&&) noexcept = default;
LogLikelihood& LogLikelihood::operator=(LogLikelihood&&) noexcept = default;
LogLikelihood::~LogLikelihood() = default;

std::span<const std::string> LogLikelihood::names() const { return state_->names; }

double LogLikelihood::operator()(std::span<const double> values) {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  RequireSameSize("values", values.size(), "free parameters", state_->parameters.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    CeresParameter& parameter = *state_->parameters[i];
    if (parameter.positive && !(values[i] > 0)) return kNone;
    const double theta = parameter.ThetaAt(values[i]);
    if (!(theta >= parameter.lower && theta <= parameter.upper)) return kNone;
    parameter.theta = theta;
  }
  double cost = 0.0;
  const bool is_defined = state_->problem.Evaluate({}, &cost, nullptr, nullptr, nullptr);
  return is_defined && std::isfinite(cost) ? -state_->effective_fraction * cost : kNone;
}

}  // namespace mindahl::identification
