#include "identification/problem/problem.h"

#include <algorithm>
#include <cmath>
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
Array ArrayOf(std::span<double> values) { return {values.data(), std::ssize(values)}; }

/// The law over the slip force of one record, under its mean load: σ/Tc ∝ N^{p−1}, Tc/k ∝ N.
models::NormalizedLaw LawUnder(const Problem& problem, std::span<const double> theta,
                               const ScaledRecord& record) {
  const double exponent = problem.parameters.LoadExponentAt(theta);
  const double log_load = std::log(record.load);
  const double log_travel = theta[kSlipForce] - theta[kRig] + log_load;
  return {.rate = std::exp(theta[kStiffness] - theta[kSlipForce] + (exponent - 1) * log_load),
          .shape_exponent = theta[kShape],
          .spring_travel = problem.parameters.has_rig() ? std::exp(log_travel) : 0.0};
}

/// Puts the force in the place of the state z, and its derivatives in the place of those of z.
void ReadForceOfJoint(const ScaledRecord& record, double asymmetry, std::span<double> t,
                      const ResponseColumns& columns) {
  const std::span<double> by_asymmetry = columns[TermId::kAsymmetry];
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double load = record.load_ratio.empty() ? 1.0 : record.load_ratio[i];
    const double slope = models::JointForceSlope(t[i], load, asymmetry);
    for (const std::span<double> column : columns) {
      if (!column.empty()) column[i] *= slope;
    }
    if (!by_asymmetry.empty()) by_asymmetry[i] = load * t[i] * t[i];
    t[i] = models::JointForce(t[i], load, asymmetry);
  }
}

/// Returns the column of a linear parameter in a record, or its derivative (Term::shapes).
Eigen::ArrayXd ColumnOf(const Problem& problem, std::size_t parameter, const ScaledRecord& record,
                        std::span<const double> theta, bool derivative) {
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
      const bool is_sine = id == TermId::kRippleSineUp || id == TermId::kRippleSineDown;
      const bool is_up = id == TermId::kRippleCosineUp || id == TermId::kRippleSineUp;
      const Eigen::ArrayXd wave = (rate * (position + shift)).unaryExpr([&](double phase) {
        if (!derivative) return is_sine ? std::sin(phase) : std::cos(phase);
        return phase * (is_sine ? -std::cos(phase) : std::sin(phase));
      });
      const std::vector<double> direction = DirectionsOf(record);
      return ((is_up ? 1.0 : -1.0) * ArrayOf(direction) > 0).select(wave, 0.0);
    }
    default:
      return Eigen::ArrayXd::Ones(position.size());  // an offset
  }
}

bool IsInRecord(const Parameter& parameter, std::size_t record) {
  return !parameter.absent && (!parameter.term->is_of_record || parameter.record == record);
}

/// t, in the place of one of its derivatives.
constexpr TermId kItself = TermId::kSlipForce;

/// Returns the derivative of scale·t over the scale by a parameter, as multiples of t and of
/// derivatives of t, which depends on σ/Tc and Tc/k, or of an imposed force on 1/Tc; the scale is
/// Tc, or Tc/σ.
std::vector<std::pair<TermId, double>> ChainRuleOf(const Problem& problem,
                                                   const Parameter& parameter,
                                                   const ScaledRecord& record) {
  const TermId id = parameter.term->id;
  switch (id) {
    case TermId::kSigma:
      return {problem.data->is_forced() ? std::pair(kItself, -1.0) : std::pair(id, 1.0)};
    case TermId::kSlipForce:
      if (!problem.parameters.has_rig()) return {{kItself, 1}, {TermId::kSigma, -1}};
      return {{kItself, 1}, {TermId::kSigma, -1}, {TermId::kRigStiffness, 1}};
    case TermId::kRigStiffness:
      return {{id, -1}};
    case TermId::kLoadExponent:
      return {{TermId::kSigma, std::log(record.load)}};
    default:
      if (parameter.term->is_linear || !parameter.term->shapes.empty()) return {};
      return {{id, 1}};
  }
}

}  // namespace

double LogScaleAt(const Problem& problem, std::span<const double> theta) {
  return theta[kSlipForce] - (problem.data->is_forced() ? theta[kStiffness] : 0.0);
}

ResponseColumns ResponseColumns::Of(const ScaledRecord& record) const {
  ResponseColumns part;
  std::ranges::transform(*this, part.begin(), [&](std::span<double> column) {
    return column.empty() ? column : record.Of(column);
  });
  return part;
}

