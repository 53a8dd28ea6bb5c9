#include "identification/problem/parameters.h"

#include <fmt/format.h>

#include <Eigen/QR>
#include <numbers>
#include <ranges>

#include "core/extremes.h"
#include "core/refuse.h"
#include "identification/problem/motion.h"

namespace mindahl::identification {

namespace {

/// Returns the period, in units of the displacement, with which the forces vary most over the
/// position: that of the largest peak of their spectra, one for each direction of all strokes, of
/// periods that fit twice into a stroke or oftener. Of each stroke its second half counts, of the
/// forces what a cubic over the position leaves.
double StartingPeriod(const ScaledRecords& data) {
  constexpr Eigen::Index kFrequencies = 391;  // a fifth of what a stroke resolves apart
  constexpr std::ptrdiff_t kFewest = 12;  // for a cubic and a wave to be distinguished from noise
  const Eigen::ArrayXd frequencies = Eigen::ArrayXd::LinSpaced(kFrequencies, 1.0, 40.0);
  Eigen::ArrayXd power = Eigen::ArrayXd::Zero(kFrequencies);
  for (const double direction : {1.0, -1.0}) {
    std::vector<double> sliding;  // positions …
    std::vector<double> there;    // … and forces
    for (const ScaledRecord& record : data.records) {
      const std::vector<double>& x = record.displacement;
      for (const Stroke& stroke : StrokesOf(record)) {
        const double middle = (x[stroke.begin] + x[stroke.end]) / 2;
        if (stroke.direction != direction) continue;
        for (std::size_t i = stroke.begin; i <= stroke.end; ++i) {
          if (record.counts[i] == 0 || direction * (x[i] - middle) < 0) continue;
          sliding.push_back(x[i]);
          there.push_back(record.force[i]);
        }
      }
    }
    const std::ptrdiff_t count = std::ssize(sliding);
    if (count < kFewest) continue;
    const Eigen::ArrayXd position = Eigen::ArrayXd::Map(sliding.data(), count);
    const Eigen::VectorXd forces = Eigen::VectorXd::Map(there.data(), count);
    Eigen::MatrixXd powers = Eigen::MatrixXd::Ones(position.size(), 4);
    for (int k = 1; k < 4; ++k) powers.col(k) = powers.col(k - 1).array() * position;
    const Eigen::ArrayXd force = forces - powers * powers.colPivHouseholderQr().solve(forces);
    for (Eigen::Index k = 0; k < kFrequencies; ++k) {
      const Eigen::ArrayXd phase = 2 * std::numbers::pi * frequencies[k] * position;
      const double cosine = (force * phase.cos()).sum();
      const double sine = (force * phase.sin()).sum();
      power[k] += (cosine * cosine + sine * sine) / static_cast<double>(count);
    }
  }
  Eigen::Index best = 0;
  power.maxCoeff(&best);
  return 1 / frequencies[best];
}

/// Squares and products of what is further from the unit of the data overflow or vanish.
void RequireNearUnit(const Parameter& parameter, std::string_view quantity, double value,
                     bool is_positive) {
  constexpr double kFarthest = 1e100;
  const double units = std::abs(value / parameter.scale);
  if (units <= kFarthest && (units >= 1 / kFarthest || !is_positive)) return;
  ThrowInvalid(quantity, value, "must be within a factor of 1e100 of what the records show");
}

/// Returns θ of a value from the user, which must be one that the model takes.
double ThetaOf(const Parameter& parameter, std::string_view name, double value) {
  const Term& term = *parameter.term;
  const std::string quantity = fmt::format("{} [{}]", name, term.unit);
  const auto require = term.positive || term.lowest > 0 ? RequirePositive
                       : term.lowest == 0               ? RequireNonNegative
                                                        : RequireFinite;
  require(quantity, value);
  if (term.id == TermId::kAsymmetry && !(std::abs(value) < 1)) {
    ThrowInvalid(quantity, value, "must be in (-1, 1)");
  }
  if (term.id == TermId::kBacklash && !(value < 2 * parameter.scale)) {
    ThrowInvalid(quantity, value, "must be below the range of the displacement");
  }
  RequireNearUnit(parameter, quantity, value, term.positive);
  return parameter.ToTheta(value);
}

void Hold(Parameter& parameter, double value) {
  parameter.theta = parameter.ToTheta(value);
  parameter.fixed = true;
}

/// A single loading curve looks the same from any reference position: where the contact is unloaded
/// must be said. It is the file's zero where the record begins at both zeros of its file; else the
/// first sample, where the force is then the offset's.
void HoldOrigin(const ScaledRecord& data, const FitOptions& options, Parameter& parameter) {
  if (data.BeginsAtZeros(options.thresholds)) {
    Hold(parameter, 0.0);
  } else if (!parameter.term->is_linear) {
    parameter.theta = data.excitation().front();
    parameter.fixed = parameter.assumed = true;
  }
}

Parameter MakeParameter(const Term& term, std::size_t record, const ScaledRecords& all,
                        const FitOptions& options) {
  const ScaledRecord& data = all.records[record];
  Parameter parameter{.term = &term, .record = record};
  parameter.scale = term.scale(data.units);
  parameter.reference = term.reference(data.units);
  parameter.lower = term.positive ? std::log(term.lowest) : term.lowest;
  parameter.upper = term.positive ? std::log(term.highest) : term.highest;
  if (term.id == TermId::kLag) {
    parameter.upper = LongestLag(data.size(), data.reversals.size());
    parameter.lower = -parameter.upper;
  }
  const bool is_asked_for = std::ranges::find(options.terms, term.name) != options.terms.end();
  const auto is = [&](Presence presence) { return term.presence == presence; };
  parameter.absent = is(Presence::kNever) || (is(Presence::kLoadSeries) && !all.is_load_series) ||
                     (is(Presence::kOnDemand) && !is_asked_for && !term.of_column);
  parameter.fixed = parameter.absent;
  if ((is(Presence::kOffsets) && !options.offsets) || (is(Presence::kReported) && !is_asked_for)) {
    Hold(parameter, 0.0);
  } else if (is(Presence::kOffsets) && !data.Turns()) {
    HoldOrigin(data, options, parameter);
  } else if (is(Presence::kOnDemand) && is_asked_for) {
    parameter.theta =
        term.id == TermId::kRipplePeriod ? std::log(StartingPeriod(all)) : term.start.value_or(0.0);
  }
  return parameter;
}

/// Refuses a term without the one or the time that it needs, and a second that moves the contact.
void RequireTerms(const ScaledRecords& data, const Parameters& parameters) {
  const bool is_timed = std::ranges::none_of(
      data.records, [](const ScaledRecord& record) { return record.velocity.empty(); });
  const std::size_t moving = parameters.PositionOfMotion();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const Term& term = *parameters[p].term;
    if (parameters[p].absent) continue;
    if (term.needs_time && !is_timed) {
      Refuse<InvalidArgument>("{} needs the time of every sample in every record", term.name);
    }
    if (!term.needs.empty() && parameters[parameters.PositionOf(FindTerm(term.needs)->id)].absent) {
      Refuse<InvalidArgument>("{} needs {}: add it", term.name, term.needs);
    }
    if (p > moving && MovesContact(term.id)) {
      Refuse<InvalidArgument>("{} and {} cannot be in one fit: leave one of them out",
                              parameters[moving].term->name, term.name);
    }
  }
}

/// Holds an asymmetry that is confounded with the force's offset: the contact had slipped before.
void HoldConfounded(Parameter& asymmetry, std::span<const Parameter> parameters) {
  const bool any_zero_is_known = std::ranges::any_of(parameters, [](const Parameter& parameter) {
    return parameter.term->id == TermId::kForceOffset && parameter.fixed;
  });
  if (asymmetry.fixed || any_zero_is_known) return;
  asymmetry.theta = 0.0;
  asymmetry.fixed = asymmetry.confounded = true;
}

/// Bounds α: under a load that varies slip must be complete at a finite displacement.
void KeepBelowOne(Parameter& shape) {
  constexpr double kHighest = 0.99;  // beyond it that exceeds a hundred times Tc/σ
  shape.upper = std::min(shape.upper, kHighest);
  const double lowest = shape.fixed ? shape.theta : shape.lower;
  if (lowest < shape.upper) return;
  ThrowInvalid("alpha [-]", lowest,
               "must be below 0.99 where the normal load varies, or keep to one load with --select "
               "load=LO:HI");
}

/// Bounds Tc, and begins with it: below the largest imposed force a steady contact has no loop.
void KeepAboveLoops(const ScaledRecords& data, Parameter& slip_force) {
  constexpr double kShortOfSlip = 1e-9;
  if (slip_force.fixed) return;
  for (const ScaledRecord& record : data.records) {
    const double least = std::log(ExtremesOf(record.excitation()).half_range()) + kShortOfSlip;
    if (!(least > slip_force.lower)) continue;
    slip_force.lower = std::min(least, slip_force.upper);
    slip_force.theta = std::max(slip_force.theta, slip_force.lower);
    slip_force.lower_is_of_theory = true;
  }
}

}  // namespace

