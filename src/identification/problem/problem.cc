#include "identification/problem/problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "mindahl/core/interruption.h"
#include "mindahl/models/joint_friction.h"

namespace mindahl::identification {
namespace {

using Array = Eigen::Map<Eigen::ArrayXd>;
using ConstArray = Eigen::Map<const Eigen::ArrayXd>;

ConstArray ArrayOf(std::span<const double> values) { return {values.data(), std::ssize(values)}; }

}  // namespace

LawPoint PointAt(const Problem& problem, std::span<const double> theta) {
  const bool is_forced = problem.data->is_forced();
  return {.log_rate = (is_forced ? 0.0 : theta[kStiffness]) - theta[kSlipForce],
          .shape = theta[kShape],
          .log_travel = problem.parameters.has_rig() ? theta[kSlipForce] - theta[kRig] : 0.0,
          .load_exponent = problem.parameters.LoadExponentAt(theta),
          .theta = theta};
}

double LogScaleAt(const Problem& problem, std::span<const double> theta) {
  const bool is_forced = problem.data->is_forced();
  return theta[kSlipForce] - (is_forced ? theta[kStiffness] : 0.0);
}

models::NormalizedLaw LawUnder(const Problem& problem, const LawPoint& at,
                               const ScaledRecord& record) {
  const bool has_rig = problem.parameters.has_rig();
  return {.rate = std::exp(at.log_rate + (at.load_exponent - 1) * record.log_load),
          .shape_exponent = at.shape,
          .spring_travel = has_rig ? std::exp(at.log_travel + record.log_load) : 0.0};
}

std::vector<std::span<double>> ResponseColumns::Wanted() const {
  std::vector<std::span<double>> wanted;
  std::ranges::copy_if(columns_, std::back_inserter(wanted),
                       [](std::span<double> column) { return !column.empty(); });
  return wanted;
}

ResponseColumns ResponseColumns::Part(std::size_t begin, std::size_t count) const {
  ResponseColumns part;
  std::ranges::transform(columns_, part.begin(), [&](std::span<double> column) {
    return column.empty() ? column : column.subspan(begin, count);
  });
  return part;
}

Dependence DependenceOn(const Problem& problem, std::size_t parameter) {
  const Parameter& of = problem.parameters[parameter];
  const TermId id = of.term->id;
  const bool is_forced = problem.data->is_forced();
  if (of.absent) return {parameter};
  // t depends on σ/Tc and Tc/k, or of an imposed force on 1/Tc; the scale is Tc, or Tc/σ.
  switch (id) {
    case TermId::kSigma:
      if (is_forced) return {parameter, {{.factor = -1.0}}};
      return {parameter, {{.column = id}}};
    case TermId::kSlipForce: {
      Dependence on{parameter, {{}, {.column = TermId::kSigma, .factor = -1.0}}};
      if (problem.parameters.has_rig()) on.summands.push_back({.column = TermId::kRigStiffness});
      return on;
    }
    case TermId::kRigStiffness:
      return {parameter, {{.column = id, .factor = -1.0}}};
    case TermId::kLoadExponent:
      return {parameter, {{.column = TermId::kSigma, .by_log_load = true}}};
    default:
      if (of.term->is_linear || ShapesColumns(problem, parameter)) return {parameter};
      return {parameter, {{.column = id}}};
  }
}

namespace {

/// True of Masing's law: its loading path depends on an asymmetry, and its elements on the load.
/// Dahl's own reads both from its state.
bool HasPathAsymmetry(const Problem& problem) {
  return problem.model->memory == models::Memory::kReturnPoint;
}

/// True if the response is the state z of a joint, from which its force is read by the load and by
/// the asymmetry (models/joint_friction.h).
bool IsStateOfJoint(const Problem& problem, const ScaledRecord& record) {
  return problem.model->memory == models::Memory::kNone &&
         (!record.load_ratio.empty() || !problem.parameters[RowOf(TermId::kAsymmetry)].absent);
}

double LoadRatioAt(const ScaledRecord& record, std::size_t sample) {
  return record.load_ratio.empty() ? 1.0 : record.load_ratio[sample];
}

/// Puts the force in the place of the state z, and its derivatives in the place of those of z.
void ReadForceOfJoint(const ScaledRecord& record, double asymmetry, std::span<double> t,
                      const ResponseColumns& columns) {
  const std::vector<std::span<double>> wanted = columns.Wanted();
  const std::span<double> by_asymmetry = columns[TermId::kAsymmetry];
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double load = LoadRatioAt(record, i);
    const double slope = models::JointForceSlope(t[i], load, asymmetry);
    for (const std::span<double> column : wanted) column[i] *= slope;
    if (!by_asymmetry.empty()) by_asymmetry[i] = load * t[i] * t[i];
    t[i] = models::JointForce(t[i], load, asymmetry);
  }
}

}  // namespace

