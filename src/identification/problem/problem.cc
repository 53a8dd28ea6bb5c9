#include "identification/problem/problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include "identification/problem/turning_points.h"
#include "mindahl/core/interruption.h"
#include "mindahl/models/joint_friction.h"

namespace mindahl::identification {
namespace {

using Array = Eigen::Map<Eigen::ArrayXd>;
using ConstArray = Eigen::Map<const Eigen::ArrayXd>;

ConstArray ArrayOf(std::span<const double> values) { return {values.data(), std::ssize(values)}; }

}  // namespace

double LogScaleAt(const Problem& problem, std::span<const double> theta) {
  const bool is_forced = problem.data->is_forced();
  return theta[kSlipForce] - (is_forced ? theta[kStiffness] : 0.0);
}

bool ShapesColumns(const Problem& problem, std::size_t parameter) {
  return !problem.parameters[parameter].term->shapes.empty();
}

models::NormalizedLaw LawUnder(const Problem& problem, std::span<const double> theta,
                               const ScaledRecord& record) {
  const double exponent = problem.parameters.LoadExponentAt(theta);
  const double log_travel = theta[kSlipForce] - theta[kRig] + record.log_load;
  return {
      .rate = std::exp(theta[kStiffness] - theta[kSlipForce] + (exponent - 1) * record.log_load),
      .shape_exponent = theta[kShape],
      .spring_travel = problem.parameters.has_rig() ? std::exp(log_travel) : 0.0};
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

/// Puts the force in the place of the state z, and its derivatives in the place of those of z.
void ReadForceOfJoint(const ScaledRecord& record, double asymmetry, std::span<double> t,
                      const ResponseColumns& columns) {
  const std::vector<std::span<double>> wanted = columns.Wanted();
  const std::span<double> by_asymmetry = columns[TermId::kAsymmetry];
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double load = record.load_ratio.empty() ? 1.0 : record.load_ratio[i];
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
  for (std::size_t r = 0; r < records; ++r) paths_[r].turns = TurnsOf(problem.data->records[r]);
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
  motions_.assign(records, {});
}

models::InitialContact Response::InitialOf(std::size_t r, std::span<const double> theta) const {
  const models::InitialState state = problem_->states[r];
  const bool virgin = state == models::InitialState::kVirgin;
  return {.state = state,
          .unloaded_displacement = virgin ? theta[problem_->parameters.PositionOfOrigin(r)] : 0.0,
          .asymmetry = HasPathAsymmetry(*problem_) ? problem_->parameters.AsymmetryAt(theta) : 0.0};
}

const Motion& Response::MotionOf(std::size_t r, std::span<const double> theta) {
  const ScaledRecord& record = problem_->data->records[r];
  const Parameter& moves = problem_->parameters[moves_];
  const models::InitialContact initial = InitialOf(r, theta);
  const bool is_in_time = moves.term->motion == ContactMotion::kLate;
  const double unit = is_in_time ? record.units.half_duration : record.units.length;
  const double amount = moves.ToValue(theta[moves_]) / unit;
  Motion& motion = motions_[r];
  const bool is_there = !motion.paths.empty() && motion.amount == amount &&
                        motion.initial.unloaded_displacement == initial.unloaded_displacement &&
                        motion.initial.asymmetry == initial.asymmetry;
  if (!is_there) {
    motion = Move(record, moves.term->motion, amount, problem_->model->memory, initial);
  }
  return motion;
}

std::vector<const MovedPath*> Response::BearingPaths(const Motion& motion,
                                                     const models::NormalizedLaw& law) {
  std::vector<const MovedPath*> bearing(motion.paths.front().displacement.size());
  if (motion.paths.size() == 1) {
    std::ranges::fill(bearing, &motion.paths.front());
    return bearing;
  }
  std::vector<double> t(bearing.size());
  for (const double sign : {-1.0, 1.0}) {
    const MovedPath& side = motion.paths[sign > 0 ? 0 : 1];
    response_.Evaluate(*problem_->model, law, side.path, side.displacement, t);
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (sign * t[i] >= 0) bearing[i] = &side;
    }
  }
  return bearing;
}

const models::LoadingPath& Response::PathOf(std::size_t r, std::span<const double> theta) {
  CachedPath& cached = paths_[r];
  const models::InitialContact initial = InitialOf(r, theta);
  if (cached.unloaded != initial.unloaded_displacement ||
      cached.path.asymmetry != initial.asymmetry) {
    models::MakeLoadingPath(problem_->data->records[r].excitation(), cached.turns,
                            problem_->model->memory, initial, cached.path);
    cached.unloaded = initial.unloaded_displacement;
  }
  return cached.path;
}

void Response::Evaluate(std::span<const double> theta, std::span<double> t) {
  Differentiate(theta, t, {});
}

models::NormalizedGradient Response::GradientOf(const ResponseColumns& columns) const {
  return {columns[TermId::kSigma], columns[TermId::kAlpha], columns[TermId::kDisplacementOffset],
          columns[TermId::kRigStiffness],
          HasPathAsymmetry(*problem_) ? columns[TermId::kAsymmetry] : std::span<double>()};
}

void Response::DifferentiatePath(std::span<const double> theta, std::size_t r, std::span<double> t,
                                 const ResponseColumns& columns) {
  const ScaledRecord& record = problem_->data->records[r];
  if (has_moved_) {
    DifferentiateMoved(theta, r, t, columns);
  } else if (record.imposed == loop::Channel::kForce) {
    const models::ForcedLaw law{.slip_force = std::exp(theta[kSlipForce]),
                                .shape_exponent = theta[kShape]};
    const bool is_below_slip = displacement_.Evaluate(
        *problem_->model, law, PathOf(r, theta), record.excitation(), t,
        {columns[TermId::kSigma], columns[TermId::kAlpha], columns[TermId::kForceOffset]});
    if (!is_below_slip) std::ranges::fill(t, std::numeric_limits<double>::quiet_NaN());
  } else if (!record.load_ratio.empty() && HasPathAsymmetry(*problem_)) {
    loaded_response_.Evaluate(LawUnder(*problem_, theta, record), histories_[r],
                              theta[problem_->parameters.PositionOfOrigin(r)], t,
                              GradientOf(columns));
  } else {
    response_.Evaluate(*problem_->model, LawUnder(*problem_, theta, record), PathOf(r, theta),
                       record.displacement, t, GradientOf(columns));
  }
}

void Response::DifferentiateMoved(std::span<const double> theta, std::size_t r, std::span<double> t,
                                  const ResponseColumns& columns) {
  constexpr std::array kOfPath = {TermId::kSigma, TermId::kAlpha, TermId::kDisplacementOffset,
                                  TermId::kRigStiffness, TermId::kAsymmetry};
  const models::NormalizedLaw law = LawUnder(*problem_, theta, problem_->data->records[r]);
  const Motion& motion = MotionOf(r, theta);
  const std::vector<const MovedPath*> bearing = BearingPaths(motion, law);
  for (const MovedPath& side : motion.paths) {
    const std::size_t size = t.size();
    std::vector<double> storage((1 + kOfPath.size()) * size);
    const std::span<double> forces = std::span(storage).first(size);
    ResponseColumns of_side;
    for (std::size_t k = 0; k < kOfPath.size(); ++k) {
      if (columns[kOfPath[k]].empty()) continue;
      of_side[kOfPath[k]] = std::span(storage).subspan((1 + k) * size, size);
    }
    response_.Evaluate(*problem_->model, law, side.path, side.displacement, forces,
                       GradientOf(of_side));
    const auto take = [&](std::span<const double> from, std::span<double> to) {
      for (std::size_t i = 0; i < to.size(); ++i) {
        if (bearing[i] == &side) to[i] = from[i];
        if (bearing[i] == nullptr) to[i] = 0.0;  // the gap is being crossed
      }
    };
    take(forces, t);
    for (const TermId id : kOfPath) take(of_side[id], columns[id]);
  }
  const std::span<double> by_amount = columns[problem_->parameters[moves_].term->id];
  if (by_amount.empty()) return;
  // The rounding of a difference by this much of θ is 1e-9 of the slip force. It is that of a
  // longer lag and a wider gap: without either the response has a kink.
  constexpr double kStep = 1e-7;
  Motion here = std::move(motions_[r]);
  std::vector<double> beside(theta.begin(), theta.end());
  beside[moves_] += kStep;
  DifferentiateMoved(beside, r, by_amount, {});
  for (std::size_t i = 0; i < t.size(); ++i) by_amount[i] = (by_amount[i] - t[i]) / kStep;
  motions_[r] = std::move(here);
}

void Response::Differentiate(std::span<const double> theta, std::span<double> t,
                             const ResponseColumns& columns) {
  AskWhetherToGoOn();
  std::size_t begin = 0;
  for (std::size_t r = 0; r < problem_->data->records.size(); ++r) {
    const ScaledRecord& record = problem_->data->records[r];
    const ResponseColumns parts = columns.Part(begin, record.size());
    const std::span<double> values = t.subspan(begin, record.size());
    begin += record.size();
    DifferentiatePath(theta, r, values, parts);
    if (IsStateOfJoint(*problem_, record)) {
      ReadForceOfJoint(record, problem_->parameters.AsymmetryAt(theta), values, parts);
    }
    if (slip_varies_) ScaleBySlipForce(r, theta, values, parts);
    if (record.load == 1) continue;
    for (double& value : values) value *= record.load;
    for (const std::span<double> column : parts.Wanted()) {
      for (double& value : column) value *= record.load;
    }
  }
}

Response::Slip Response::SlipOf(const ScaledRecord& record, std::span<const double> theta) const {
  const auto value = [&](TermId id) { return theta[RowOf(id)]; };
  const ConstArray position = ArrayOf(record.displacement);
  Slip slip;
  slip.factor =
      1 + (position * (value(TermId::kSlipSlope) + value(TermId::kSlipCurvature) * position) +
           value(TermId::kSlipTrend) * ArrayOf(record.time));
  slip.log_speed = Eigen::ArrayXd::Zero(position.size());
  slip.change = slip.log_speed;
  if (!record.log_speed.empty()) {
    slip.log_speed = ArrayOf(record.log_speed) - std::log(record.units.reference_speed);
  }
  if (Has(TermId::kSlipSpeed)) {
    const double exponent = value(TermId::kSlipSpeedExponent);
    slip.change = slip.log_speed.unaryExpr([&](double x) { return std::expm1(exponent * x); });
    slip.factor += value(TermId::kSlipSpeed) * slip.change;
  }
  if (Has(TermId::kDragFraction)) slip.factor -= value(TermId::kDragFraction);
  return slip;
}

void Response::ScaleBySlipForce(std::size_t r, std::span<const double> theta,
                                std::span<double> response, const ResponseColumns& columns) const {
  const ScaledRecord& record = problem_->data->records[r];
  const auto value = [&](TermId id) { return theta[RowOf(id)]; };
  const Slip slip = SlipOf(record, theta);
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
      t * value(TermId::kSlipSpeed) * slip.log_speed * (1 + slip.change));
  if (!Has(TermId::kDragFraction)) {
    t *= slip.factor;
    return;
  }
  // (v/v₀)^m along the motion, which has no memory.
  const Eigen::ArrayXd dragged =
      ArrayOf(record.velocity) *
      (value(TermId::kDragExponent) * slip.log_speed - ArrayOf(record.log_speed)).exp();
  const double drag = value(TermId::kDragFraction);
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
      const std::vector<double> direction = DirectionsOf(record.displacement, record.reversals);
      return ((is_up ? 1.0 : -1.0) * ArrayOf(direction) > 0).select(wave, 0.0);
    }
    default:
      return Eigen::ArrayXd::Ones(position.size());  // an offset
  }
}