void RequirePlace(const Term& term, loop::Channel response) {
  if (term.presence != Presence::kNever) return;
  const bool fits_force = response == loop::Channel::kForce;
  Refuse<InvalidArgument>("{} has no place in a fit of the {}: leave it out", term.name,
                          fits_force ? "force" : "displacement");
}

bool HasTerm(const FitOptions& options, std::string_view name) {
  return options.fixed.contains(std::string(name)) ||
         std::ranges::find(options.terms, name) != options.terms.end();
}

bool HasTerm(const FitOptions& options, TermId id) { return HasTerm(options, TermOf(id).name); }

BoundSide SideOf(const Parameter& parameter, double theta) {
  if (parameter.fixed) return BoundSide::kInside;
  constexpr double kAtBound = 1e-9;
  constexpr double kWide = 1e3;
  const double tolerance = kAtBound * std::clamp(parameter.upper - parameter.lower, 1.0, kWide);
  if (theta - parameter.lower <= tolerance) return BoundSide::kLower;
  if (parameter.upper - theta <= tolerance) return BoundSide::kUpper;
  return BoundSide::kInside;
}

bool IsSearchLimit(const Parameter& parameter, BoundSide side) {
  if (parameter.fixed || parameter.bounded_by_user || side == BoundSide::kInside) return false;
  const Term& term = *parameter.term;
  return side == BoundSide::kLower ? !term.lowest_is_of_theory && !parameter.lower_is_of_theory
                                   : !term.highest_is_of_theory;
}

