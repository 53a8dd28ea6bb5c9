#include "mindahl/identification/fit.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "identification/force_residual.h"
#include "identification/parameter_layout.h"
#include "identification/scaled_records.h"
#include "identification/slip_force_profile.h"
#include "identification/solver.h"
#include "identification/starting_values.h"
#include "identification/turning_points.h"
#include "identification/uncertainty.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/reversals.h"

namespace mindahl {
namespace {

/// Residuals of a noise-free record are rounding errors; smaller differences between fits mean
/// nothing.
constexpr double kRoundingRms = 1e-13;  // of the force range
constexpr double kConfidence = 0.95;

void RequireOptions(std::span<const Record> records, const FitOptions& options) {
  if (records.empty()) throw InvalidArgument("there is no record: a fit needs at least one");
  if (options.model == nullptr || options.model->scaled_by_peak) {
    throw InvalidArgument("the model cannot be fitted: it must be told the amplitude");
  }
  if (options.force_sense && *options.force_sense != 1 && *options.force_sense != -1) {
    ThrowInvalid("force sense [-]", *options.force_sense, "must be +1 or -1");
  }
  if (options.force_noise) RequirePositive("force noise [N]", *options.force_noise);
  if (options.reversal_gate) RequireNonNegative("reversal gate [m]", *options.reversal_gate);
  if (options.max_iterations < 1) {
    ThrowInvalid("maximum iterations [-]", options.max_iterations, "must be >= 1");
  }
  if (options.starts < 1) ThrowInvalid("starts [-]", 0, "must be >= 1");
  for (const Record& record : records) Validate(record);
}

/// A fit of all records from one assumption about their past.
struct Candidate {
  InitialState state;
  ParameterLayout layout;
  ForceResidual residual;
  Solution solution;
  std::vector<StartReport> starts;
};

double Rms(double sum_of_squares, const ScaledRecords& data) {
  return data.force * std::sqrt(sum_of_squares / static_cast<double>(data.samples()));
}

/// Where α is held the likelihood may have kinks (a Jenkins loop just past slip has a false minimum
/// where none of its samples slips); with α free it is smooth, and its minimum is a start.
std::optional<StartingPoint> StartWithFreeShape(InitialState state, const ScaledRecords& data,
                                                const FitOptions& options,
                                                const ParameterLayout& held) {
  FrictionModel model = *options.model;
  model.shape_exponent.reset();
  FitOptions relaxed = options;
  relaxed.model = &model;
  relaxed.fixed.erase("alpha");
  const ParameterLayout layout(data, relaxed, state);
  const ForceResidual residual(data, model, state);
  const std::vector<StartingPoint> starts = FindStartingPoints(data, layout, relaxed, state);
  if (starts.empty()) return {};
  Solution solution = Solve(residual, layout, starts.front().theta, relaxed);
  solution.theta[kShapeExponent] = held.parameters()[kShapeExponent].theta;
  std::vector<double> values(residual.size());
  residual.Evaluate(solution.theta, values);
  return StartingPoint{solution.theta,
                       std::inner_product(values.begin(), values.end(), values.begin(), 0.0)};
}

Candidate FitFrom(InitialState state, const ScaledRecords& data, const FitOptions& options) {
  Candidate candidate{.state = state,
                      .layout = ParameterLayout(data, options, state),
                      .residual = ForceResidual(data, *options.model, state),
                      .solution = {},
                      .starts = {}};
  if (data.samples() < candidate.layout.free().size()) {
    throw InvalidArgument(
        fmt::format("{} samples are too few for {} free parameters: record more or fix some",
                    data.samples(), candidate.layout.free().size()));
  }
  candidate.solution.sum_of_squares = std::numeric_limits<double>::infinity();
  candidate.solution.termination = "no starting point has the force's sense";
  std::vector<StartingPoint> starts = FindStartingPoints(data, candidate.layout, options, state);
  if (!starts.empty() && candidate.layout.parameters()[kShapeExponent].fixed) {
    const auto relaxed = StartWithFreeShape(state, data, options, candidate.layout);
    if (relaxed) starts.push_back(*relaxed);
  }
  for (const StartingPoint& start : starts) {
    Solution solution = Solve(candidate.residual, candidate.layout, start.theta, options);
    candidate.starts.push_back({.start = candidate.layout.Law(start.theta),
                                .initial_rms = Rms(start.sum_of_squares, data),
                                .reached = candidate.layout.Law(solution.theta),
                                .final_rms = Rms(solution.sum_of_squares, data),
                                .converged = solution.converged});
    if (solution.sum_of_squares < candidate.solution.sum_of_squares) {
      candidate.solution = std::move(solution);
    }
  }
  return candidate;
}

std::vector<std::vector<double>> SplitByRecord(const ScaledRecords& data,
                                               std::span<const double> values) {
  std::vector<std::vector<double>> parts;
  std::size_t begin = 0;
  for (const ScaledRecord& record : data.records) {
    const auto part = values.subspan(begin, record.force.size());
    parts.emplace_back(part.begin(), part.end());
    begin += part.size();
  }
  return parts;
}

std::vector<std::vector<double>> ScaledForces(const ScaledRecords& data) {
  std::vector<std::vector<double>> forces;
  for (const ScaledRecord& record : data.records) forces.push_back(record.force);
  return forces;
}

ResidualStatistics DescribeScaled(const ScaledRecords& data, const Candidate& candidate) {
  std::vector<double> values(candidate.residual.size());
  candidate.residual.Evaluate(candidate.solution.theta, values);
  return DescribeResiduals(SplitByRecord(data, values), ScaledForces(data), 1.0,
                           candidate.layout.free().size());
}

/// Akaike's criterion with its small-sample term, for Gaussian residuals of unknown variance. The
/// effective samples weigh the likelihood only: a wrong law leaves a handful of them, for which the
/// small-sample term would outweigh any difference between two fits.
double CorrectedAkaike(const Candidate& candidate, double samples, const ScaledRecords& data) {
  const double mean_square =
      std::max(candidate.solution.sum_of_squares / static_cast<double>(data.samples()),
               kRoundingRms * kRoundingRms);
  const auto parameters = static_cast<double>(candidate.layout.free().size() + 1);
  return samples * std::log(mean_square) + 2 * parameters +
         2 * parameters * (parameters + 1) /
             std::max(static_cast<double>(data.samples()) - parameters - 1, 1.0);
}

Candidate FitBestState(const ScaledRecords& data, const FitOptions& options) {
  if (options.initial_state) return FitFrom(*options.initial_state, data, options);
  const bool unloaded_is_given = std::ranges::any_of(options.fixed, [](const auto& fixed) {
    return fixed.first.starts_with("displacement_offset");
  });
  if (unloaded_is_given) return FitFrom(InitialState::kVirgin, data, options);
  Candidate virgin = FitFrom(InitialState::kVirgin, data, options);
  const bool any_reversal = std::ranges::any_of(
      data.records, [](const ScaledRecord& record) { return !record.reversals.empty(); });
  if (!any_reversal) return virgin;
  Candidate steady = FitFrom(InitialState::kSteady, data, options);
  const Candidate& better =
      virgin.solution.sum_of_squares < steady.solution.sum_of_squares ? virgin : steady;
  if (!std::isfinite(better.solution.sum_of_squares)) return virgin;  // neither was even started
  const double samples = DescribeScaled(data, better).effective_samples;
  return CorrectedAkaike(virgin, samples, data) < CorrectedAkaike(steady, samples, data)
             ? std::move(virgin)
             : std::move(steady);
}

ParameterStatus StatusOf(const ScaledParameter& parameter, double theta) {
  constexpr double kAtBound = 1e-9;
  if (parameter.fixed) return ParameterStatus::kFixed;
  const double tolerance = kAtBound * std::max(1.0, parameter.upper - parameter.lower);
  const bool mirrored = parameter.scale < 0;
  if (theta - parameter.lower <= tolerance) {
    return mirrored ? ParameterStatus::kAtUpperBound : ParameterStatus::kAtLowerBound;
  }
  if (parameter.upper - theta <= tolerance) {
    return mirrored ? ParameterStatus::kAtLowerBound : ParameterStatus::kAtUpperBound;
  }
  return ParameterStatus::kFree;
}

/// Values, errors, intervals and correlations of one fit.
class Estimator {
 public:
  Estimator(const Candidate& candidate, double variance, const ResidualStatistics& statistics)
      : candidate_(candidate), quantile_(TwoSidedQuantile(statistics.degrees_of_freedom)) {
    const auto& parameters = candidate.layout.parameters();
    std::vector<std::size_t> inside;
    for (const std::size_t i : candidate.layout.free()) {
      if (StatusOf(parameters[i], candidate.solution.theta[i]) == ParameterStatus::kFree) {
        inside.push_back(i);
      }
    }
    // Autocorrelated residuals carry the information of effective_samples independent ones.
    variance_ = variance * static_cast<double>(statistics.samples) / statistics.effective_samples;
    conditional_ = AnalyseJacobian(candidate.residual, candidate.solution.theta, std::move(inside));
    full_ = AnalyseJacobian(candidate.residual, candidate.solution.theta, candidate.layout.free());
  }