Response::Response(const Problem& problem)
    : problem_(problem), moves_(problem.parameters.PositionOfMotion()) {
  const std::vector<ScaledRecord>& records = problem.data->records;
  motions_.resize(records.size());
  for (const ScaledRecord& record : records) {
    turns_.push_back(TurnsOf(Has(TermId::kLag) ? record.motion() : record));
    models::LoadedHistory& history = histories_.emplace_back();
    if (record.load_ratio.empty() || !problem.is_masing()) continue;
    history = models::MakeLoadedHistory(record.displacement, record.load_ratio, record.reversals,
                                        problem.initial_state);
  }
}

const Motion& Response::MotionOf(std::size_t r, std::span<const double> theta) {
  const ScaledRecord& record = problem_.data->records[r];
  const Parameters& parameters = problem_.parameters;
  const models::InitialContact initial = {
      .state = problem_.initial_state,
      .unloaded_displacement = problem_.is_virgin() ? theta[parameters.PositionOfOrigin(r)] : 0.0,
      .turns_at_first = record.begins_at_turn,
      .asymmetry = problem_.is_masing() ? theta[kAsymmetry] : 0.0};
  std::optional<TermId> moved_by;
  double amount = 0.0;
  if (moves_ < parameters.size()) {
    const Parameter& moves = parameters[moves_];
    moved_by = moves.term->id;
    amount = moves.ToValue(theta[moves_]) /
             (moved_by == TermId::kLag ? record.units.half_duration : record.units.length);
  }
  Motion& motion = motions_[r];
  const bool is_there = !motion.paths.empty() && motion.amount == amount &&
                        motion.initial.unloaded_displacement == initial.unloaded_displacement &&
                        motion.initial.asymmetry == initial.asymmetry;
  if (is_there) return motion;
  Locate(record, turns_[r], moved_by, amount, problem_.model->memory, initial, motion);
  return motion;
}

models::NormalizedGradient Response::GradientOf(const ResponseColumns& columns) const {
  return {columns[TermId::kSigma], columns[TermId::kAlpha], columns[TermId::kDisplacementOffset],
          columns[TermId::kRigStiffness],
          problem_.is_masing() ? columns[TermId::kAsymmetry] : std::span<double>()};
}

void Response::EvaluatePath(std::span<const double> theta, std::size_t r, std::span<double> t,
                            const ResponseColumns& columns) {
  const ScaledRecord& record = problem_.data->records[r];
  const models::NormalizedLaw law = LawUnder(problem_, theta, record);
  if (!record.load_ratio.empty() && problem_.is_masing()) {
    models::EvaluateNormalizedForce(
        law, histories_[r], theta[problem_.parameters.PositionOfOrigin(r)], t, GradientOf(columns));
    return;
  }
  const Motion& motion = MotionOf(r, theta);
  const auto& [moved, path] = motion.paths.front();
  if (record.imposed == loop::Channel::kForce) {
    const bool is_below_slip = models::EvaluateNormalizedDisplacement(
        *problem_.model, {std::exp(theta[kSlipForce]), theta[kShape]}, path, record.force, t,
        {columns[TermId::kSigma], columns[TermId::kAlpha], columns[TermId::kForceOffset]});
    if (!is_below_slip) std::ranges::fill(t, std::numeric_limits<double>::quiet_NaN());
  } else if (motion.paths.size() > 1) {
    EvaluateBehindGap(law, motion, t, GradientOf(columns));
  } else {
    models::EvaluateNormalizedForce(*problem_.model, law, path,
                                    moved.empty() ? record.displacement : moved, t,
                                    GradientOf(columns));
  }
  if (moves_ >= problem_.parameters.size()) return;
  const std::span<double> by_amount = columns[problem_.parameters[moves_].term->id];
  if (by_amount.empty()) return;
  // The difference is one-sided, towards a longer lag or a wider gap: at zero the response has a
  // kink.
  constexpr double kStep = 1e-7;  // by which the difference is rounded to 1e-9 of the slip force
  std::vector<double> beside(theta.begin(), theta.end());
  beside[moves_] += kStep;
  EvaluatePath(beside, r, by_amount, {});
  for (std::size_t i = 0; i < t.size(); ++i) by_amount[i] = (by_amount[i] - t[i]) / kStep;
}