Parameters::Parameters(const ScaledRecords& data, const FitOptions& options,
                       models::InitialState initial_state)
    : records_(data.records.size()),
      is_timed_(!data.records.front().velocity.empty()),
      excitation_(data.excitation) {
  const std::span<const Term> terms = Terms(loop::Other(data.excitation));
  const bool is_steady = initial_state == models::InitialState::kSteady;
  parameters_.reserve(terms.size() * records_ + options.covariates.size());
  for (std::size_t r = 0; r < records_; ++r) {
    for (const Term& term : terms) {  // the contact's first
      if (r > 0 && !term.is_of_record) continue;
      const std::size_t count = term.of_column ? options.covariates.size() : 1;
      for (std::size_t c = 0; c < count; ++c) {
        Parameter& parameter = parameters_.emplace_back(MakeParameter(term, r, data, options));
        // The centre of the loop.
        if (term.id == OriginId(excitation_) && is_steady) Hold(parameter, parameter.reference);
        if (!term.of_column) continue;
        parameter.column = c;
        parameter.covariate = data.covariates[c];
        parameter.scale /= parameter.covariate.scale;
      }
    }
  }
  if (options.model->shape_exponent) Hold(parameters_[kShape], *options.model->shape_exponent);
  const bool is_masing = options.model->memory == models::Memory::kReturnPoint;
  ApplyLimits(options, is_steady);
  if (is_masing && data.load_varies) KeepBelowOne(parameters_[kShape]);
  ApplyGuesses(options, data.prior_noise);
  if (data.is_forced() && is_steady) KeepAboveLoops(data, parameters_[kSlipForce]);
  RequireTerms(data, *this);
  if (is_masing && is_steady) HoldConfounded(parameters_[kAsymmetry], parameters_);
  Sort();
}