  [[nodiscard]] ParameterEstimate Estimate(std::size_t index) const {
    const ScaledParameter& parameter = candidate_.layout.parameters()[index];
    const double theta = candidate_.solution.theta[index];
    ParameterEstimate estimate;
    estimate.name = parameter.name;
    estimate.unit = parameter.unit;
    estimate.value = parameter.ToValue(theta);
    estimate.status = StatusOf(parameter, theta);
    if (estimate.status == ParameterStatus::kFixed) {
      estimate.identifiability = Identifiability::kIdentifiable;
      return estimate;
    }
    const bool at_bound = estimate.status != ParameterStatus::kFree;
    const LocalUncertainty& local = at_bound ? full_ : conditional_;
    const auto column = std::ranges::find(local.columns, index) - local.columns.begin();
    const auto j = static_cast<std::size_t>(column);
    if (!local.determined[j]) return estimate;
    const double error = std::sqrt(local.Factor(j, j) * variance_);
    estimate.identifiability = Identifiability::kIdentifiable;
    if (at_bound) {
      // Half the normal law lies beyond the bound: the interval is one-sided, from the bound.
      const double reach = OneSidedShare() * error;
      const double inner = parameter.ToValue(
          theta <= parameter.lower + (parameter.upper - parameter.lower) / 2 ? theta + reach
                                                                             : theta - reach);
      estimate.lower95 = std::min(estimate.value, inner);
      estimate.upper95 = std::max(estimate.value, inner);
      if (index == kShapeExponent) estimate.lower95 = std::max(*estimate.lower95, 0.0);
      return estimate;
    }
    estimate.standard_error =
        parameter.logarithmic ? estimate.value * error : std::abs(parameter.scale) * error;
    const double lower = parameter.ToValue(theta - quantile_ * error);
    const double upper = parameter.ToValue(theta + quantile_ * error);
    estimate.lower95 = std::min(lower, upper);
    estimate.upper95 = std::max(lower, upper);
    if (index == kShapeExponent) estimate.lower95 = std::max(*estimate.lower95, 0.0);
    return estimate;
  }