void Response::Bind(const Problem& problem) {
  problem_ = &problem;
  const std::size_t records = problem.data->records.size();
  paths_.assign(records, {});
  if (problem.data->load_varies) histories_.resize(records);
  for (std::size_t r = 0; r < records; ++r) {
    const ScaledRecord& record = problem.data->records[r];
    if (record.load_ratio.empty() || !HasPathAsymmetry(problem)) continue;
    models::MakeLoadedHistory(record.displacement, record.load_ratio, record.reversals,
                              problem.states[r], histories_[r]);
  }
  slip_varies_ =
      std::ranges::any_of(std::array{TermId::kSlipSlope, TermId::kSlipCurvature, TermId::kSlipSpeed,
                                     TermId::kSlipTrend, TermId::kDragFraction},
                          [this](TermId id) { return Has(id); });
  moves_ = problem.parameters.PositionOfMotion();
  has_moved_ = problem.parameters.moves_contact();
  motions_.clear();
  for (std::size_t r = 0; has_moved_ && r < records; ++r) {
    motions_.push_back(MakeMovedSamples(problem.parameters[moves_].term->motion));
  }
}

models::InitialContact Response::InitialOf(std::size_t r, std::span<const double> theta) const {
  const models::InitialState state = problem_->states[r];
  const bool virgin = state == models::InitialState::kVirgin;
  return {.state = state,
          .unloaded_displacement = virgin ? theta[problem_->parameters.PositionOfOrigin(r)] : 0.0,
          .asymmetry = HasPathAsymmetry(*problem_) ? problem_->parameters.AsymmetryAt(theta) : 0.0};
}

double Response::UnitOfAmount(std::size_t r) const {
  const TermUnits& units = problem_->data->records[r].units;
  const bool is_in_time = problem_->parameters[moves_].term->motion == ContactMotion::kLate;
  return is_in_time ? units.half_duration : units.length;
}

MovedSamples& Response::MovedOf(std::size_t r, std::span<const double> theta) {
  const double amount = problem_->parameters[moves_].ToValue(theta[moves_]) / UnitOfAmount(r);
  motions_[r]->MoveTo(problem_->data->records[r], amount, problem_->model->memory,
                      InitialOf(r, theta));
  return *motions_[r];
}

MovedSamples& Response::MovedUnderForces(const LawPoint& at, std::size_t r) {
  MovedSamples& moved = MovedOf(r, at.theta);
  std::vector<double> t(moved.displacement().size());
  response_.Evaluate(*problem_->model, LawUnder(*problem_, at, problem_->data->records[r]),
                     moved.path(), moved.displacement(), t);
  moved.TakeForces(t);
  return moved;
}

const models::LoadingPath& Response::PathOf(std::size_t r, std::span<const double> theta) {
  CachedPath& cached = paths_[r];
  if (has_moved_) {
    MovedUnderForces(PointAt(*problem_, theta), r).CopyPathOfSamples(cached.path);
    return cached.path;
  }
  const models::InitialContact initial = InitialOf(r, theta);
  if (cached.unloaded != initial.unloaded_displacement ||
      cached.path.asymmetry != initial.asymmetry) {
    const ScaledRecord& record = problem_->data->records[r];
    models::MakeLoadingPath(record.excitation(), record.reversals, problem_->model->memory, initial,
                            cached.path);
    cached.unloaded = initial.unloaded_displacement;
  }
  return cached.path;
}

void Response::Evaluate(const LawPoint& at, std::span<double> t) { Differentiate(at, t, {}); }