void Parameters::Sort() {
  free_.clear();
  reported_.clear();
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (!parameters_[i].fixed) free_.push_back(i);
    if (!parameters_[i].absent) reported_.push_back(i);
  }
}

std::size_t Parameters::PositionOf(TermId id, std::size_t record) const {
  const auto is_there = [&](const Parameter& parameter) {
    const Term& term = *parameter.term;
    return term.id == id && (!term.is_of_record || parameter.record == record);
  };
  return static_cast<std::size_t>(std::ranges::find_if(parameters_, is_there) -
                                  parameters_.begin());
}

std::size_t Parameters::PositionOfMotion() const {
  const auto moves = [](const Parameter& parameter) {
    return !parameter.absent && MovesContact(parameter.term->id);
  };
  return static_cast<std::size_t>(std::ranges::find_if(parameters_, moves) - parameters_.begin());
}

std::string Parameters::NameOf(std::size_t i) const {
  const Parameter& parameter = parameters_[i];
  if (parameter.term->of_column) return NameOfCovariate(parameter.covariate.name);
  const bool is_numbered = parameter.term->is_of_record && records_ > 1;
  return is_numbered ? fmt::format("{}_{}", parameter.term->name, parameter.record + 1)
                     : std::string(parameter.term->name);
}

std::string Parameters::UnitOf(std::size_t i) const {
  const Term& term = *parameters_[i].term;
  const std::string_view of_column = parameters_[i].covariate.unit;
  if (!of_column.empty()) return fmt::format("N/{}", of_column);
  return std::string(is_timed_ || term.unit_by_sample.empty() ? term.unit : term.unit_by_sample);
}

Parameter& Parameters::Find(std::string_view name, std::string_view what) {
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (NameOf(i) != name) continue;
    if (parameters_[i].absent && parameters_[i].term->presence == Presence::kLoadSeries) {
      Refuse<InvalidArgument>(
          "{} has no effect: the records are not under loads that are known and differ by more "
          "than 1 %; give --normal-load N1,N2,...",
          name);
    }
    RequirePlace(*parameters_[i].term, loop::Other(excitation_));
    return parameters_[i];
  }
  std::vector<std::string> names;
  for (std::size_t i = 0; i < parameters_.size(); ++i) {
    if (parameters_[i].term->presence != Presence::kNever) names.push_back(NameOf(i));
  }
  Refuse<InvalidArgument>("{} {}", what, UnknownAmong(name, names));
}

