#include "mindahl/identification/ceres_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory_resource>
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
  std::pmr::memory_resource* memory = std::pmr::get_default_resource();
  ScaledRecords data = Scale(prepared, options, memory);
  AddCovariates(options.covariates, /*with_others=*/false, prepared, options.offsets, data);
  AddColumnsOfTerms(options, data);
  if (HasTerm(options, TermId::kLag)) SetClocks(data);
  WeighAsFit(fit, data);
  return data;
}

loop::PreparedRecords PrepareAsFit(std::span<const loop::RecordView> records,
                                   const FitOptions& options, const FitResult& fit) {
  loop::PreparationOptions preparation = options.preparation;
  preparation.force_sense = fit.force_sense;
  return loop::Prepare(records, preparation, std::pmr::get_default_resource());
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
        problem{&data, options.model, StatesOf(fit),
                Parameters(data, options, StatesOf(fit), std::pmr::get_default_resource())},
        unit(residual_unit / data.response_unit()) {}

  FitOptions options;
  loop::PreparedRecords prepared;
  ScaledRecords data;
  Problem problem;
  double unit;  // of residuals [units of the data]
  std::vector<CeresParameter> parameters;
  std::vector<std::size_t> place;                // of the problem's parameters among these
  std::vector<std::vector<std::size_t>> blocks;  // of each record, among the parameters
};

CeresProblem::CeresProblem(std::span<const loop::RecordView> records, const FitOptions& options,
                           const FitResult& fit, double residual_unit) {
  RequirePositive("residual unit", residual_unit);
  state_ = std::make_unique<State>(records, options, fit, residual_unit);
  const Parameters& parameters = state_->problem.parameters;
  state_->place.assign(parameters.size(), parameters.size());
  for (const std::size_t p : parameters.reported()) {
    const Parameter& parameter = parameters[p];
    state_->place[p] = state_->parameters.size();
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
    const UnprojectedRecord record(state_->problem, r, state_->unit);
    for (const std::size_t p : record.blocks()) blocks.push_back(state_->place[p]);
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
  return CostOfRecord(std::make_shared<UnprojectedRecord>(state_->problem, record, state_->unit));
}

void CeresProblem::AddTo(ceres::Problem& problem, std::unique_ptr<ceres::LossFunction> loss) {
  // Ceres deletes a loss once, however many blocks share it.
  ceres::LossFunction* const shared_loss = loss.release();
  for (std::size_t r = 0; r < records(); ++r) {
    std::vector<double*> blocks;
    for (const std::size_t place : BlocksOf(r)) {
      blocks.push_back(&state_->parameters[place].theta);
    }
    auto record = std::make_shared<UnprojectedRecord>(state_->problem, r, state_->unit);
    if (shared_loss == nullptr) {
      problem.AddResidualBlock(CostOfRecord(std::move(record)).release(), nullptr, blocks);
      continue;
    }
    for (std::size_t i = 0; i < record->samples(); ++i) {
      if (!record->Counts(i)) continue;
      problem.AddResidualBlock(CostOfSample(record, i).release(), shared_loss, blocks);
    }
  }
  for (CeresParameter& parameter : state_->parameters) {
    if (!problem.HasParameterBlock(&parameter.theta)) continue;
    if (parameter.fixed) {
      problem.SetParameterBlockConstant(&parameter.theta);
      continue;
    }
    problem.SetParameterLowerBound(&parameter.theta, 0, parameter.lower);
    problem.SetParameterUpperBound(&parameter.theta, 0, parameter.upper);
  }
}

struct LogLikelihood::State {
  State(std::span<const loop::RecordView> given, const FitOptions& options, const FitResult& fit)
      : problem(given, options, fit, fit.ResponseNoise()) {}

  CeresProblem problem;
  double effective_fraction = 1.0;  // of the samples
  std::vector<std::string> names;
  std::vector<std::size_t> places;  // of these, among the problem's parameters
  struct Record {
    std::unique_ptr<ceres::CostFunction> cost;
    std::vector<double const*> blocks;
    std::vector<double> residual;
  };
  std::vector<Record> records;
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
  const std::span<CeresParameter> parameters = state_->problem.parameters();
  std::vector<bool> has_effect(parameters.size(), false);
  for (std::size_t r = 0; r < state_->problem.records(); ++r) {
    State::Record& record = state_->records.emplace_back();
    record.cost = state_->problem.MakeCostFunction(r);
    record.residual.resize(static_cast<std::size_t>(record.cost->num_residuals()));
    for (const std::size_t place : state_->problem.BlocksOf(r)) {
      record.blocks.push_back(&parameters[place].theta);
      has_effect[place] = true;
    }
  }
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    if (parameters[i].fixed || !has_effect[i]) continue;
    state_->names.push_back(parameters[i].name);
    state_->places.push_back(i);
  }
}

LogLikelihood::LogLikelihood(LogLikelihood&&) noexcept = default;
LogLikelihood& LogLikelihood::operator=(LogLikelihood&&) noexcept = default;
LogLikelihood::~LogLikelihood() = default;

std::span<const std::string> LogLikelihood::names() const { return state_->names; }

double LogLikelihood::operator()(std::span<const double> values) {
  constexpr double kNone = -std::numeric_limits<double>::infinity();
  RequireSameSize("values", values.size(), "free parameters", state_->places.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    CeresParameter& parameter = state_->problem.parameters()[state_->places[i]];
    if (parameter.positive && !(values[i] > 0)) return kNone;
    const double theta = parameter.ThetaAt(values[i]);
    if (!(theta >= parameter.lower && theta <= parameter.upper)) return kNone;
    parameter.theta = theta;
  }
  double squares = 0.0;
  for (State::Record& record : state_->records) {
    if (!record.cost->Evaluate(record.blocks.data(), record.residual.data(), nullptr)) return kNone;
    for (const double residual : record.residual) squares += residual * residual;
  }
  return std::isfinite(squares) ? -state_->effective_fraction * squares / 2 : kNone;
}

}  // namespace mindahl::identification