void Response::DifferentiateByOrigins(const LawPoint& at, std::size_t r,
                                      models::OriginSensitivity& sensitivity) {
  const ScaledRecord& record = problem_->data->records[r];
  const models::NormalizedLaw law = LawUnder(*problem_, at, record);
  if (has_moved_) {
    const MovedSamples& moved = MovedUnderForces(at, r);
    response_.DifferentiateByOrigins(*problem_->model, law, moved.path(), moved.displacement(),
                                     sensitivity);
    for (auto* column : {&sensitivity.sample_slope, &sensitivity.sample_gain}) {
      moved.Gather(*column, std::span(*column).first(record.size()));
      column->resize(record.size());
    }
  } else {
    response_.DifferentiateByOrigins(*problem_->model, law, PathOf(r, at.theta),
                                     record.displacement, sensitivity);
  }
  const bool is_state = IsStateOfJoint(*problem_, record);
  std::vector<double> state(is_state ? record.size() : 0);
  if (is_state) DifferentiatePath(at, r, state, {});
  Eigen::ArrayXd slip_factors = Eigen::ArrayXd::Ones(std::ssize(record.displacement));
  if (slip_varies_) slip_factors = SlipOf(record, at).factor;
  for (std::size_t i = 0; i < record.size(); ++i) {
    double factor = slip_factors[static_cast<Eigen::Index>(i)];
    if (is_state) {
      factor *= models::JointForceSlope(state[i], LoadRatioAt(record, i),
                                        problem_->parameters.AsymmetryAt(at.theta));
    }
    sensitivity.sample_slope[i] *= factor;
    sensitivity.sample_gain[i] *= factor;
  }
}

models::NormalizedGradient Response::GradientOf(const ResponseColumns& columns) const {
  return {columns[TermId::kSigma], columns[TermId::kAlpha], columns[TermId::kDisplacementOffset],
          columns[TermId::kRigStiffness],
          HasPathAsymmetry(*problem_) ? columns[TermId::kAsymmetry] : std::span<double>()};
}

void Response::DifferentiatePath(const LawPoint& at, std::size_t r, std::span<double> t,
                                 const ResponseColumns& columns) {
  const ScaledRecord& record = problem_->data->records[r];
  if (has_moved_) {
    DifferentiateMoved(at, r, t, columns);
  } else if (record.imposed == loop::Channel::kForce) {
    DifferentiateForced(at, r, t, columns);
  } else if (!record.load_ratio.empty() && HasPathAsymmetry(*problem_)) {
    loaded_response_.Evaluate(LawUnder(*problem_, at, record), histories_[r],
                              at.theta[problem_->parameters.PositionOfOrigin(r)], t,
                              GradientOf(columns));
  } else {
    response_.Evaluate(*problem_->model, LawUnder(*problem_, at, record), PathOf(r, at.theta),
                       record.displacement, t, GradientOf(columns));
  }
}

/// Differentiates the response of one record whose force is imposed.
void Response::DifferentiateForced(const LawPoint& at, std::size_t r, std::span<double> t,
                                   const ResponseColumns& columns) {
  const models::ForcedLaw law{.slip_force = std::exp(-at.log_rate), .shape_exponent = at.shape};
  const bool is_below_slip = displacement_.Evaluate(
      *problem_->model, law, PathOf(r, at.theta), problem_->data->records[r].excitation(), t,
      {columns[TermId::kSigma], columns[TermId::kAlpha], columns[TermId::kForceOffset]});
  if (!is_below_slip) std::ranges::fill(t, std::numeric_limits<double>::quiet_NaN());
}

void Response::DifferentiateMoved(const LawPoint& at, std::size_t r, std::span<double> t,
                                  const ResponseColumns& columns) {
  const models::NormalizedLaw law = LawUnder(*problem_, at, problem_->data->records[r]);
  MovedSamples& moved = MovedOf(r, at.theta);
  const std::size_t places = moved.displacement().size();
  constexpr std::array kOfPath = {TermId::kSigma, TermId::kAlpha, TermId::kDisplacementOffset,
                                  TermId::kRigStiffness, TermId::kAsymmetry};
  std::vector<double> storage((1 + kOfPath.size()) * places);
  const std::span<double> forces = std::span(storage).first(places);
  ResponseColumns at_places;
  for (std::size_t k = 0; k < kOfPath.size(); ++k) {
    if (columns[kOfPath[k]].empty()) continue;
    at_places[kOfPath[k]] = std::span(storage).subspan((1 + k) * places, places);
  }
  const models::NormalizedGradient gradient = GradientOf(at_places);
  response_.Evaluate(*problem_->model, law, moved.path(), moved.displacement(), forces, gradient);
  moved.TakeForces(forces);
  moved.Gather(forces, t);
  for (const TermId id : kOfPath) {
    if (!columns[id].empty()) moved.Gather(at_places[id], columns[id]);
  }
  const std::span<double> by_amount = columns[problem_->parameters[moves_].term->id];
  if (by_amount.empty()) return;
  response_.DifferentiateByOrigins(*problem_->model, law, moved.path(), moved.displacement(),
                                   sensitivity_);
  moved.DifferentiateByAmount(sensitivity_, forces);
  moved.Gather(forces, by_amount);
  const double per_theta = problem_->parameters[moves_].scale / UnitOfAmount(r);
  for (double& value : by_amount) value *= per_theta;
}

