#include "identification/inference/profile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "identification/solve/solver.h"

namespace mindahl::identification {
namespace {

/// Finds the step, from 0 on, at which `root_at`, the root of F over the critical one, is 1;
/// nothing where it is less at the limit.
template <typename RootAt>
std::optional<double> CriticalStep(double step, double limit, RootAt root_at) {
  constexpr int kMostLooks = 24;
  constexpr double kClose = 0.01;       // of the root of F over the critical one
  constexpr double kLeastGrowth = 0.1;  // the next step is at most ten times the last
  constexpr double kFromEnds = 0.1;     // a kink is not stepped towards for ever
  std::pair inside = {0.0, 0.0};        // step and root
  std::pair outside = inside;
  bool is_bracketed = false;
  for (int look = 0; look < kMostLooks; ++look) {
    const double root = root_at(step);
    if (std::abs(root - 1) < kClose) return step;
    (root < 1 ? inside : outside) = {step, root};
    is_bracketed = is_bracketed || !(root < 1);
    if (is_bracketed) {
      const double fraction = (1 - inside.second) / (outside.second - inside.second);
      step = inside.first +
             std::clamp(fraction, kFromEnds, 1 - kFromEnds) * (outside.first - inside.first);
    } else {
      if (step >= limit) return std::nullopt;
      step = std::min(step / std::max(root, kLeastGrowth), limit);
    }
  }
  return is_bracketed ? std::optional(step) : std::nullopt;
}

bool IsFree(const Estimates& fitted, std::size_t parameter) {
  return !fitted.problem().parameters[parameter].fixed;
}

/// The likelihood with one parameter held, the others fitted again.
class HeldParameter {
 public:
  /// @param region  to which θ of the fits that are not rejected is added
  HeldParameter(const Estimates& fitted, std::size_t parameter, const SolverOptions& options,
                Region& region)
      : fitted_(fitted), parameter_(parameter), options_(options), region_(region) {}

  /// True if a slip force far above the largest force, which is about 1, is not excluded.
  bool IsOpenAbove() {
    const Thresholds& thresholds = fitted_.thresholds();
    const double far = std::log(thresholds.far_slip_force);
    const std::vector<double>& best = fitted_.solution().theta;
    if (far > problem_.parameters[kSlipForce].upper || far < best[kSlipForce]) return false;
    if (At(far, best) >= thresholds.open_slip_force) return false;
    // Beside a spring σ grows with Tc: what leaves the one open leaves the other.
    if (IsFree(fitted_, kSpring)) region_.push_back(solution_.theta);
    return true;
  }

  /// Finds the value where F is the critical one on one side of the best fit; ValueAtBound() where
  /// it is less up to there; nothing where F is less for a factor of a thousand.
  /// @param towards  −1 or 1, of θ
  std::optional<double> End(double towards) {
    constexpr double kFarthest = 6.9;   // of a logarithm
    constexpr double kParabolic = 0.5;  // the parabola's minimum is a start for shorter steps
    const Parameter& of = fitted_.problem().parameters[parameter_];
    const double from = fitted_.solution().theta[parameter_];
    const double limit =
        towards < 0 ? std::max(of.lower, from - kFarthest) : std::min(of.upper, from + kFarthest);
    const double first =
        std::min({fitted_.HalfWidth(parameter_), kParabolic, std::abs(limit - from)});
    std::vector<double> start = fitted_.Beside(parameter_, towards * first);
    std::vector<double> inside = fitted_.solution().theta;
    const std::optional<double> step = CriticalStep(first, std::abs(limit - from), [&](double at) {
      const double root = std::sqrt(At(from + towards * at, start) / fitted_.critical());
      // A search that lost the valley is not gone on from.
      if (root < 1) inside = solution_.theta;
      start = inside;
      return root;
    });
    // With α at its upper bound, the bound limits Tc and the data do not: the interval stays open.
    const Parameter& shape = problem_.parameters[kShape];
    if (towards > 0 && parameter_ == kSlipForce &&
        SideOf(shape, solution_.theta[kShape]) == BoundSide::kUpper) {
      return std::nullopt;
    }
    if (step) return of.ToValue(from + towards * *step);
    if (limit != (towards < 0 ? of.lower : of.upper)) return std::nullopt;
    return ValueAtBound(of, towards < 0 ? BoundSide::kLower : BoundSide::kUpper);
  }

 private:
  /// Returns F of the best fit against the solution with the parameter at θ, the others from
  /// `start`.
  double At(double theta, std::vector<double> start) {
    start[parameter_] = theta;
    problem_.parameters.Fix(parameter_, theta);
    ProjectedResidual residual(problem_);
    solution_ = Solve(residual, start, options_);
    const double statistic = fitted_.FStatistic(parameter_, solution_.sum_of_squares);
    if (statistic <= fitted_.critical()) region_.push_back(solution_.theta);
    return statistic;
  }