bool IsInRecord(const Parameter& parameter, std::size_t record) {
  return !parameter.absent &&
         (parameter.term->scope == Scope::kContact || parameter.record == record);
}

/// True if t depends on a parameter by a derivative of its own.
bool EntersResponse(const Problem& problem, std::size_t parameter) {
  const Parameter& of = problem.parameters[parameter];
  return !of.absent && !of.term->is_linear && !ShapesColumns(problem, parameter);
}

}  // namespace

void AddColumn(const Problem& problem, std::size_t parameter, std::size_t r,
               std::span<const double> theta, double factor, std::span<double> to) {
  const Parameter& of = problem.parameters[parameter];
  if (!IsInRecord(of, r)) return;
  Array(to.data(), std::ssize(to)) +=
      factor * ColumnOf(problem, parameter, r, theta, /*derivative=*/false);
}

void AddDerivativeOfColumns(const Problem& problem, std::size_t parameter, std::size_t r,
                            std::span<const double> theta, std::span<double> to) {
  const Term& term = *problem.parameters[parameter].term;
  if (term.is_linear) AddColumn(problem, parameter, r, theta, 1.0, to);
  if (term.shapes.empty()) return;
  for (std::size_t q = 0; q < problem.parameters.size(); ++q) {
    const Term& linear = *problem.parameters[q].term;
    const bool is_shaped = linear.is_linear && linear.name.starts_with(term.shapes);
    if (!is_shaped || !IsInRecord(problem.parameters[q], r)) continue;
    Array(to.data(), std::ssize(to)) +=
        theta[q] * ColumnOf(problem, q, r, theta, /*derivative=*/true);
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
  response.Evaluate(theta, predicted);
  Complete(problem, theta, predicted);
}

void DifferentiateResponse(const Problem& problem, std::span<const double> theta,
                           Response& response, std::span<const std::size_t> parameters,
                           std::span<double> t, std::span<double> columns) {
  const std::size_t samples = problem.size();
  const bool is_forced = problem.data->is_forced();
  // t depends on σ/Tc and Tc/k, or of an imposed force on 1/Tc; the scale is Tc, or Tc/σ. Each
  // derivative of t is computed once, for however many parameters.
  std::vector<TermId> wanted;
  for (const std::size_t p : parameters) {
    const TermId id = problem.parameters[p].term->id;
    const bool is_by_rate = id == TermId::kSlipForce || id == TermId::kLoadExponent;
    if (is_by_rate) wanted.push_back(TermId::kSigma);
    if (id == TermId::kSlipForce && problem.parameters.has_rig()) {
      wanted.push_back(TermId::kRigStiffness);
    }
    if (!is_by_rate && EntersResponse(problem, p)) wanted.push_back(id);
  }
  std::ranges::sort(wanted);
  wanted.erase(std::ranges::unique(wanted).begin(), wanted.end());
  const std::span<double> scratch = response.Scratch(wanted.size() * samples);
  ResponseColumns gradient;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    gradient[wanted[k]] = scratch.subspan(k * samples, samples);
  }
  response.Differentiate(theta, t, gradient);
  std::ranges::fill(columns, 0.0);
  std::size_t begin = 0;
  for (const std::size_t p : parameters) {
    const Parameter& parameter = problem.parameters[p];
    std::size_t end = 0;
    for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
      const ScaledRecord& record = problem.data->records[r];
      const std::size_t first = std::exchange(end, end + record.size());
      if (!IsInRecord(parameter, r)) continue;
      const auto of = [&](TermId id) {
        return ArrayOf(gradient[id].subspan(first, record.size()));
      };
      const ConstArray own = ArrayOf(t.subspan(first, record.size()));
      Array column(columns.data() + begin + first, own.size());
      switch (parameter.term->id) {
        case TermId::kSigma:
          if (is_forced) {
            column = -own;
          } else {
            column = of(TermId::kSigma);
          }
          break;
        case TermId::kSlipForce:
          column = own - of(TermId::kSigma);
          if (problem.parameters.has_rig()) column += of(TermId::kRigStiffness);
          break;
        case TermId::kRigStiffness:
          column = -of(TermId::kRigStiffness);
          break;
        case TermId::kLoadExponent:
          column = record.log_load * of(TermId::kSigma);
          break;
        default:
          if (EntersResponse(problem, p)) column = of(parameter.term->id);
      }
    }
    begin += samples;
  }
}

