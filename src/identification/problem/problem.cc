#include "identification/problem/problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <string_view>

#include "mindahl/core/interruption.h"
#include "mindahl/models/joint_friction.h"

namespace mindahl::identification {

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

namespace {

/// Parameters of the law and the path with a derivative of t of their own.
struct LawRow {
  TermId term;
  std::span<double> ResponseColumns::*column;
  double longest_step;
  bool step_grows_with_theta = false;
};
constexpr std::array kLawRows = {
    LawRow{TermId::kAlpha, &ResponseColumns::shape_exponent, 1.0, true},
    LawRow{TermId::kLag, &ResponseColumns::moved, 0.02},  // cycles
    LawRow{TermId::kBacklash, &ResponseColumns::moved, 0.1},
    LawRow{TermId::kAsymmetry, &ResponseColumns::asymmetry, 0.25},
    LawRow{TermId::kSlipSlope, &ResponseColumns::slip_slope, 0.25},
    LawRow{TermId::kSlipCurvature, &ResponseColumns::slip_curvature, 0.25},
    LawRow{TermId::kSlipSpeed, &ResponseColumns::slip_speed, 0.25},
    LawRow{TermId::kSlipSpeedExponent, &ResponseColumns::slip_speed_exponent, 0.25},
    LawRow{TermId::kSlipTrend, &ResponseColumns::slip_trend, 0.25},
    LawRow{TermId::kDragFraction, &ResponseColumns::drag_fraction, 0.25},
    LawRow{TermId::kDragExponent, &ResponseColumns::drag_exponent, 0.25},
};

}  // namespace

LawSensitivity SensitivityTo(const Problem& problem, std::size_t parameter) {
  const Term& term = *problem.parameters[parameter].term;
  const bool is_forced = problem.data->is_forced();
  const bool has_rig = problem.parameters.has_rig();
  LawSensitivity result;
  const auto add = [&](Sensitivity summand) { result.summands[result.count++] = summand; };
  // t depends on σ/Tc and Tc/k, or of an imposed force on 1/Tc; the scale is Tc, or Tc/σ.
  if (parameter == kStiffness) {
    if (is_forced) {
      add({.factor = -1.0});
    } else {
      add({.column = &ResponseColumns::log_rate});
    }
  } else if (parameter == kSlipForce) {
    add({});
    add({.column = &ResponseColumns::log_rate, .factor = -1.0});
    if (has_rig) add({.column = &ResponseColumns::log_spring_travel});
  } else if (parameter == kRig) {
    if (has_rig) add({.column = &ResponseColumns::log_spring_travel, .factor = -1.0});
  } else if (parameter == kLoadExponent) {
    add({.column = &ResponseColumns::log_rate, .by_log_load = true});
  } else if (term.id == OriginId(problem.data->excitation)) {
    add({.column = &ResponseColumns::unloaded});
    result.longest_step = 0.5;
  } else {
    const auto row = std::ranges::find(kLawRows, term.id, &LawRow::term);
    if (ShapesColumns(problem, parameter)) result.longest_step = 0.2;
    if (row == kLawRows.end()) return result;
    if (row->column == &ResponseColumns::moved && problem.parameters[parameter].absent)
      return result;
    add({.column = row->column});
    result.longest_step = row->longest_step;
    result.step_grows_with_theta = row->step_grows_with_theta;
  }
  return result;
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
         (!record.load_ratio.empty() || problem.parameters.has_asymmetry());
}

double LoadRatioAt(const ScaledRecord& record, std::size_t sample) {
  return record.load_ratio.empty() ? 1.0 : record.load_ratio[sample];
}

/// Puts the force in the place of the state z, and its derivatives in the place of those of z.
void ReadForceOfJoint(const ScaledRecord& record, double asymmetry, std::span<double> t,
                      const ResponseColumns& columns) {
  const std::array by_state = {columns.log_rate, columns.shape_exponent, columns.unloaded,
                               columns.moved};
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double load = LoadRatioAt(record, i);
    const double slope = models::JointForceSlope(t[i], load, asymmetry);
    for (const std::span<double> column : by_state) {
      if (!column.empty()) column[i] *= slope;
    }
    if (!columns.asymmetry.empty()) columns.asymmetry[i] = load * t[i] * t[i];
    t[i] = models::JointForce(t[i], load, asymmetry);
  }
}

}  // namespace

