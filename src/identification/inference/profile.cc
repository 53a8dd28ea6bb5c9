#include "identification/inference/profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/intervals.h"
#include "mindahl/loop/disturbances.h"

namespace mindahl::identification {
namespace {

/// Tc over half the range of the force.
constexpr std::array kGrid = {0.9, 0.95, 1.0, 1.03, 1.1, 1.25, 1.5, 2.0, 3.0, 6.0, 20.0};
/// A barrier this many times the critical ratio high has no valley behind it.
constexpr double kHopeless = 100.0;
constexpr int kProfileBisections = 6;
constexpr double kRigid = 1e3;

/// The likelihood with one parameter held, the others fitted again. The solver is its own.
class HeldParameter {
 public:
  HeldParameter(const FittedProblem& fitted, std::size_t parameter, const SolverOptions& options,
                SearchBuffers& buffers)
      : problem_(fitted.problem),
        parameter_(parameter),
        best_(fitted.solution),
        variance_(fitted.noise.variance),
        evidence_(fitted.noise.samples, static_cast<double>(fitted.noise.samples) *
                                            fitted.estimates.WhiteShare(parameter)),
        options_(options),
        solver_(buffers.solver) {
    problem_.parameters.Fix(parameter, best_.theta[parameter]);
    solver_.Bind(problem_, buffers.response);
  }
  HeldParameter(const HeldParameter&) = delete;
  HeldParameter& operator=(const HeldParameter&) = delete;

  /// @returns F of the best fit against that with the parameter at θ, which is in solution()
  double At(double theta, const std::vector<double>& start) {
    solver_.HoldAt(parameter_, theta);
    solver_.Solve(start, options_, solution_);
    return evidence_.FStatistic(solution_.sum_of_squares, best_.sum_of_squares, variance_);
  }
  [[nodiscard]] const Solution& solution() const { return solution_; }