  [[nodiscard]] double Correlation(std::size_t row, std::size_t column) const {
    const auto& columns = conditional_.columns;
    const auto i = static_cast<std::size_t>(std::ranges::find(columns, row) - columns.begin());
    const auto j = static_cast<std::size_t>(std::ranges::find(columns, column) - columns.begin());
    if (i == columns.size() || j == columns.size() || !conditional_.determined[i] ||
        !conditional_.determined[j]) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    if (i == j) return 1.0;
    const double sign = ScaleSign(row) * ScaleSign(column);
    return sign * conditional_.Factor(i, j) /
           std::sqrt(conditional_.Factor(i, i) * conditional_.Factor(j, j));
  }

  /// Directions in θ that leave the response as it is.
  [[nodiscard]] const LocalUncertainty& local() const { return full_; }
  /// Half width of a 95 % interval in standard errors.
  [[nodiscard]] double quantile() const { return quantile_; }

 private:
  static double TwoSidedQuantile(double degrees_of_freedom) {
    return boost::math::quantile(boost::math::students_t(degrees_of_freedom),
                                 0.5 + kConfidence / 2);
  }
  [[nodiscard]] static double OneSidedShare() {
    return 1.959963984540054;
  }  // Φ⁻¹(0.975), halved tail

  [[nodiscard]] double ScaleSign(std::size_t index) const {
    return candidate_.layout.parameters()[index].scale < 0 ? -1.0 : 1.0;
  }