void Response::Bind(const Problem& problem) {
  problem_ = &problem;
  const std::size_t records = problem.data->records.size();
  if (paths_.size() < records) paths_.resize(records);
  for (CachedPath& cached : paths_) cached.valid = false;
  unloaded_.resize(records);
  for (std::size_t r = 0; r < records; ++r) {
    unloaded_[r] = problem.parameters.PositionOfOrigin(r);
  }
  if (problem.data->load_varies) histories_.resize(records);
  for (std::size_t r = 0; r < records; ++r) {
    const ScaledRecord& record = problem.data->records[r];
    if (record.load_ratio.empty() || !HasPathAsymmetry(problem)) continue;
    models::MakeLoadedHistory(record.displacement, record.load_ratio, record.reversals,
                              problem.state.Of(r), histories_[r]);
  }
  asymmetry_ = problem.parameters.PositionOf(TermId::kAsymmetry, 0);
  slip_slope_ = problem.parameters.PositionOf(TermId::kSlipSlope, 0);
  slip_curvature_ = problem.parameters.PositionOf(TermId::kSlipCurvature, 0);
  slip_speed_ = problem.parameters.PositionOf(TermId::kSlipSpeed, 0);
  slip_speed_exponent_ = problem.parameters.PositionOf(TermId::kSlipSpeedExponent, 0);
  slip_goes_by_speed_ = !problem.parameters[slip_speed_].absent;
  slip_trend_ = problem.parameters.PositionOf(TermId::kSlipTrend, 0);
  drag_fraction_ = problem.parameters.PositionOf(TermId::kDragFraction, 0);
  drag_exponent_ = problem.parameters.PositionOf(TermId::kDragExponent, 0);
  has_drag_ = !problem.parameters[drag_fraction_].absent;
  slip_varies_ = slip_goes_by_speed_ || has_drag_ || !problem.parameters[slip_slope_].absent ||
                 !problem.parameters[slip_curvature_].absent ||
                 !problem.parameters[slip_trend_].absent;
  moves_ = problem.parameters.PositionOfMotion();
  has_moved_ = problem.parameters.moves_contact();
  motions_.clear();
  for (std::size_t r = 0; has_moved_ && r < records; ++r) {
    motions_.push_back(MakeMovedSamples(problem.parameters[moves_].term->motion));
  }
}

models::InitialContact Response::InitialOf(std::size_t r, std::span<const double> theta) const {
  const models::InitialState state = problem_->state.Of(r);
  const bool virgin = state == models::InitialState::kVirgin;
  return {.state = state,
          .unloaded_displacement = virgin ? theta[unloaded_[r]] : 0.0,
          .asymmetry = HasPathAsymmetry(*problem_) ? theta[asymmetry_] : 0.0};
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
  const std::span<double> t = PlacesOf(moved, 0);
  response_.Evaluate(*problem_->model, LawUnder(*problem_, at, problem_->data->records[r]),
                     moved.path(), moved.displacement(), t);
  moved.TakeForces(t);
  return moved;
}

std::span<double> Response::PlacesOf(const MovedSamples& moved, std::size_t column) {
  const std::size_t size = moved.displacement().size();
  if (moved_.size() < (column + 1) * size) moved_.resize((column + 1) * size);
  return std::span(moved_).subspan(column * size, size);
}