  const Estimates& fitted_;
  Problem problem_ = fitted_.problem();
  std::size_t parameter_;
  SolverOptions options_;
  Region& region_;
  Solution solution_;
};

/// Returns the parameters of which the parabola may fail: all of a loop that hardly slips, of a law
/// at a bound, and where Tc or the rig is badly known; σ and α where few samples slip in part.
std::vector<std::size_t> ProfiledOf(const Estimates& fitted, const FitResult& result) {
  const Thresholds& thresholds = fitted.thresholds();
  const auto is_at_bound = [&](std::size_t p) {
    const Parameter& parameter = fitted.problem().parameters[p];
    return SideOf(parameter, fitted.solution().theta[p]) != BoundSide::kInside;
  };
  const auto is_badly_known = [&](std::size_t p) {
    return !(fitted.HalfWidth(p) <= thresholds.parabola_error);
  };
  // A parallel spring may carry what the law does not: its peak is then no sign of slip.
  const bool slips = result.PeakForce() >= thresholds.mobilised * result.law.slip_force &&
                     (!IsFree(fitted, kSpring) || loop::Slides(result.WidestRecord().facts));
  const bool is_rig_open = IsFree(fitted, kRig) && (is_at_bound(kRig) || is_badly_known(kRig));
  constexpr double kHardly = 0.1;  // energy ratio: far from slip it is a tenth of that
  const auto may_be_far_from_slip = [&] {
    Region region;
    const SolverOptions search{.max_iterations = fitted.options().max_iterations};
    return result.WidestRecord().facts.energy_ratio <= kHardly &&
           HeldParameter(fitted, kSlipForce, search, region).IsOpenAbove();
  };
  const bool is_slip_open =
      IsFree(fitted, kSlipForce) &&
      (!slips || result.law.shape_exponent <= thresholds.jenkins_shape ||
       std::ranges::any_of(std::array{kSlipForce, kStiffness, kShape}, is_at_bound) ||
       is_badly_known(kSlipForce) || may_be_far_from_slip());
  if (is_rig_open || is_slip_open) return {kStiffness, kShape, kSlipForce, kRig, kSpring};
  // If α rests on few samples of a stroke, the likelihood has an edge at each α where one more
  // sample enters partial slip. Between two edges every α fits with a σ of its own.
  constexpr double kFew = 2.0;  // of a stroke
  double strokes = 0.0;
  for (const RecordFit& record : result.records) {
    strokes += static_cast<double>(record.reversals.size()) + 1;
  }
  if (IsFree(fitted, kShape) && fitted.SamplesOf(kShape) < kFew * strokes) {
    return {kStiffness, kShape};
  }
  if (is_badly_known(kStiffness)) return {kStiffness};
  return {};
}

}  // namespace

Ends Profile(const Estimates& fitted, std::size_t parameter, Region& region) {
  // With many terms, and a rig that is rigid, most of these searches end at a bound; they are not
  // repeated.
  constexpr std::size_t kMany = 8;
  const Parameter& rig = fitted.problem().parameters[kRig];
  const SolverOptions search{
      .max_iterations = fitted.options().max_iterations,
      .is_rough = fitted.problem().parameters.free().size() > kMany ||
                  SideOf(rig, fitted.solution().theta[kRig]) == BoundSide::kUpper};
  HeldParameter held(fitted, parameter, search, region);
  const std::optional<double> lower = held.End(-1.0);
  const bool is_open = parameter == kSlipForce && held.IsOpenAbove();
  return {.lower = lower, .upper = is_open ? std::nullopt : held.End(1.0)};
}

void ProfileIntervals(const Estimates& fitted, FitResult& result) {
  ParameterEstimates& parameters = result.parameters;
  const Parameters& of_problem = fitted.problem().parameters;
  const auto estimate_of = [&](std::size_t p) -> ParameterEstimate& {
    const auto& reported = of_problem.reported();
    return parameters[static_cast<std::size_t>(std::ranges::find(reported, p) - reported.begin())];
  };
  std::vector<std::size_t> profiled = ProfiledOf(fitted, result);
  std::erase_if(profiled, [&](std::size_t p) { return !IsFree(fitted, p); });
  Region region;
  for (const std::size_t p : profiled) SetInterval(estimate_of(p), Profile(fitted, p, region));
  for (const std::size_t p : profiled) {
    ParameterEstimate& estimate = estimate_of(p);
    // The search for one parameter's end may pass what another's did not find.
    for (const std::vector<double>& theta : region) {
      Include(estimate, EndsWithinBounds(of_problem[p], theta[p], theta[p]));
    }
    if (!estimate.lower95 || !estimate.upper95) {
      estimate.standard_error.reset();
    } else if (estimate.standard_error) {
      estimate.standard_error = (*estimate.upper95 - *estimate.lower95) / 2 / fitted.quantile();
    }
  }
  ParameterEstimate& slip_force = parameters[kSlipForce];
  if (slip_force.status == ParameterStatus::kFixed || slip_force.upper95) return;
  if (IsFree(fitted, kSpring) && !parameters[kStiffness].upper95) {
    ParameterEstimate& spring = estimate_of(kSpring);  // what it adds to σ is determined, not each
    SetInterval(spring, {.upper = spring.upper95});
  }
  // With α at its upper bound, the likelihood does not determine the lower end of Tc either.
  ParameterEstimate& shape = parameters[kShape];
  if (shape.status == ParameterStatus::kAtUpperBound) SetInterval(slip_force, {.lower = 0.0});
  if (shape.status != ParameterStatus::kFixed) SetInterval(shape, {.lower = shape.lower95});
}

}  // namespace mindahl::identification