void Differentiate(const Problem& problem, std::span<const double> theta, Response& response,
                   std::span<const std::size_t> columns, std::span<double> residual,
                   std::span<double> jacobian) {
  // `residual` is t until the rest is added, and what is measured taken off.
  DifferentiateResponse(problem, theta, response, columns, residual, jacobian);
  const double scale = std::exp(LogScaleAt(problem, theta));
  for (double& value : jacobian) value *= scale;
  std::size_t k = 0;
  for (const std::size_t p : columns) {
    for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
      const ScaledRecord& record = problem.data->records[r];
      const std::span<double> column = jacobian.subspan(k, record.size());
      k += record.size();
      AddDerivativeOfColumns(problem, p, r, theta, column);
      for (std::size_t i = 0; i < column.size(); ++i) column[i] *= record.root_weight[i];
    }
  }
  Complete(problem, theta, residual);
  TakeOffMeasured(*problem.data, residual);
  k = 0;
  for (const ScaledRecord& record : problem.data->records) {
    for (const double weight : record.root_weight) residual[k++] *= weight;
  }
}

void EvaluateResidual(const Problem& problem, std::span<const double> theta, Response& response,
                      std::span<double> residual) {
  response.Bind(problem);
  Differentiate(problem, theta, response, {}, residual, {});
}

}  // namespace mindahl::identification