const models::LoadingPath& Response::PathOf(std::size_t r, std::span<const double> theta) {
  CachedPath& cached = paths_[r];
  if (has_moved_) {
    MovedUnderForces(PointAt(*problem_, theta), r).CopyPathOfSamples(cached.path);
    return cached.path;
  }
  const models::InitialContact initial = InitialOf(r, theta);
  if (!cached.valid || initial.unloaded_displacement != cached.unloaded ||
      initial.asymmetry != cached.asymmetry) {
    const ScaledRecord& record = problem_->data->records[r];
    models::MakeLoadingPath(record.excitation(), record.reversals, problem_->model->memory, initial,
                            cached.path);
    cached.unloaded = initial.unloaded_displacement;
    cached.asymmetry = initial.asymmetry;
    cached.valid = true;
  }
  return cached.path;
}

void Response::Evaluate(const LawPoint& at, std::span<double> t) { Differentiate(at, t, {}); }

/// Scales the derivatives by a branch's start with the slip force at each sample.
void Response::ScaleSensitivity(std::size_t r, const LawPoint& at,
                                models::OriginSensitivity& sensitivity) const {
  const ScaledRecord& record = problem_->data->records[r];
  for (std::size_t i = 0; i < record.size(); ++i) {
    const double factor = SlipFactor(record, at, i);
    sensitivity.sample_slope[i] *= factor;
    sensitivity.sample_gain[i] *= factor;
  }
}

void Response::DifferentiateByOrigins(const LawPoint& at, std::size_t r,
                                      models::OriginSensitivity& sensitivity) {
  const ScaledRecord& record = problem_->data->records[r];
  const models::NormalizedLaw law = LawUnder(*problem_, at, record);
  const auto scale = [&] {
    if (IsStateOfJoint(*problem_, record)) {
      std::vector<double> state(record.size());
      has_moved_ ? DifferentiateMoved(at, r, state, {}) : DifferentiateRecord(at, r, state, {});
      for (std::size_t i = 0; i < record.size(); ++i) {
        const double slope =
            models::JointForceSlope(state[i], LoadRatioAt(record, i), at.theta[asymmetry_]);
        sensitivity.sample_slope[i] *= slope;
        sensitivity.sample_gain[i] *= slope;
      }
    }
    if (slip_varies_) ScaleSensitivity(r, at, sensitivity);
  };
  if (has_moved_) {
    const MovedSamples& moved = MovedUnderForces(at, r);
    response_.DifferentiateByOrigins(*problem_->model, law, moved.path(), moved.displacement(),
                                     sensitivity);
    for (auto* column : {&sensitivity.sample_slope, &sensitivity.sample_gain}) {
      moved.Gather(*column, std::span(*column).first(record.size()));
      column->resize(record.size());
    }
    scale();
    return;
  }
  response_.DifferentiateByOrigins(*problem_->model, law, PathOf(r, at.theta), record.displacement,
                                   sensitivity);
  scale();
}

/// Differentiates the response of one record, over its own slip force.
void Response::DifferentiateRecord(const LawPoint& at, std::size_t r, std::span<double> t,
                                   const ResponseColumns& columns) {
  const ScaledRecord& record = problem_->data->records[r];
  if (record.imposed == loop::Channel::kForce) {
    DifferentiateForced(at, r, t, columns);
    return;
  }
  const models::NormalizedLaw law = LawUnder(*problem_, at, record);
  const models::NormalizedGradient gradient{
      .log_rate = columns.log_rate,
      .shape_exponent = columns.shape_exponent,
      .unloaded_displacement = columns.unloaded,
      .log_spring_travel = columns.log_spring_travel,
      .asymmetry = HasPathAsymmetry(*problem_) ? columns.asymmetry : std::span<double>()};
  if (!record.load_ratio.empty() && HasPathAsymmetry(*problem_)) {
    loaded_response_.Differentiate(law, histories_[r], at.theta[unloaded_[r]], t, gradient);
  } else {
    response_.Differentiate(*problem_->model, law, PathOf(r, at.theta), record.displacement, t,
                            gradient);
  }
}