void Response::Differentiate(const LawPoint& at, std::span<double> t,
                             const ResponseColumns& columns) {
  AskWhetherToGoOn();
  std::size_t begin = 0;
  for (std::size_t r = 0; r < problem_->data->records.size(); ++r) {
    const ScaledRecord& record = problem_->data->records[r];
    const ResponseColumns parts = columns.Part(begin, record.size());
    const std::span<double> values = t.subspan(begin, record.size());
    begin += record.size();
    DifferentiatePath(at, r, values, parts);
    if (IsStateOfJoint(*problem_, record)) {
      ReadForceOfJoint(record, problem_->parameters.AsymmetryAt(at.theta), values, parts);
    }
    if (slip_varies_) ScaleBySlipForce(r, at, values, parts);
    if (record.load == 1) continue;
    for (double& value : values) value *= record.load;
    for (const std::span<double> column : parts.Wanted()) {
      for (double& value : column) value *= record.load;
    }
  }
}

Response::Slip Response::SlipOf(const ScaledRecord& record, const LawPoint& at) const {
  const auto theta = [&](TermId id) { return at.theta[RowOf(id)]; };
  const ConstArray position = ArrayOf(record.displacement);
  Slip slip;
  slip.factor =
      1 + (position * (theta(TermId::kSlipSlope) + theta(TermId::kSlipCurvature) * position) +
           theta(TermId::kSlipTrend) * ArrayOf(record.time));
  slip.log_speed = Eigen::ArrayXd::Zero(position.size());
  slip.change = slip.log_speed;
  if (!record.log_speed.empty()) {
    slip.log_speed = ArrayOf(record.log_speed) - std::log(record.units.reference_speed);
  }
  if (Has(TermId::kSlipSpeed)) {
    const double exponent = theta(TermId::kSlipSpeedExponent);
    slip.change = slip.log_speed.unaryExpr([&](double x) { return std::expm1(exponent * x); });
    slip.factor += theta(TermId::kSlipSpeed) * slip.change;
  }
  if (Has(TermId::kDragFraction)) slip.factor -= theta(TermId::kDragFraction);
  return slip;
}

void Response::ScaleBySlipForce(std::size_t r, const LawPoint& at, std::span<double> response,
                                const ResponseColumns& columns) const {
  const ScaledRecord& record = problem_->data->records[r];
  const auto theta = [&](TermId id) { return at.theta[RowOf(id)]; };
  const Slip slip = SlipOf(record, at);
  const ConstArray position = ArrayOf(record.displacement);
  Array t(response.data(), std::ssize(response));
  for (const std::span<double> column : columns.Wanted()) {
    Array(column.data(), t.size()) *= slip.factor;
  }
  const auto set = [&](TermId id, const auto& derivative) {
    if (!columns[id].empty()) Array(columns[id].data(), t.size()) = derivative;
  };
  set(TermId::kSlipSlope, t * position);
  set(TermId::kSlipCurvature, t * position * position);
  set(TermId::kSlipTrend, t * ArrayOf(record.time));
  set(TermId::kSlipSpeed, t * slip.change);
  set(TermId::kSlipSpeedExponent,
      t * theta(TermId::kSlipSpeed) * slip.log_speed * (1 + slip.change));
  if (!Has(TermId::kDragFraction)) {
    t *= slip.factor;
    return;
  }
  // (v/v₀)^m along the motion, which has no memory.
  const Eigen::ArrayXd dragged = ArrayOf(record.velocity) * (-ArrayOf(record.log_speed)).exp() *
                                 (theta(TermId::kDragExponent) * slip.log_speed).exp();
  const double drag = theta(TermId::kDragFraction);
  set(TermId::kDragFraction, dragged - t);
  set(TermId::kDragExponent, drag * dragged * slip.log_speed);
  t = slip.factor * t + drag * dragged;
}