  const Candidate& candidate_;
  double quantile_;
  double variance_ = 0.0;
  LocalUncertainty conditional_;  // of the parameters inside their bounds, the others held there
  LocalUncertainty full_;         // of all free parameters
};

void Warn(FitResult& result, std::string code, std::string message) {
  result.warnings.push_back({std::move(code), std::move(message)});
}

ParameterEstimate& Mutable(FitResult& result, std::string_view name) {
  return *std::ranges::find(result.parameters, name, &ParameterEstimate::name);
}

/// Widens an interval to a likelihood range; its standard error follows where it was too small.
void Widen(ParameterEstimate& estimate, const ScaledParameter& parameter, const Range& range,
           double quantile) {
  if (!estimate.lower95 || !estimate.upper95) return;
  estimate.lower95 = std::min(*estimate.lower95, parameter.ToValue(range.lower));
  estimate.upper95 = std::max(*estimate.upper95, parameter.ToValue(range.upper));
  if (estimate.standard_error) {
    const double half_width = (*estimate.upper95 - *estimate.lower95) / 2;
    estimate.standard_error = std::max(*estimate.standard_error, half_width / quantile);
  }
}

void OpenAbove(ParameterEstimate& estimate) {
  estimate.identifiability = Identifiability::kBoundedBelow;
  estimate.upper95.reset();
  estimate.standard_error.reset();
}

/// Puts what the profile found into intervals, verdicts and words.
void JudgeProfile(FitResult& result, const ParameterLayout& layout, const SlipForceProfile& profile,
                  double quantile) {
  ParameterEstimate& sigma = Mutable(result, "sigma");
  ParameterEstimate& alpha = Mutable(result, "alpha");
  ParameterEstimate& slip_force = Mutable(result, "slip_force");
  Widen(sigma, layout.parameters()[kLogStiffness], profile.stiffness, quantile);
  Widen(alpha, layout.parameters()[kShapeExponent], profile.shape_exponent, quantile);
  Widen(slip_force, layout.parameters()[kLogSlipForce], profile.slip_force, quantile);
  if (!profile.open_above) return;

  const LoopMeasures& measures = result.WidestRecord().measures;
  OpenAbove(slip_force);
  // A contact that carried T* has at least that slip force, unless the fit is too poor to say.
  slip_force.lower95 =
      std::min(slip_force.value, std::max(slip_force.lower95.value_or(0.0), measures.peak_force));
  Warn(result, "slip_force_bounded_below",
       fmt::format("slip_force: the loop (T* = {:.4g} N at X = {:.4g} m) does not approach gross "
                   "slip and fits any larger slip force as well; raise the amplitude until the "
                   "force levels off",
                   measures.peak_force, measures.amplitude));
  if (alpha.status == ParameterStatus::kFixed) return;
  alpha.identifiability = Identifiability::kNotIdentifiable;
  alpha.upper95.reset();
  alpha.standard_error.reset();
  Warn(result, "alpha_not_identifiable",
       "alpha: known only together with slip_force (the ratio alpha/slip_force enters the loop); "
       "raise the amplitude until the force levels off, or fix one of them");
}

void JudgeStiffness(FitResult& result, bool open_above) {
  if (!open_above) return;
  OpenAbove(Mutable(result, "sigma"));
  Warn(result, "sigma_bounded_below",
       "sigma: a rigid contact (sigma without limit) fits as well; sample more densely after the "
       "reversals, or lower the amplitude");
}

void JudgeLocally(FitResult& result) {
  // An interval wider than this factor either way, or than ±1/2 in α, is no determination.
  constexpr double kWidestRatio = 3.0;
  constexpr double kWidestShape = 1.0;
  for (const std::string_view name : {"sigma", "alpha", "slip_force"}) {
    ParameterEstimate& estimate = Mutable(result, name);
    if (estimate.identifiability != Identifiability::kIdentifiable || !estimate.lower95 ||
        !estimate.upper95) {
      continue;
    }
    const bool wide =
        name == "alpha"
            ? *estimate.upper95 - *estimate.lower95 > kWidestShape * std::max(1.0, estimate.value)
            : *estimate.upper95 > kWidestRatio * kWidestRatio * *estimate.lower95;
    if (!wide) continue;
    estimate.identifiability = Identifiability::kNotIdentifiable;
    Warn(result, fmt::format("{}_not_identifiable", name),
         fmt::format("{}: the 95 % interval {:.3g} … {:.3g} is too wide to call it known; record "
                     "more samples, less noise or a larger amplitude",
                     name, *estimate.lower95, *estimate.upper95));
  }
}

void JudgeNullDirections(FitResult& result, const Candidate& candidate,
                         const LocalUncertainty& local) {
  if (local.null.empty()) return;
  std::vector<std::string> names;
  for (std::size_t k = 0; k < local.columns.size(); ++k) {
    if (!local.determined[k]) names.push_back(candidate.layout.parameters()[local.columns[k]].name);
  }
  const std::string list = fmt::format("{}", fmt::join(names, ", "));
  if (local.null.size() >= names.size()) {  // each of them is a direction of its own
    Warn(result, "undetermined_parameter",
         fmt::format("{}: the record does not depend on {}; fix {}, or record another amplitude",
                     list, names.size() == 1 ? "it" : "any of them",
                     names.size() == 1 ? "it" : "them"));
    return;
  }
  Warn(result, "undetermined_combination",
       fmt::format("the record determines only a combination of {}: fix one of them, or record a "
                   "larger amplitude",
                   list));
}

void FillRecords(FitResult& result, std::span<const Record> records, const ScaledRecords& data,
                 std::span<const double> scaled_residual) {
  const std::vector<std::vector<double>> parts = SplitByRecord(data, scaled_residual);
  for (std::size_t r = 0; r < records.size(); ++r) {
    RecordFit& fit = result.records[r];
    for (std::size_t i = 0; i < parts[r].size(); ++i) {
      fit.residual.push_back(data.sense * data.force * parts[r][i]);
      fit.fitted_force.push_back(records[r].force[i] + fit.residual.back());
    }
  }
}

/// Reversals and the force's sense: what depends on no model.
int PrepareRecords(std::span<const Record> records, const FitOptions& options, FitResult& result) {
  int votes = 0;
  for (const Record& record : records) {
    RecordFit& fit = result.records.emplace_back();
    fit.reversal_gate = options.reversal_gate.value_or(EstimateReversalGate(record.displacement));
    fit.reversals = FindReversals(record.displacement, fit.reversal_gate);
    votes += ForceSense(record, fit.reversals);
  }
  const int sense = options.force_sense.value_or(votes < 0 ? -1 : 1);
  for (std::size_t r = 0; r < records.size(); ++r) {
    Record oriented = records[r];
    for (double& force : oriented.force) force *= sense;
    result.records[r].measures = MeasureLoop(oriented, result.records[r].reversals);
  }
  return sense;
}

/// Frees the turning points where the record was sampled too coarsely to show them.
void RefineTurningPoints(Candidate& best, const ScaledRecords& data, const FitOptions& options,
                         FitResult& result) {
  if (!best.solution.converged) return;
  // A gate means noise in the displacement: its outermost samples are the noisiest, and say nothing
  // of where the motion turned.
  if (std::ranges::any_of(result.records,
                          [](const RecordFit& fit) { return fit.reversal_gate > 0; })) {
    return;
  }
  // Residuals of rounding size have nothing left to explain.
  const double rms = std::sqrt(best.solution.sum_of_squares / static_cast<double>(data.samples()));
  if (rms < kRoundingRms) return;
  std::optional<TurningPointFit> refined =
      FitTurningPoints(data, best.residual, best.layout, best.solution, options);
  if (!refined) return;
  best.layout = std::move(refined->layout);
  best.solution = std::move(refined->solution);
  std::size_t position = best.layout.reported();
  double largest = 0.0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    for (std::size_t j = 0; j < data.records[r].reversals.size(); ++j, ++position) {
      const double overshoot =
          best.layout.parameters()[position].ToValue(best.solution.theta[position]);
      result.records[r].overshoot.push_back(overshoot);
      largest = std::max(largest, overshoot);
    }
  }
  Warn(result, "turning_points_between_samples",
       fmt::format("the motion turns between samples, up to {:.3g} m beyond the outermost: the "
                   "turning points were fitted too; sample more densely",
                   largest));
}

std::vector<std::vector<std::size_t>> ReversalsOf(const FitResult& result) {
  std::vector<std::vector<std::size_t>> reversals;
  for (const RecordFit& fit : result.records) reversals.push_back(fit.reversals);
  return reversals;
}

}  // namespace