void Parameters::ApplyLimits(const FitOptions& options, bool is_steady) {
  for (const auto& [name, interval] : options.bounds) {
    Parameter& parameter = Find(name, "parameter with bounds");
    const auto& [from, to] = interval;
    const double open = parameter.term->positive ? parameter.lower : parameter.ToTheta(0.0);
    const double upper = ThetaOf(parameter, "bound of " + name, to);
    const double lower = from == 0.0 ? open : ThetaOf(parameter, "bound of " + name, from);
    if (!(from < to)) {
      Refuse<InvalidArgument>("bounds {}:{} of {} are invalid: the first must be smaller", from, to,
                              name);
    }
    parameter.lower = std::min(lower, upper);
    parameter.upper = std::max(lower, upper);
    parameter.bounded_by_user = true;
  }
  for (const auto& [name, value] : options.fixed) {
    Parameter& parameter = Find(name, "fixed parameter");
    parameter.theta = ThetaOf(parameter, "fixed " + name, value);
    if (name == "alpha" && options.model->shape_exponent &&
        *options.model->shape_exponent != value) {
      Refuse<InvalidArgument>(
          "alpha cannot be fixed at {}: the model '{}' prescribes alpha = {}; use mindlin-dahl",
          value, options.model->name, *options.model->shape_exponent);
    }
    if (parameter.term->id == OriginId(excitation_) && is_steady) {
      Refuse<InvalidArgument>(
          "{} cannot be fixed: that of a steady contact is the centre of its loop; fix "
          "it for a virgin contact",
          name);
    }
    parameter.fixed = true;
    parameter.absent = false;
  }
}

void Parameters::ApplyGuesses(const FitOptions& options, double prior_noise) {
  for (const auto& [name, prior] : options.priors) {
    Parameter& parameter = Find(name, "parameter with a prior");
    const double theta = ThetaOf(parameter, "prior of " + name, prior.value);
    const std::string uncertainty =
        fmt::format("standard uncertainty of {} [{}]", name, parameter.term->unit);
    RequirePositive(uncertainty, prior.standard_uncertainty);
    RequireNearUnit(parameter, uncertainty, prior.standard_uncertainty, true);
    if (parameter.absent || options.fixed.contains(name)) {
      Refuse<InvalidArgument>("a prior of {} has no effect: it is not fitted; leave it out", name);
    }
    if (parameter.fixed) continue;  // by the model, or in this initial state
    const double unit = parameter.term->positive ? prior.value : std::abs(parameter.scale);
    parameter.theta = parameter.prior_theta = theta;
    parameter.prior_root_weight = prior_noise * unit / prior.standard_uncertainty;
  }
  for (const auto& [name, value] : options.start) {
    Parameter& parameter = Find(name, "parameter with a start");
    const double theta = ThetaOf(parameter, "start of " + name, value);
    if (parameter.fixed) continue;
    parameter.theta = theta;
    parameter.started_by_user = true;
    if (theta >= parameter.lower && theta <= parameter.upper) continue;
    const auto [least, greatest] =
        std::minmax({parameter.ToValue(parameter.lower), parameter.ToValue(parameter.upper)});
    ThrowInvalid(fmt::format("start of {} [{}]", name, parameter.term->unit), value,
                 fmt::format("must lie within its bounds {:.6g} … {:.6g}", least, greatest));
  }
}

std::vector<double> Parameters::Theta() const {
  const auto theta = parameters_ | std::views::transform(&Parameter::theta);
  return {theta.begin(), theta.end()};
}

double Parameters::PriorCost(std::span<const double> theta) const {
  double cost = 0.0;
  for (std::size_t p = 0; p < size(); ++p) {
    if (!parameters_[p].has_prior()) continue;
    const double off = parameters_[p].prior_root_weight * (theta[p] - parameters_[p].prior_theta);
    cost += off * off;
  }
  return cost;
}

void Parameters::Fix(std::size_t i, double theta) {
  parameters_[i].theta = theta;
  parameters_[i].fixed = true;
  Sort();
}

models::BranchLaw Parameters::LawAt(std::span<const double> theta) const {
  return {.tangential_stiffness = parameters_[kStiffness].ToValue(theta[kStiffness]),
          .shape_exponent = theta[kShape],
          .slip_force = parameters_[kSlipForce].ToValue(theta[kSlipForce])};
}

models::SeriesSpring Parameters::RigAt(std::span<const double> theta) const {
  if (!has_rig()) return {};
  return {.stiffness = parameters_[kRig].ToValue(theta[kRig])};
}

}  // namespace mindahl::identification