namespace {

/// Returns the column of a linear parameter in a record, or its derivative by the parameter that
/// shapes it (Term::shapes).
Eigen::ArrayXd ColumnOf(const Problem& problem, std::size_t parameter, std::size_t r,
                        std::span<const double> theta, bool derivative) {
  const ScaledRecord& record = problem.data->records[r];
  const Parameter& of = problem.parameters[parameter];
  const TermId id = of.term->id;
  const ConstArray position = ArrayOf(record.displacement);
  switch (id) {
    case TermId::kPlateauSlope:
      return position;
    case TermId::kPlateauCurvature:
      return position.square();
    case TermId::kForceDrift:
    case TermId::kDisplacementDrift:
      return ArrayOf(record.time);
    case TermId::kInertia:
      return ArrayOf(record.acceleration);
    case TermId::kCovariate:
      return ArrayOf(record.covariates[of.column]);
    case TermId::kViscous: {
      // A power of the speed in units of the data, so that C keeps the unit of a viscous force:
      //   φ(v) = v·((v² + v_ε²)u²)^((m−1)/2),  u the unit of v [m/s], v_ε its resolution
      // which is v for m = 1, C·sgn(v)|v|^m far above the resolution, and smooth below it.
      if (problem.parameters[RowOf(TermId::kSpeedExponent)].absent) return ArrayOf(record.velocity);
      const double exponent = theta[RowOf(TermId::kSpeedExponent)];
      const Eigen::ArrayXd log_speed = ArrayOf(record.log_speed) + std::log(record.units.speed);
      const Eigen::ArrayXd power = ArrayOf(record.velocity) * ((exponent - 1) * log_speed).exp();
      return derivative ? Eigen::ArrayXd(power * log_speed) : power;
    }
    case TermId::kRippleCosineUp:
    case TermId::kRippleSineUp:
    case TermId::kRippleCosineDown:
    case TermId::kRippleSineDown: {
      // cos or sin of 2πδ/λ in the strokes of one direction, δ from the middle of the first record,
      // and its derivative by ln λ.
      const TermUnits& first = problem.data->records.front().units;
      const double shift =
          (record.units.displacement_reference - first.displacement_reference) / first.length;
      const double rate = 2 * std::numbers::pi * std::exp(-theta[RowOf(TermId::kRipplePeriod)]);
      const Eigen::ArrayXd phase = rate * (position + shift);
      const bool is_sine = id == TermId::kRippleSineUp || id == TermId::kRippleSineDown;
      const bool is_up = id == TermId::kRippleCosineUp || id == TermId::kRippleSineUp;
      Eigen::ArrayXd wave(phase.size());
      if (is_sine == derivative) {
        wave = phase.cos();
      } else {
        wave = phase.sin();
      }
      if (derivative) wave *= (is_sine ? -1.0 : 1.0) * phase;
      return ((is_up ? 1.0 : -1.0) * ArrayOf(record.direction) > 0).select(wave, 0.0);
    }
    default:
      return Eigen::ArrayXd::Ones(position.size());  // an offset
  }
}

bool IsInRecord(const Parameter& parameter, std::size_t record) {
  return !parameter.absent &&
         (parameter.term->scope == Scope::kContact || parameter.record == record);
}

}  // namespace

void AddColumn(const Problem& problem, std::size_t parameter, std::size_t r,
               std::span<const double> theta, double factor, std::span<double> to) {
  const Parameter& of = problem.parameters[parameter];
  if (!IsInRecord(of, r)) return;
  Array(to.data(), std::ssize(to)) +=
      factor * ColumnOf(problem, parameter, r, theta, /*derivative=*/false);
}

bool ShapesColumns(const Problem& problem, std::size_t parameter) {
  return !problem.parameters[parameter].term->shapes.empty();
}

void AddDerivativeOfColumns(const Problem& problem, std::size_t parameter, std::size_t r,
                            std::span<const double> theta, double factor, std::span<double> to) {
  const Term& term = *problem.parameters[parameter].term;
  if (term.is_linear) AddColumn(problem, parameter, r, theta, factor, to);
  if (term.shapes.empty()) return;
  for (std::size_t q = 0; q < problem.parameters.size(); ++q) {
    const Term& linear = *problem.parameters[q].term;
    const bool is_shaped = linear.is_linear && linear.name.starts_with(term.shapes);
    if (!is_shaped || !IsInRecord(problem.parameters[q], r)) continue;
    Array(to.data(), std::ssize(to)) +=
        factor * theta[q] * ColumnOf(problem, q, r, theta, /*derivative=*/true);
  }
}