const ParameterEstimate* FitResult::Find(std::string_view name) const {
  const auto found = std::ranges::find(parameters, name, &ParameterEstimate::name);
  return found == parameters.end() ? nullptr : &*found;
}

const RecordFit& FitResult::WidestRecord() const {
  return *std::ranges::max_element(records, {},
                                   [](const RecordFit& fit) { return fit.measures.amplitude; });
}

FitResult Fit(std::span<const Record> records, const FitOptions& options) {
  RequireOptions(records, options);
  FitResult result;
  result.model = options.model;
  result.force_sense = PrepareRecords(records, options, result);
  const ScaledRecords data = Scale(records, ReversalsOf(result), result.force_sense);

  Candidate best = FitBestState(data, options);
  RefineTurningPoints(best, data, options, result);
  result.initial_state = best.state;
  result.starts = best.starts;
  result.termination = best.solution.termination;
  result.iterations = best.solution.iterations;
  result.converged = best.solution.converged;
  if (!std::isfinite(best.solution.sum_of_squares)) {
    result.converged = false;
    return result;
  }
  result.law = best.layout.Law(best.solution.theta);

  std::vector<double> residual(best.residual.size());
  best.residual.Evaluate(best.solution.theta, residual);
  FillRecords(result, records, data, residual);
  std::vector<std::vector<double>> residuals;
  std::vector<std::vector<double>> forces;
  for (std::size_t r = 0; r < records.size(); ++r) {
    residuals.push_back(result.records[r].residual);
    forces.push_back(records[r].force);
  }
  result.residuals =
      DescribeResiduals(residuals, forces, result.law.slip_force, best.layout.free().size());

  const auto samples = static_cast<double>(data.samples());
  const auto free_parameters = static_cast<double>(best.layout.free().size());
  const double noise = options.force_noise.value_or(0.0) / data.force;
  const double variance = std::max(
      options.force_noise ? noise * noise
                          : best.solution.sum_of_squares / std::max(samples - free_parameters, 1.0),
      kRoundingRms * kRoundingRms);
  const Estimator estimator(best, variance, result.residuals);
  const std::size_t count = best.layout.reported();
  for (std::size_t i = 0; i < count; ++i) {
    result.parameters.push_back(estimator.Estimate(i));
    for (std::size_t j = 0; j < count; ++j) {
      result.correlation.push_back(estimator.Correlation(i, j));
    }
  }
  JudgeNullDirections(result, best, estimator.local());
  const double share = result.residuals.effective_samples / samples;
  const double critical = estimator.quantile() * estimator.quantile();  // of F(1, ν), χ²₁ as ν → ∞
  JudgeProfile(result, best.layout,
               ProfileSlipForce(best.residual, best.layout, best.solution, variance, share,
                                critical, options),
               estimator.quantile());
  JudgeStiffness(result, StiffnessIsOpenAbove(best.residual, best.layout, best.solution, variance,
                                              share, critical, options));
  JudgeLocally(result);
  return result;
}

}  // namespace mindahl