void Response::EvaluateBehindGap(const models::NormalizedLaw& law, const Motion& motion,
                                 std::span<double> t, const models::NormalizedGradient& gradient) {
  Eigen::MatrixXd storage = Eigen::MatrixXd::Zero(std::ssize(t), models::kParameters + 1);
  const std::span<double> forces = SpanOf(storage.col(models::kParameters));
  models::NormalizedGradient of_side;
  std::ranges::fill(t, 0.0);  // while the gap is crossed
  for (std::size_t k = 0; k < gradient.size(); ++k) {
    std::ranges::fill(gradient[k], 0.0);
    if (!gradient[k].empty()) of_side[k] = SpanOf(storage.col(static_cast<Eigen::Index>(k)));
  }
  for (const double sign : {-1.0, 1.0}) {
    const auto& [displacement, path] = motion.paths[sign > 0 ? 0 : 1];
    models::EvaluateNormalizedForce(*problem_.model, law, path, displacement, forces, of_side);
    for (std::size_t i = 0; i < t.size(); ++i) {
      if (!(sign * forces[i] >= 0)) continue;
      t[i] = forces[i];
      for (std::size_t k = 0; k < gradient.size(); ++k) {
        if (!gradient[k].empty()) gradient[k][i] = of_side[k][i];
      }
    }
  }
}

void Response::Evaluate(std::span<const double> theta, std::span<double> t,
                        const ResponseColumns& columns) {
  AskWhetherToGoOn();
  for (std::size_t r = 0; r < problem_.data->records.size(); ++r) {
    const ScaledRecord& record = problem_.data->records[r];
    const ResponseColumns parts = columns.Of(record);
    const std::span<double> values = record.Of(t);
    EvaluatePath(theta, r, values, parts);
    if (!problem_.is_masing() && (!record.load_ratio.empty() || Has(TermId::kAsymmetry))) {
      ReadForceOfJoint(record, theta[kAsymmetry], values, parts);
    }
    ScaleBySlipForce(record, theta, values, parts);
    if (record.load == 1) continue;
    ArrayOf(values) *= record.load;
    for (const std::span<double> column : parts) ArrayOf(column) *= record.load;
  }
}

void Response::ScaleBySlipForce(const ScaledRecord& record, std::span<const double> theta,
                                std::span<double> response, const ResponseColumns& columns) const {
  constexpr std::array kTerms = {TermId::kSlipSlope, TermId::kSlipCurvature, TermId::kSlipSpeed,
                                 TermId::kSlipTrend, TermId::kDragFraction};
  if (std::ranges::none_of(kTerms, [this](TermId id) { return Has(id); })) return;
  const auto value = [&](TermId id) { return theta[RowOf(id)]; };
  const ConstArray position = ArrayOf(record.displacement);
  // ln(v/v₀), far below zero and finite where nothing moves, and (v/v₀)^m − 1
  Eigen::ArrayXd log_speed = Eigen::ArrayXd::Zero(position.size());
  if (!record.log_speed.empty()) {
    log_speed = ArrayOf(record.log_speed) - std::log(record.units.reference_speed);
  }
  const double exponent = value(TermId::kSlipSpeedExponent);
  const Eigen::ArrayXd change =
      log_speed.unaryExpr([&](double x) { return std::expm1(exponent * x); });
  const Eigen::ArrayXd factor =
      1 +
      (position * (value(TermId::kSlipSlope) + value(TermId::kSlipCurvature) * position) +
       value(TermId::kSlipTrend) * ArrayOf(record.time)) +
      value(TermId::kSlipSpeed) * change - value(TermId::kDragFraction);
  Array t = ArrayOf(response);
  for (const std::span<double> column : columns) ArrayOf(column) *= factor.head(std::ssize(column));
  const auto set = [&](TermId id, const auto& derivative) {
    if (!columns[id].empty()) ArrayOf(columns[id]) = derivative;
  };
  set(TermId::kSlipSlope, t * position);
  set(TermId::kSlipCurvature, t * position * position);
  set(TermId::kSlipTrend, t * ArrayOf(record.time));
  set(TermId::kSlipSpeed, t * change);
  set(TermId::kSlipSpeedExponent, t * value(TermId::kSlipSpeed) * log_speed * (1 + change));
  if (!Has(TermId::kDragFraction)) {
    t *= factor;
    return;
  }
  // (v/v₀)^m along the motion, which has no memory.
  const Eigen::ArrayXd dragged =
      ArrayOf(record.velocity) *
      (value(TermId::kDragExponent) * log_speed - ArrayOf(record.log_speed)).exp();
  const double drag = value(TermId::kDragFraction);
  set(TermId::kDragFraction, dragged - t);
  set(TermId::kDragExponent, drag * dragged * log_speed);
  t = factor * t + drag * dragged;
}