namespace {

/// Adds what is linear in its parameters to the scaled t.
void Complete(const Problem& problem, std::span<const double> theta, std::span<double> predicted) {
  const double scale = std::exp(LogScaleAt(problem, theta));
  for (double& value : predicted) value *= scale;
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    const Parameter& parameter = problem.parameters[p];
    if (!parameter.term->is_linear || theta[p] == 0) continue;
    std::size_t begin = 0;
    for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
      const std::size_t count = problem.data->records[r].size();
      AddColumn(problem, p, r, theta, theta[p], predicted.subspan(begin, count));
      begin += count;
    }
  }
}

/// Puts weighted residuals, model − measured, in the place of the model's response.
void TakeOffWeighted(const ScaledRecords& data, std::span<double> predicted) {
  TakeOffMeasured(data, predicted);
  std::size_t k = 0;
  for (const ScaledRecord& record : data.records) {
    for (std::size_t i = 0; i < record.size(); ++i, ++k) predicted[k] *= record.root_weight[i];
  }
}

}  // namespace

void TakeOffMeasured(const ScaledRecords& data, std::span<double> predicted) {
  std::size_t k = 0;
  for (const ScaledRecord& record : data.records) {
    const std::span<const double> measured = record.response();
    for (std::size_t i = 0; i < measured.size(); ++i, ++k) predicted[k] -= measured[i];
  }
}

void Predict(const Problem& problem, std::span<const double> theta, Response& response,
             std::span<double> predicted) {
  response.Evaluate(PointAt(problem, theta), predicted);
  Complete(problem, theta, predicted);
}

void EvaluateResidual(const Problem& problem, std::span<const double> theta, Response& response,
                      std::span<double> residual) {
  response.Bind(problem);
  Predict(problem, theta, response, residual);
  TakeOffWeighted(*problem.data, residual);
}

void DifferentiateResponse(const Problem& problem, const LawPoint& at, Response& response,
                           std::span<const Dependence> dependences, std::span<double> t,
                           std::span<double> columns) {
  const std::size_t samples = problem.size();
  // Each derivative of t is computed once, for however many parameters.
  std::vector<TermId> wanted;
  for (const Dependence& dependence : dependences) {
    for (const Sensitivity& summand : dependence.summands) {
      if (!summand.column || std::ranges::find(wanted, *summand.column) != wanted.end()) continue;
      wanted.push_back(*summand.column);
    }
  }
  const std::span<double> scratch = response.Scratch(wanted.size() * samples);
  ResponseColumns gradient;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    gradient[wanted[k]] = scratch.subspan(k * samples, samples);
  }
  response.Differentiate(at, t, gradient);
  std::ranges::fill(columns, 0.0);
  for (std::size_t c = 0; c < dependences.size(); ++c) {
    const Parameter& parameter = problem.parameters[dependences[c].parameter];
    const std::span<double> column = columns.subspan(c * samples, samples);
    std::size_t end = 0;
    for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
      const ScaledRecord& record = problem.data->records[r];
      const std::size_t begin = std::exchange(end, end + record.size());
      if (!IsInRecord(parameter, r)) continue;
      for (const Sensitivity& summand : dependences[c].summands) {
        const std::span<const double> of = summand.column ? gradient[*summand.column] : t;
        const double factor = summand.factor * (summand.by_log_load ? record.log_load : 1.0);
        for (std::size_t i = begin; i < end; ++i) column[i] += factor * of[i];
      }
    }
  }
}

void Differentiate(const Problem& problem, std::span<const double> theta, Response& response,
                   std::span<const std::size_t> columns, std::span<double> residual,
                   std::span<double> jacobian) {
  std::vector<Dependence> dependences;
  dependences.reserve(columns.size());
  for (const std::size_t p : columns) dependences.push_back(DependenceOn(problem, p));
  // `residual` is t until the rest is added, and what is measured taken off.
  DifferentiateResponse(problem, PointAt(problem, theta), response, dependences, residual,
                        jacobian);
  const double scale = std::exp(LogScaleAt(problem, theta));
  for (double& value : jacobian) value *= scale;
  std::size_t k = 0;
  for (const std::size_t p : columns) {
    for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
      const ScaledRecord& record = problem.data->records[r];
      const std::span<double> column = jacobian.subspan(k, record.size());
      k += record.size();
      AddDerivativeOfColumns(problem, p, r, theta, 1.0, column);
      for (std::size_t i = 0; i < column.size(); ++i) column[i] *= record.root_weight[i];
    }
  }
  Complete(problem, theta, residual);
  TakeOffWeighted(*problem.data, residual);
}

}  // namespace mindahl::identification