/// Differentiates the response of one record whose force is imposed.
void Response::DifferentiateForced(const LawPoint& at, std::size_t r, std::span<double> t,
                                   const ResponseColumns& columns) {
  const models::ForcedLaw law{.slip_force = std::exp(-at.log_rate), .shape_exponent = at.shape};
  const bool is_below_slip = displacement_.Differentiate(*problem_->model, law, PathOf(r, at.theta),
                                                         problem_->data->records[r].excitation(), t,
                                                         {.log_slip_force = columns.log_rate,
                                                          .shape_exponent = columns.shape_exponent,
                                                          .unloaded_force = columns.unloaded});
  if (!is_below_slip) {
    std::ranges::fill(t, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  for (double& value : columns.log_rate) value = -value;
}

void Response::DifferentiateMoved(const LawPoint& at, std::size_t r, std::span<double> t,
                                  const ResponseColumns& columns) {
  const models::NormalizedLaw law = LawUnder(*problem_, at, problem_->data->records[r]);
  MovedSamples& moved = MovedOf(r, at.theta);
  const std::array wanted = {columns.log_rate, columns.shape_exponent, columns.unloaded,
                             columns.log_spring_travel,
                             HasPathAsymmetry(*problem_) ? columns.asymmetry : std::span<double>()};
  PlacesOf(moved, wanted.size());  // all of them, before any is taken
  const std::span<double> forces = PlacesOf(moved, 0);
  const auto places_if_wanted = [&](std::size_t column) {
    return wanted[column].empty() ? std::span<double>() : PlacesOf(moved, 1 + column);
  };
  response_.Differentiate(*problem_->model, law, moved.path(), moved.displacement(), forces,
                          {.log_rate = places_if_wanted(0),
                           .shape_exponent = places_if_wanted(1),
                           .unloaded_displacement = places_if_wanted(2),
                           .log_spring_travel = places_if_wanted(3),
                           .asymmetry = places_if_wanted(4)});
  moved.TakeForces(forces);
  moved.Gather(forces, t);
  for (std::size_t column = 0; column < wanted.size(); ++column) {
    if (!wanted[column].empty()) moved.Gather(PlacesOf(moved, 1 + column), wanted[column]);
  }
  if (columns.moved.empty()) return;
  response_.DifferentiateByOrigins(*problem_->model, law, moved.path(), moved.displacement(),
                                   sensitivity_);
  moved.DifferentiateByAmount(sensitivity_, forces);
  moved.Gather(forces, columns.moved);
  const double per_theta = problem_->parameters[moves_].scale / UnitOfAmount(r);
  for (double& value : columns.moved) value *= per_theta;
}

void Response::Differentiate(const LawPoint& at, std::span<double> t,
                             const ResponseColumns& columns) {
  AskWhetherToGoOn();
  std::size_t begin = 0;
  for (std::size_t r = 0; r < problem_->data->records.size(); ++r) {
    const ScaledRecord& record = problem_->data->records[r];
    const std::size_t count = record.size();
    const auto part = [&](std::span<double> column) {
      return column.empty() ? column : column.subspan(begin, count);
    };
    ResponseColumns parts;
    for (const auto column : kResponseColumns) parts.*column = part(columns.*column);
    const std::span<double> values = part(t);
    if (has_moved_) {
      DifferentiateMoved(at, r, values, parts);
    } else {
      DifferentiateRecord(at, r, values, parts);
    }
    if (IsStateOfJoint(*problem_, record)) {
      ReadForceOfJoint(record, at.theta[asymmetry_], values, parts);
    }
    if (slip_varies_) ScaleBySlipForce(r, at, values, parts);
    if (record.load != 1) {
      for (double& value : values) value *= record.load;
      for (const auto column : kResponseColumns) {
        for (double& value : parts.*column) value *= record.load;
      }
    }
    begin += count;
  }
}

namespace {

/// ln(v/v₀) of a sample; far below zero, and finite, where it does not move.
double LogSpeedRatio(const ScaledRecord& record, std::size_t sample) {
  return record.log_speed[sample] - std::log(record.units.reference_speed);
}

}  // namespace

double Response::SlipFactor(const ScaledRecord& record, const LawPoint& at,
                            std::size_t sample) const {
  const double position = record.displacement[sample];
  double factor = 1 + position * (at.theta[slip_slope_] + at.theta[slip_curvature_] * position) +
                  at.theta[slip_trend_] * record.time[sample];
  if (slip_goes_by_speed_) {
    factor += at.theta[slip_speed_] *
              std::expm1(at.theta[slip_speed_exponent_] * LogSpeedRatio(record, sample));
  }
  if (has_drag_) factor -= at.theta[drag_fraction_];
  return factor;
}

void Response::ScaleBySlipForce(std::size_t r, const LawPoint& at, std::span<double> t,
                                const ResponseColumns& columns) const {
  const ScaledRecord& record = problem_->data->records[r];
  const double slope = at.theta[slip_slope_];
  const double curvature = at.theta[slip_curvature_];
  const double of_speed = at.theta[slip_speed_];
  const double exponent = at.theta[slip_speed_exponent_];
  const double trend = at.theta[slip_trend_];
  const double drag = has_drag_ ? at.theta[drag_fraction_] : 0.0;
  const double log_reference = std::log(record.units.reference_speed);
  const std::array scaled = {t,
                             columns.log_rate,
                             columns.shape_exponent,
                             columns.unloaded,
                             columns.log_spring_travel,
                             columns.moved,
                             columns.asymmetry};
  for (std::size_t i = 0; i < t.size(); ++i) {
    const double position = record.displacement[i];
    double factor = 1 + position * (slope + curvature * position) + trend * record.time[i];
    if (!columns.slip_slope.empty()) columns.slip_slope[i] = t[i] * position;
    if (!columns.slip_curvature.empty()) columns.slip_curvature[i] = t[i] * position * position;
    if (!columns.slip_trend.empty()) columns.slip_trend[i] = t[i] * record.time[i];
    if (slip_goes_by_speed_) {
      const double log_ratio = record.log_speed[i] - log_reference;
      const double change = std::expm1(exponent * log_ratio);
      factor += of_speed * change;
      if (!columns.slip_speed.empty()) columns.slip_speed[i] = t[i] * change;
      if (!columns.slip_speed_exponent.empty()) {
        columns.slip_speed_exponent[i] = t[i] * of_speed * log_ratio * (1 + change);
      }
    }
    double dragged = 0.0;
    if (has_drag_) {
      // (v/v₀)^m along the motion, which has no memory.
      const double log_ratio = record.log_speed[i] - log_reference;
      const double direction = record.velocity[i] * std::exp(-record.log_speed[i]);
      dragged = direction * std::exp(at.theta[drag_exponent_] * log_ratio);
      if (!columns.drag_fraction.empty()) columns.drag_fraction[i] = dragged - t[i];
      if (!columns.drag_exponent.empty()) columns.drag_exponent[i] = drag * dragged * log_ratio;
      factor -= drag;
    }
    for (const std::span<double> column : scaled) {
      if (!column.empty()) column[i] *= factor;
    }
    t[i] += drag * dragged;
  }
}

namespace {

/// The power of the speed in units of the data, so that C keeps the unit of a viscous force:
///   φ(v) = v·(((v² + v_ε²)u²)^((m−1)/2),  u the unit of v [m/s], v_ε its resolution
/// which is v for m = 1, C·sgn(v)|v|^m far above the resolution, and smooth below it.
struct SpeedPower {
  double exponent = 1.0;
  double log_unit = 0.0;
  const ScaledRecord& record;

  /// ln of the speed [m/s].
  [[nodiscard]] double LogSpeed(std::size_t sample) const {
    return record.log_speed[sample] + log_unit;
  }
  [[nodiscard]] double At(std::size_t sample) const {
    const double velocity = record.velocity[sample];
    return exponent == 1 ? velocity : velocity * std::exp((exponent - 1) * LogSpeed(sample));
  }
  /// ∂φ/∂m
  [[nodiscard]] double Derivative(std::size_t sample) const {
    return At(sample) * LogSpeed(sample);
  }
};

SpeedPower SpeedPowerOf(const Problem& problem, const ScaledRecord& record,
                        std::span<const double> theta) {
  const std::size_t p = problem.parameters.PositionOf(TermId::kSpeedExponent, 0);
  const bool is_there = p < problem.parameters.size() && !problem.parameters[p].absent;
  return {.exponent = is_there ? theta[p] : 1.0,
          .log_unit = std::log(record.units.speed),
          .record = record};
}

/// cos or sin of 2πδ/λ in the strokes of one direction, and its derivative by ln λ.
struct Ripple {
  bool is_sine = false;
  double direction = 1.0;
  double rate = 0.0;   // 2π/λ
  double shift = 0.0;  // of the record's middle from that of the first

  [[nodiscard]] double At(double position) const {
    const double phase = rate * (position + shift);
    return is_sine ? std::sin(phase) : std::cos(phase);
  }
  [[nodiscard]] double Derivative(double position) const {
    const double phase = rate * (position + shift);
    return phase * (is_sine ? -std::cos(phase) : std::sin(phase));
  }
};

Ripple RippleOf(const Problem& problem, const ScaledRecord& record, Regressor column,
                std::span<const double> theta) {
  const TermUnits& first = problem.data->records.front().units;
  const bool is_up = column == Regressor::kRippleCosineUp || column == Regressor::kRippleSineUp;
  const std::size_t period = problem.parameters.PositionOf(TermId::kRipplePeriod, 0);
  return {
      .is_sine = column == Regressor::kRippleSineUp || column == Regressor::kRippleSineDown,
      .direction = is_up ? 1.0 : -1.0,
      .rate = 2 * std::numbers::pi * std::exp(-theta[period]),
      .shift = (record.units.displacement_reference - first.displacement_reference) / first.length};
}

bool IsRipple(Regressor column) {
  return column == Regressor::kRippleCosineUp || column == Regressor::kRippleSineUp ||
         column == Regressor::kRippleCosineDown || column == Regressor::kRippleSineDown;
}

}  // namespace

void AddColumn(const Problem& problem, std::size_t parameter, std::size_t r,
               std::span<const double> theta, double factor, std::span<double> to) {
  const Parameter& linear = problem.parameters[parameter];
  if (linear.absent || (linear.term->scope == Scope::kRecord && linear.record != r)) return;
  const ScaledRecord& record = problem.data->records[r];
  const Regressor kind = linear.term->column;
  if (kind == Regressor::kOne) {
    for (double& value : to) value += factor;
  } else if (kind == Regressor::kDisplacementSquared) {
    for (std::size_t i = 0; i < to.size(); ++i) {
      to[i] += factor * record.displacement[i] * record.displacement[i];
    }
  } else if (IsRipple(kind)) {
    const Ripple ripple = RippleOf(problem, record, kind, theta);
    for (std::size_t i = 0; i < to.size(); ++i) {
      if (record.direction[i] != ripple.direction) continue;
      to[i] += factor * ripple.At(record.displacement[i]);
    }
  } else if (kind == Regressor::kVelocity) {
    const SpeedPower power = SpeedPowerOf(problem, record, theta);
    for (std::size_t i = 0; i < record.velocity.size(); ++i) {
      to[i] += factor * power.At(i);
    }
  } else {
    const std::span<const double> column = record.ColumnOf(kind, linear.column);
    for (std::size_t i = 0; i < column.size(); ++i) to[i] += factor * column[i];
  }
}

bool ShapesColumns(const Problem& problem, std::size_t parameter) {
  return !problem.parameters[parameter].term->shapes.empty();
}

void AddDerivativeOfColumns(const Problem& problem, std::size_t parameter, std::size_t r,
                            std::span<const double> theta, double factor, std::span<double> to) {
  const std::string_view shaped = problem.parameters[parameter].term->shapes;
  const ScaledRecord& record = problem.data->records[r];
  for (std::size_t q = 0; q < problem.parameters.size(); ++q) {
    const Parameter& linear = problem.parameters[q];
    const Regressor kind = linear.term->column;
    const bool is_shaped = kind != Regressor::kNone && linear.term->name.starts_with(shaped);
    if (!is_shaped || linear.absent || theta[q] == 0) continue;
    const double size = factor * theta[q];
    if (IsRipple(kind)) {
      const Ripple ripple = RippleOf(problem, record, kind, theta);
      for (std::size_t i = 0; i < to.size(); ++i) {
        if (record.direction[i] != ripple.direction) continue;
        to[i] += size * ripple.Derivative(record.displacement[i]);
      }
    } else {
      const SpeedPower power = SpeedPowerOf(problem, record, theta);
      for (std::size_t i = 0; i < record.velocity.size(); ++i) {
        to[i] += size * power.Derivative(i);
      }
    }
  }
}

namespace {

/// Adds what is linear in its parameters to the scaled t.
void Complete(const Problem& problem, std::span<const double> theta, std::span<double> predicted) {
  const double scale = std::exp(LogScaleAt(problem, theta));
  for (double& value : predicted) value *= scale;
  for (std::size_t p = 0; p < problem.parameters.size(); ++p) {
    const Parameter& parameter = problem.parameters[p];
    if (parameter.term->column == Regressor::kNone || theta[p] == 0) continue;
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

void Differentiate(const Problem& problem, std::span<const double> theta, Response& response,
                   std::span<const std::size_t> columns, std::span<double> residual,
                   std::span<double> jacobian) {
  const std::size_t samples = problem.size();
  // Each derivative of t is computed once, for however many parameters.
  std::vector<LawSensitivity> sensitivities;
  std::vector<std::span<double> ResponseColumns::*> wanted;
  for (const std::size_t p : columns) {
    sensitivities.push_back(SensitivityTo(problem, p));
    for (const Sensitivity& summand : sensitivities.back().all()) {
      if (summand.column != nullptr && std::ranges::find(wanted, summand.column) == wanted.end()) {
        wanted.push_back(summand.column);
      }
    }
  }
  const std::span<double> scratch = response.Scratch(wanted.size() * samples);
  ResponseColumns gradient;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    gradient.*wanted[k] = scratch.subspan(k * samples, samples);
  }
  const std::span<double> t = residual;  // until the rest is added, and what is measured taken off
  response.Differentiate(PointAt(problem, theta), t, gradient);
  const double scale = std::exp(LogScaleAt(problem, theta));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t p = columns[c];
    const Parameter& parameter = problem.parameters[p];
    std::size_t k = 0;
    for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
      const ScaledRecord& record = problem.data->records[r];
      const std::span<double> column = jacobian.subspan(c * samples + k, record.size());
      const std::size_t begin = k;
      k += record.size();
      std::ranges::fill(column, 0.0);
      if (parameter.term->scope == Scope::kRecord && parameter.record != r) continue;
      if (parameter.term->column != Regressor::kNone) AddColumn(problem, p, r, theta, 1.0, column);
      if (ShapesColumns(problem, p)) AddDerivativeOfColumns(problem, p, r, theta, 1.0, column);
      for (const Sensitivity& summand : sensitivities[c].all()) {
        const std::span<const double> derivative =
            summand.column == nullptr ? t : gradient.*summand.column;
        const double factor =
            scale * summand.factor * (summand.by_log_load ? record.log_load : 1.0);
        for (std::size_t i = 0; i < column.size(); ++i) column[i] += factor * derivative[begin + i];
      }
      for (std::size_t i = 0; i < column.size(); ++i) column[i] *= record.root_weight[i];
    }
  }
  Complete(problem, theta, residual);
  TakeOffWeighted(*problem.data, residual);
}

}  // namespace mindahl::identification