void AddColumn(const Problem& problem, std::size_t parameter, std::span<const double> theta,
               double factor, Eigen::Ref<Eigen::VectorXd> to, bool derivative) {
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const ScaledRecord& record = problem.data->records[r];
    if (!IsInRecord(problem.parameters[parameter], r)) continue;
    ArrayOf(record.Of(SpanOf(to))) +=
        factor * ColumnOf(problem, parameter, record, theta, derivative);
  }
}

void AddLinearTerms(const Problem& problem, std::span<const double> theta, double factor,
                    Eigen::VectorXd& to) {
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    if (!problem.parameters[p].term->is_linear || theta[p] == 0) continue;
    AddColumn(problem, p, theta, factor * theta[p], to);
  }
}

void AddDerivativesOfColumns(const Problem& problem, std::span<const std::size_t> parameters,
                             std::span<const double> theta, Eigen::MatrixXd& columns) {
  for (Eigen::Index k = 0; const std::size_t p : parameters) {
    const Term& term = *problem.parameters[p].term;
    const auto column = columns.col(k++);
    if (term.is_linear) AddColumn(problem, p, theta, 1.0, column);
    for (std::size_t q = 0; !term.shapes.empty() && q < problem.parameters.size(); ++q) {
      const Term& linear = *problem.parameters[q].term;
      if (!linear.is_linear || !linear.name.starts_with(term.shapes)) continue;
      AddColumn(problem, q, theta, theta[q], column, /*derivative=*/true);
    }
  }
}

Eigen::VectorXd Predict(const Problem& problem, std::span<const double> theta) {
  Eigen::VectorXd predicted(static_cast<Eigen::Index>(problem.size()));
  Response(problem).Evaluate(theta, SpanOf(predicted));
  predicted *= std::exp(LogScaleAt(problem, theta));
  AddLinearTerms(problem, theta, 1.0, predicted);
  return predicted;
}

void Response::Differentiate(std::span<const double> theta, std::span<const std::size_t> parameters,
                             Eigen::VectorXd& t, Eigen::MatrixXd& columns) {
  // Each derivative of t is computed once, for however many parameters.
  ResponseColumns gradient;
  for (const std::size_t p : parameters) {
    const ScaledRecord& any = problem_.data->records.front();
    for (const auto& [id, factor] : ChainRuleOf(problem_, problem_.parameters[p], any)) {
      if (id == kItself) continue;
      derivatives_[id].resize(t.size());
      gradient[id] = SpanOf(derivatives_[id]);
    }
  }
  Evaluate(theta, SpanOf(t), gradient);
  gradient[kItself] = SpanOf(t);
  columns.setZero(t.size(), std::ssize(parameters));
  for (Eigen::Index k = 0; const std::size_t p : parameters) {
    const Parameter& parameter = problem_.parameters[p];
    const std::span<double> column = SpanOf(columns.col(k++));
    for (std::size_t r = 0; r < problem_.data->records.size(); ++r) {
      const ScaledRecord& record = problem_.data->records[r];
      if (!IsInRecord(parameter, r)) continue;
      for (const auto& [id, factor] : ChainRuleOf(problem_, parameter, record)) {
        ArrayOf(record.Of(column)) += factor * ArrayOf(record.Of(gradient[id]));
      }
    }
  }
  columns *= std::exp(LogScaleAt(problem_, theta));
}

Linearization Response::LinearizeAt(std::span<const double> theta,
                                    std::span<const std::size_t> parameters) {
  Linearization at;
  at.residual.resize(static_cast<Eigen::Index>(problem_.size()));
  // The residual is t until the rest is added, and what is measured taken off.
  Differentiate(theta, parameters, at.residual, at.jacobian);
  AddDerivativesOfColumns(problem_, parameters, theta, at.jacobian);
  at.residual *= std::exp(LogScaleAt(problem_, theta));
  AddLinearTerms(problem_, theta, 1.0, at.residual);
  at.residual -= problem_.data->All(&ScaledRecord::response);
  const Eigen::ArrayXd weight = problem_.data->All(&ScaledRecord::root_weight);
  at.residual.array() *= weight;
  at.jacobian.array().colwise() *= weight;
  return at;
}

}  // namespace mindahl::identification