 private:
  Problem problem_;
  std::size_t parameter_;
  const Solution& best_;
  double variance_;
  Evidence evidence_;
  SolverOptions options_;
  Solver& solver_;
  Solution solution_;
};

/// α/Tc is what a loop far from slip determines: a start that keeps it.
std::vector<double> Continue(const Parameters& parameters, const std::vector<double>& from,
                             double log_slip_force) {
  std::vector<double> start = from;
  start[kSlipForce] = log_slip_force;
  if (!parameters[kShape].fixed) start[kShape] *= std::exp(log_slip_force - from[kSlipForce]);
  return start;
}

models::BranchLaw LawOf(const Parameters& parameters, const std::vector<double>& theta) {
  return {.tangential_stiffness = parameters[kStiffness].ToValue(theta[kStiffness]),
          .shape_exponent = parameters[kShape].ToValue(theta[kShape]),
          .slip_force = parameters[kSlipForce].ToValue(theta[kSlipForce])};
}

void Include(ProfiledRanges& ranges, const std::vector<double>& theta) {
  for (std::size_t p = 0; p < ranges.size(); ++p) {
    ranges[p].lower = std::min(ranges[p].lower, theta[p]);
    ranges[p].upper = std::max(ranges[p].upper, theta[p]);
  }
}

/// Returns the best fit alone.
ProfiledRanges RangesAt(const Solution& best) {
  ProfiledRanges ranges;
  for (std::size_t p = 0; p < ranges.size(); ++p) ranges[p] = {best.theta[p], best.theta[p]};
  return ranges;
}

/// Returns a range in the parameter's unit as a part of its interval.
IntervalPart IntervalPartOf(const Parameter& parameter, const Range& range, IntervalSource source) {
  return {.source = source,
          .lower = parameter.ToValue(range.lower),
          .upper = parameter.ToValue(range.upper)};
}

}  // namespace

std::array<double, 2> RatiosAtEnds(const FittedProblem& fitted, const FitOptions& options,
                                   double last_gain, SearchBuffers& buffers) {
  const Estimates& estimates = fitted.estimates;
  const double critical = estimates.quantile() * estimates.quantile();
  SolverOptions search = SolverOptionsOf(options);
  // The parabola predicts the cost at the ends.
  search.predicts_last = true;
  const double variance = fitted.noise.variance;
  search.last_step = last_gain * variance / (fitted.solution.sum_of_squares + critical * variance);
  HeldParameter held(fitted, kSlipForce, search, buffers);
  const double half = estimates.quantile() * estimates.ErrorOfTheta(kSlipForce);
  const auto ratio_at = [&](double step) {
    const std::vector<double> start = estimates.Beside(kSlipForce, step);
    return held.At(start[kSlipForce], start) / critical;
  };
  const double below = ratio_at(-half);
  return {below, ratio_at(half)};
}

bool NeedsSlipForceProfile(const FittedProblem& fitted, double peak_share,
                           const FitOptions& options, SearchBuffers& buffers) {
  if (fitted.problem.parameters[kSlipForce].fixed) return false;
  const Solution& best = fitted.solution;
  const Thresholds& thresholds = options.thresholds;
  const double half = fitted.estimates.quantile() * fitted.estimates.ErrorOfTheta(kSlipForce);
  const bool inside = best.side[kSlipForce] == BoundSide::kInside &&
                      best.side[kStiffness] == BoundSide::kInside &&
                      best.side[kShape] == BoundSide::kInside;
  if (!inside || !(half <= thresholds.parabola_error) ||
      !(peak_share >= thresholds.parabola_mobilised)) {
    return true;
  }
  return std::ranges::any_of(
      RatiosAtEnds(fitted, options, kLastGainAtEnds, buffers),
      [&](double ratio) { return !(std::abs(ratio - 1) <= thresholds.parabola_departure); });
}

SlipForceProfile ProfileSlipForce(const FittedProblem& fitted, const FitOptions& options,
                                  SearchBuffers& buffers) {
  const Problem& problem = fitted.problem;
  const Solution& best = fitted.solution;
  const Estimates& estimates = fitted.estimates;
  SlipForceProfile profile;
  const double at_best = best.theta[kSlipForce];
  profile.ranges = RangesAt(best);
  const Parameter& parameter = problem.parameters[kSlipForce];
  const double critical = estimates.quantile() * estimates.quantile();  // of F(1, ν)
  // With many terms most of these searches end at a bound of one; they are not repeated.
  constexpr std::size_t kMany = 8;
  SolverOptions search = SolverOptionsOf(options);
  search.is_rough = problem.parameters.free().size() > kMany;
  HeldParameter held(fitted, kSlipForce, search, buffers);
  LikelihoodProfile& likelihood = profile.likelihood;
  likelihood.critical = critical;
  likelihood.points.push_back({.law = LawOf(problem.parameters, best.theta)});
  const auto look_at = [&](double theta, const std::vector<double>& start) {
    const double statistic = held.At(theta, start);
    likelihood.points.push_back(
        {.law = LawOf(problem.parameters, held.solution().theta), .statistic = statistic});
    return statistic;
  };

  const auto walk = [&](bool upwards) {
    std::vector<double> grid;
    for (const double multiple : kGrid) {
      const double theta = std::log(multiple);
      const bool ahead = upwards ? theta > at_best : theta < at_best;
      if (ahead && theta >= parameter.lower && theta <= parameter.upper) grid.push_back(theta);
    }
    if (!upwards) std::ranges::reverse(grid);
    std::vector<double> last_theta = best.theta;
    std::vector<double> accepted_theta = best.theta;  // the outermost accepted point
    double rejected = 0.0;                            // the next point beyond it
    bool any_rejected = false;
    bool far_end_is_open = true;  // by the test of the verdict
    for (const double theta : grid) {
      const double value = look_at(theta, Continue(problem.parameters, last_theta, theta));
      last_theta = held.solution().theta;
      far_end_is_open = value < std::max(critical, options.thresholds.open_slip_force);
      if (value < critical) {
        Include(profile.ranges, last_theta);
        accepted_theta = last_theta;
        any_rejected = false;
      } else {
        if (!any_rejected) rejected = theta;
        any_rejected = true;
        if (value > kHopeless * critical) break;
      }
    }
    const bool open =
        far_end_is_open && upwards && (grid.empty() || parameter.upper >= std::log(kGrid.back()));
    if (!any_rejected) return open;
    double outside = rejected;
    for (int i = 0; i < kProfileBisections; ++i) {
      const double middle = accepted_theta[kSlipForce] / 2 + outside / 2;
      if (look_at(middle, Continue(problem.parameters, accepted_theta, middle)) < critical) {
        Include(profile.ranges, held.solution().theta);
        accepted_theta = held.solution().theta;
      } else {
        outside = middle;
      }
    }
    return open;
  };
  walk(/*upwards=*/false);
  profile.open_above = walk(/*upwards=*/true);
  std::ranges::sort(likelihood.points, {},
                    [](const ProfilePoint& point) { return point.law.slip_force; });
  // α rises with Tc along the valley: where its bound ends the valley, the data do not.
  const Parameter& shape = problem.parameters[kShape];
  if (!shape.fixed && SideOf(shape, profile.ranges[kShape].upper) == BoundSide::kUpper) {
    profile.open_above = true;
  }
  return profile;
}

bool StiffnessIsOpenAbove(const FittedProblem& fitted, const FitOptions& options,
                          SearchBuffers& buffers) {
  const auto& [problem, best, noise, estimates] = fitted;
  if (problem.parameters[kStiffness].fixed) return false;
  const double half = estimates.quantile() * estimates.ErrorOfTheta(kStiffness);
  // If only rounding is left, the parabola has the derivatives at a corner.
  const double rms = std::sqrt(best.sum_of_squares / static_cast<double>(problem.data->counted));
  const bool only_rounding = !noise.is_known && rms < kRoundingRms;
  const bool is_inside = best.side[kStiffness] == BoundSide::kInside;
  if (half <= options.thresholds.rigid_error && is_inside && !only_rounding) {
    return false;
  }
  HeldParameter held(fitted, kStiffness, SolverOptionsOf(options), buffers);
  std::vector<double> start = best.theta;
  start[kStiffness] += std::log(kRigid);
  return held.At(start[kStiffness], start) < estimates.quantile() * estimates.quantile();
}

std::optional<ProfiledRanges> ProfileSmallShape(const FittedProblem& fitted,
                                                const FitOptions& options, SearchBuffers& buffers) {
  const Problem& problem = fitted.problem;
  const Solution& best = fitted.solution;
  const Estimates& estimates = fitted.estimates;
  const Parameter& shape = problem.parameters[kShape];
  const bool is_at_zero = !shape.fixed && best.side[kShape] == BoundSide::kLower &&
                          shape.ToValue(best.theta[kShape]) == 0;
  if (!is_at_zero) return std::nullopt;
  constexpr double kFirst = 1.0 / 256;
  constexpr int kBetween = 3;  // bisections between the last that is allowed and the next
  const double critical = estimates.quantile() * estimates.quantile();
  HeldParameter held(fitted, kShape, SolverOptionsOf(options), buffers);
  ProfiledRanges ranges = RangesAt(best);
  std::vector<double> from = best.theta;
  const auto is_allowed = [&](double alpha) {
    if (!(held.At(alpha, from) < critical) || !held.solution().converged) return false;
    Include(ranges, held.solution().theta);
    from = held.solution().theta;
    return true;
  };
  double allowed = 0.0;
  double next = kFirst;
  while (next < shape.upper && is_allowed(next)) {
    allowed = next;
    next *= 2;
  }
  for (int i = 0; i < kBetween; ++i) {
    const double middle = allowed + (std::min(next, shape.upper) - allowed) / 2;
    (is_allowed(middle) ? allowed : next) = middle;
  }
  for (const std::size_t p : {kStiffness, kSlipForce}) {
    const double error = estimates.ErrorOfTheta(p);
    const double half = std::isfinite(error) ? estimates.quantile() * error : 0.0;
    ranges[p].lower -= half;
    ranges[p].upper += half;
  }
  return ranges;
}

namespace {

/// A parabola's minimum beside the fit is a start for steps that are shorter.
constexpr double kParabolic = 0.5;

/// Finds the step, from 0 on, at which a root of F over the critical one is 1; nothing where it is
/// less at the limit.
/// @param root_at  the root at a step
template <typename RootAt>
std::optional<double> CriticalStep(double step, double limit, RootAt root_at) {
  constexpr int kMostLooks = 12;
  constexpr double kClose = 0.01;       // of the root of F over the critical one
  constexpr double kLeastGrowth = 0.3;  // the next step is at most 1/0.3 times the last
  double inside = 0.0;
  double root_inside = 0.0;
  std::optional<double> outside;
  double root_outside = 0.0;
  for (int look = 0; look < kMostLooks; ++look) {
    const double root = root_at(step);
    if (std::abs(root - 1) < kClose) break;
    if (root < 1) {
      inside = step;
      root_inside = root;
    } else {
      outside = step;
      root_outside = root;
    }
    if (outside) {
      const double fraction = (1 - root_inside) / (root_outside - root_inside);
      constexpr double kFromEnds = 0.1;  // a kink is not stepped towards for ever
      step = inside + std::clamp(fraction, kFromEnds, 1 - kFromEnds) * (*outside - inside);
    } else {
      if (step >= limit) return std::nullopt;
      step = std::min(step / std::max(root, kLeastGrowth), limit);
    }
  }
  return step;
}

/// θ where the likelihood of a parameter reaches the critical one on one side of the best fit; the
/// bound where it does not before; nothing where it does not for a factor of a thousand.
/// @param towards  −1 or 1
std::optional<double> LikelihoodEnd(HeldParameter& held, const FittedProblem& fitted,
                                    std::size_t parameter, double towards) {
  const Estimates& estimates = fitted.estimates;
  const double farthest = std::log(kRigid);
  const Parameter& of = fitted.problem.parameters[parameter];
  const double from = fitted.solution.theta[parameter];
  const double limit =
      towards < 0 ? std::max(of.lower, from - farthest) : std::min(of.upper, from + farthest);
  const double critical = estimates.quantile() * estimates.quantile();
  const double first = std::min({estimates.quantile() * estimates.ErrorOfTheta(parameter),
                                 kParabolic, std::abs(limit - from)});
  std::vector<double> start = estimates.Beside(parameter, towards * first);
  const std::optional<double> step = CriticalStep(first, std::abs(limit - from), [&](double at) {
    const double root = std::sqrt(held.At(from + towards * at, start) / critical);
    start = held.solution().theta;
    return root;
  });
  if (step) return from + towards * *step;
  const bool is_bound = limit == (towards < 0 ? of.lower : of.upper);
  return is_bound ? std::optional(limit) : std::nullopt;
}

}  // namespace

ParameterEstimates ProfileBesideRig(const FittedProblem& fitted, const FitOptions& options,
                                    SearchBuffers& buffers, ParameterEstimates parameters) {
  const Problem& problem = fitted.problem;
  const Solution& best = fitted.solution;
  const Estimates& estimates = fitted.estimates;
  const Parameter& rig = problem.parameters[kRig];
  if (rig.absent || rig.fixed || best.side[kRig] != BoundSide::kInside) return parameters;
  const double half = estimates.quantile() * estimates.ErrorOfTheta(kRig);
  if (!std::isfinite(half)) return parameters;
  {
    HeldParameter held(fitted, kRig, SolverOptionsOf(options), buffers);
    const double critical = estimates.quantile() * estimates.quantile();
    const bool is_short = half < kParabolic;
    const bool is_parabola =
        is_short && std::ranges::all_of(std::array{-half, half}, [&](double step) {
          const std::vector<double> start = estimates.Beside(kRig, step);
          return std::abs(held.At(start[kRig], start) / critical - 1) <=
                 options.thresholds.parabola_departure;
        });
    if (is_parabola) return parameters;
  }
  for (const std::size_t p : {kRig, kStiffness, kShape, kSlipForce}) {
    const bool is_inside = best.side[p] == BoundSide::kInside;
    if (problem.parameters[p].fixed || !is_inside || !std::isfinite(estimates.ErrorOfTheta(p))) {
      continue;
    }
    ParameterEstimate& estimate = parameters[p];
    if (!estimate.lower95 || !estimate.upper95) continue;
    HeldParameter held(fitted, p, SolverOptionsOf(options), buffers);
    IntervalPart part{.source = IntervalSource::kProfile};
    const auto value_of = [&](std::optional<double> theta) {
      return theta ? std::optional(problem.parameters[p].ToValue(*theta)) : std::nullopt;
    };
    part.lower = value_of(LikelihoodEnd(held, fitted, p, -1.0));
    part.upper = value_of(LikelihoodEnd(held, fitted, p, 1.0));
    SetInterval(estimate, part);
    if (!part.lower || !part.upper) estimate.standard_error.reset();
  }
  return parameters;
}

ParameterEstimates IncludeSmallShape(const Problem& problem, const ProfiledRanges& ranges,
                                     ParameterEstimates parameters) {
  for (std::size_t p = 0; p < ranges.size(); ++p) {
    Include(parameters[p],
            IntervalPartOf(problem.parameters[p], ranges[p], IntervalSource::kSmallShape));
  }
  return parameters;
}

ParameterEstimates WidenByRanges(const Problem& problem, const ProfiledRanges& ranges,
                                 double quantile, ParameterEstimates parameters) {
  for (std::size_t p = 0; p < ranges.size(); ++p) {
    ParameterEstimate& estimate = parameters[p];
    if (!estimate.lower95 || !estimate.upper95) continue;
    Include(estimate, IntervalPartOf(problem.parameters[p], ranges[p], IntervalSource::kProfile));
    if (!estimate.standard_error) continue;
    const double half_width = (*estimate.upper95 - *estimate.lower95) / 2;
    estimate.standard_error = std::max(*estimate.standard_error, half_width / quantile);
  }
  return parameters;
}

double CarriedForce(const Problem& problem, const FitResult& result, double peak_force) {
  if (problem.data->is_forced() || result.records.empty()) return peak_force;
  if (IsScaledByLoad(result)) return 0.0;
  const RecordFit& widest = result.WidestRecord();
  if (widest.fitted_force.empty()) return peak_force;
  const auto [low, high] = std::ranges::minmax(widest.fitted_force);
  const double free = static_cast<double>(problem.parameters.free().size());
  const double error = 2 * widest.response_noise *
                       std::sqrt(free / std::max(result.residuals.effective_samples, free));
  std::vector<double> measured = widest.fitted_force;
  for (std::size_t i = 0; i < measured.size(); ++i) measured[i] -= widest.residual[i];
  const double white = loop::EstimateDisplacementNoise(measured);
  const double carried = std::max((high - low) / 2 - error, widest.measures.peak_force - white);
  return std::min(peak_force, carried / widest.load_ratio);
}

ParameterEstimates WidenByProfile(const Problem& problem, const SlipForceProfile& profile,
                                  double quantile, double carried, ParameterEstimates parameters) {
  parameters = WidenByRanges(problem, profile.ranges, quantile, std::move(parameters));
  if (!profile.open_above) return parameters;
  ParameterEstimate& alpha = parameters[kShape];
  ParameterEstimate& slip_force = parameters[kSlipForce];
  OpenAbove(slip_force, IntervalSource::kProfile);
  // A contact that carried T* has at least that slip force, unless the fit is too poor to say; and
  // no more where it is the bound of α that ends the valley.
  const bool by_bound = alpha.status == ParameterStatus::kAtUpperBound;
  const double profiled = by_bound ? 0.0 : slip_force.lower95.value_or(0.0);
  if (carried < slip_force.value) {
    SetInterval(slip_force,
                {.source = IntervalSource::kProfile, .lower = std::max(profiled, carried)});
  }
  if (alpha.status != ParameterStatus::kFixed) OpenAbove(alpha, IntervalSource::kProfile);
  return parameters;
}

}  // namespace mindahl::identification
