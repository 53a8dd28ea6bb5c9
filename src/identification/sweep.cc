#include "mindahl/identification/sweep.h"

#include <ceres/ceres.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/probability.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

constexpr std::array<const char*, 3> kSweepNames = {"sigma", "alpha", "slip_force"};
constexpr std::array<const char*, 3> kUnits = {"N/m", "-", "N"};
constexpr double kLargestAlpha = 20.0;
// Bounds of σ and Tc as factors of the greatest stiffness and force of the sweep.
constexpr double kFarthestScale = 1e4;

using Point = std::array<double, 3>;  // ln σ, α, ln Tc

constexpr double kSmall = 1e-8;  // below which a quadratic term is less than an ulp

/// Returns (e^y − 1)/y.
template <typename T>
T GrowthOver(const T& y) {
  using std::expm1;
  if (y < kSmall && y > -kSmall) return 1.0 + 0.5 * y;
  return expm1(y) / y;
}

/// Returns ln(1 + z)/z.
template <typename T>
T LogOver(const T& z) {
  using std::log1p;
  if (z < kSmall && z > -kSmall) return 1.0 - 0.5 * z;
  return log1p(z) / z;
}

/// Returns the stiffness over σ, with the arithmetic of doubles or of Ceres' jets.
template <typename T>
T ReducedStiffness(const SweepOptions& options, const T& sigma, const T& alpha, const T& slip_force,
                   double amplitude) {
  using std::exp;
  using std::expm1;
  using std::log1p;
  constexpr double kSlips = 1e-14;  // 1 − τ below this is slip
  T log_rest = T(0.0);              // ln(1 − τ)
  T x = T(0.0);
  bool slips = false;
  if (options.over_force) {
    const T tau = amplitude / slip_force;
    slips = tau > 1.0 - kSlips;
    log_rest = log1p(slips ? T(kSlips - 1.0) : T(-tau));
    x = -log_rest * GrowthOver(T((1.0 - alpha) * log_rest));
  } else {
    x = sigma * amplitude / slip_force;
    const T z = -(1.0 - alpha) * x;
    slips = z <= -1.0 + kSlips;
    if (!slips) log_rest = -x * LogOver(z);
  }
  if (options.stiffness == SweepStiffness::kTangent) {
    if (slips) return T(0.0);
    return exp(alpha * log_rest);
  }
  return (slips && !options.over_force ? T(1.0) : T(-expm1(log_rest))) / x;
}

struct SweepResiduals {
  template <typename T>
  bool operator()(const T* log_sigma, const T* alpha, const T* log_slip_force, T* residuals) const {
    using std::exp;
    const T sigma = exp(*log_sigma);
    const T slip_force = exp(*log_slip_force);
    for (std::size_t i = 0; i < amplitude.size(); ++i) {
      T stiffness = sigma * ReducedStiffness(options, sigma, *alpha, slip_force, amplitude[i]);
      if (options.is_compliance) {
        constexpr double kLeast = 1e-9;  // of σ: a compliance that is not infinite
        if (stiffness < kLeast * sigma) stiffness = kLeast * sigma;
        stiffness = 1.0 / stiffness;
      }
      residuals[i] = (stiffness - response[i]) / scale;
    }
    return true;
  }

  std::span<const double> amplitude;
  std::span<const double> response;
  const SweepOptions& options;
  double scale;
};

struct Solved {
  Point point{};
  double sum_of_squares = std::numeric_limits<double>::infinity();  // over the scale²
  bool converged = false;
  std::string message;
};

class SweepProblem {
 public:
  SweepProblem(std::span<const double> amplitude, std::span<const double> response,
               const SweepOptions& options)
      : amplitude_(amplitude), response_(response), options_(options) {
    const auto [least, greatest] = std::ranges::minmax_element(response_);
    stiffness_ = options_.is_compliance ? 1.0 / *least : *greatest;
    scale_ = std::abs(*greatest);
    const double farthest = *std::ranges::max_element(amplitude_);
    force_ = options_.over_force ? farthest : 0.0;
    if (!options_.over_force) {
      for (std::size_t i = 0; i < amplitude_.size(); ++i) {
        const double k = options_.is_compliance ? 1.0 / response_[i] : response_[i];
        force_ = std::max(force_, amplitude_[i] * k);
      }
    }
    // A force that was reached is not above Tc.
    const double least_slip = options_.over_force ? force_ : force_ / kFarthestScale;
    lower_ = {std::log(stiffness_ / kFarthestScale), 0.0, std::log(least_slip)};
    upper_ = {std::log(stiffness_ * kFarthestScale), kLargestAlpha,
              std::log(force_ * kFarthestScale)};
    for (std::size_t k = 0; k < kSweepNames.size(); ++k) {
      const auto found = options_.fixed.find(kSweepNames[k]);
      if (found == options_.fixed.end()) continue;
      fixed_[k] = k == 1 ? found->second : std::log(found->second);
    }
  }

  [[nodiscard]] std::size_t free() const {
    return static_cast<std::size_t>(std::ranges::count_if(
        fixed_, [](const std::optional<double>& value) { return !value.has_value(); }));
  }
  [[nodiscard]] bool is_fixed(std::size_t k) const { return fixed_[k].has_value(); }
  [[nodiscard]] double lower(std::size_t k) const { return lower_[k]; }
  [[nodiscard]] double upper(std::size_t k) const { return upper_[k]; }
  /// True at a bound of the search, and not at one of the law: α = 0, and over forces the least Tc.
  [[nodiscard]] bool IsAtSearchBound(std::size_t k, double value) const {
    constexpr double kNearBoundOfSweep = 1e-6;
    return value >= upper_[k] - kNearBoundOfSweep ||
           (!IsLawBelow(k) && value <= lower_[k] + kNearBoundOfSweep);
  }
  /// True if the lower bound is the law's, not the search's.
  [[nodiscard]] bool IsLawBelow(std::size_t k) const {
    return k == 1 || (k == 2 && options_.over_force);
  }

  /// Returns the best fit from nine starts.
  [[nodiscard]] Solved Best() const {
    Solved best;
    for (const double alpha : {0.1, 1.0 / 3.0, 1.0}) {
      for (const double slip : {1.05, 1.5, 5.0}) {
        const Solved found =
            Solve({std::log(stiffness_), alpha, std::log(slip * force_)}, std::nullopt, 0.0);
        if (found.sum_of_squares < best.sum_of_squares) best = found;
      }
    }
    return best;
  }

  /// Returns the best fit near a point, with one coordinate held where that is given.
  [[nodiscard]] Solved Solve(Point start, std::optional<std::size_t> held, double value) const {
    for (std::size_t k = 0; k < start.size(); ++k) {
      start[k] = std::clamp(start[k], lower_[k], upper_[k]);
      if (fixed_[k]) start[k] = *fixed_[k];
    }
    if (held) start[*held] = value;
    ceres::Problem problem;
    AddResiduals(start, problem);
    for (std::size_t k = 0; k < start.size(); ++k) {
      if (fixed_[k] || k == held) {
        problem.SetParameterBlockConstant(&start[k]);
        continue;
      }
      problem.SetParameterLowerBound(&start[k], 0, lower_[k]);
      problem.SetParameterUpperBound(&start[k], 0, upper_[k]);
    }
    ceres::Solver::Options solver;
    solver.linear_solver_type = ceres::DENSE_QR;
    solver.logging_type = ceres::SILENT;
    solver.function_tolerance = 1e-14;
    solver.parameter_tolerance = 1e-12;
    solver.gradient_tolerance = 1e-16;
    solver.max_num_iterations = 200;
    ceres::Solver::Summary summary;
    ceres::Solve(solver, &problem, &summary);
    return {.point = start,
            .sum_of_squares = 2 * summary.final_cost,
            .converged = summary.termination_type == ceres::CONVERGENCE,
            .message = summary.message};
  }

  /// Returns the standard deviations of the coordinates for a unit variance; empty where a
  /// coordinate is held or the matrix has not the rank.
  [[nodiscard]] std::array<std::optional<double>, 3> Errors(Point at) const {
    ceres::Problem problem;
    AddResiduals(at, problem);
    const auto is_held = [&](std::size_t k) {
      return fixed_[k] || at[k] <= lower_[k] || at[k] >= upper_[k];
    };
    std::vector<const double*> blocks;
    for (std::size_t k = 0; k < at.size(); ++k) {
      if (is_held(k)) {
        problem.SetParameterBlockConstant(&at[k]);
      } else {
        blocks.push_back(&at[k]);
      }
    }
    std::array<std::optional<double>, 3> errors;
    ceres::Covariance::Options options;
    options.algorithm_type = ceres::DENSE_SVD;
    ceres::Covariance covariance(options);
    if (blocks.empty() || !covariance.Compute(blocks, &problem)) return errors;
    for (std::size_t k = 0; k < at.size(); ++k) {
      double variance = 0.0;
      if (is_held(k) || !covariance.GetCovarianceBlock(&at[k], &at[k], &variance)) continue;
      if (std::isfinite(variance) && variance > 0) errors[k] = std::sqrt(variance);
    }
    return errors;
  }

 private:
  /// @param at  parameter blocks, which must outlive the problem
  void AddResiduals(Point& at, ceres::Problem& problem) const {
    using Cost = ceres::AutoDiffCostFunction<SweepResiduals, ceres::DYNAMIC, 1, 1, 1>;
    problem.AddResidualBlock(new Cost(new SweepResiduals{amplitude_, response_, options_, scale_},
                                      static_cast<int>(amplitude_.size())),
                             nullptr, &at[0], &at[1], &at[2]);
  }

  std::span<const double> amplitude_;
  std::span<const double> response_;
  const SweepOptions& options_;
  double stiffness_ = 0.0;  // [N/m], the greatest
  double force_ = 0.0;      // [N], likewise
  double scale_ = 1.0;      // of the response
  Point lower_{};
  Point upper_{};
  std::array<std::optional<double>, 3> fixed_;
};

/// Returns the end of the profile's interval in one direction; empty where it does not close before
/// the bound.
std::optional<double> IntervalEnd(const SweepProblem& problem, const Solved& best, std::size_t k,
                                  double limit, double step, double bound) {
  const double sign = bound > best.point[k] ? 1.0 : -1.0;
  double inside = best.point[k];
  Point near = best.point;
  const auto exceeds = [&](double value) {
    const Solved found = problem.Solve(near, k, value);
    if (found.sum_of_squares <= limit) near = found.point;
    return found.sum_of_squares > limit;
  };
  double outside = inside;
  bool is_closed = false;
  for (; !is_closed; step *= 2) {
    outside = sign > 0 ? std::min(inside + step, bound) : std::max(inside - step, bound);
    if (exceeds(outside)) {
      is_closed = true;
    } else if (outside == bound) {
      return std::nullopt;
    } else {
      inside = outside;
    }
  }
  constexpr int kHalvings = 20;  // to a millionth of the step
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (inside + outside);
    (exceeds(middle) ? outside : inside) = middle;
  }
  // Small amplitudes determine α/Tc alone: an end of one of the two that the bound of the search
  // for the other makes is none of the data.
  if (k > 0) {
    const std::size_t other = 3 - k;
    if (!problem.is_fixed(other) && problem.IsAtSearchBound(other, near[other])) {
      return std::nullopt;
    }
  }
  return 0.5 * (inside + outside);
}

/// Two-sided chance of the correlation r₁ of neighbours, of which √n·r₁ is normal for white noise.
double CorrelationPValue(std::span<const double> amplitude, std::span<const double> residuals) {
  std::vector<std::size_t> order(amplitude.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::sort(order, {}, [&](std::size_t i) { return amplitude[i]; });
  double products = 0.0;
  double squares = 0.0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const double residual = residuals[order[k]];
    squares += residual * residual;
    if (k > 0) products += residual * residuals[order[k - 1]];
  }
  if (!(squares > 0)) return 1.0;
  const double z = std::abs(products / squares) * std::sqrt(static_cast<double>(amplitude.size()));
  return std::erfc(z / std::numbers::sqrt2);
}

Identifiability VerdictOf(const ParameterEstimate& parameter) {
  if (parameter.lower95 && parameter.upper95) return Identifiability::kIdentifiable;
  if (parameter.lower95 && *parameter.lower95 > 0) return Identifiability::kBoundedBelow;
  return Identifiability::kNotIdentifiable;
}

}  // namespace

const ParameterEstimate& SweepFit::parameter(std::string_view name) const {
  const auto found = std::ranges::find(parameters, name, &ParameterEstimate::name);
  if (found == parameters.end())
    throw InvalidArgument("no parameter of a sweep: " + std::string(name));
  return *found;
}

double SweepStiffnessAt(const SweepOptions& options, double sigma, double alpha, double slip_force,
                        double amplitude) {
  for (const double value : {sigma, slip_force, amplitude}) {
    RequirePositive("stiffness [N/m], slip force [N] or amplitude", value);
  }
  RequireNonNegative("shape exponent [-]", alpha);
  return sigma * ReducedStiffness(options, sigma, alpha, slip_force, amplitude);
}

SweepFit FitSweep(std::span<const double> amplitude, std::span<const double> response,
                  const SweepOptions& options) {
  RequireSameSize("amplitudes", amplitude.size(), "responses", response.size());
  for (const double value : amplitude) RequirePositive("amplitude of a sweep", value);
  for (const double value : response) RequirePositive("response of a sweep", value);
  for (const auto& [name, value] : options.fixed) {
    if (std::ranges::find(kSweepNames, name) == kSweepNames.end()) {
      throw InvalidArgument("a sweep has no parameter " + name +
                            ": sigma, alpha and slip_force are its own");
    }
    if (!std::isfinite(value) || value < 0 || (value == 0 && name != "alpha")) {
      ThrowInvalid(name.c_str(), value, "must be finite and > 0, alpha >= 0");
    }
  }
  const SweepProblem problem(amplitude, response, options);
  const std::size_t free = problem.free();
  if (amplitude.size() <= free) {
    ThrowInvalid("points of a sweep [-]", static_cast<double>(amplitude.size()),
                 "must be more than there are free parameters");
  }
  const Solved best = problem.Best();
  SweepFit fit;
  fit.converged = best.converged;
  fit.message = best.message;
  fit.degrees_of_freedom = amplitude.size() - free;
  const auto degrees = static_cast<double>(fit.degrees_of_freedom);
  const double sigma = std::exp(best.point[0]);
  const double slip_force = std::exp(best.point[2]);
  std::vector<double> residuals;
  double mean = 0.0;
  for (const double value : response) mean += value / static_cast<double>(response.size());
  double squares = 0.0;
  double about_mean = 0.0;
  for (std::size_t i = 0; i < amplitude.size(); ++i) {
    const double stiffness =
        sigma * ReducedStiffness(options, sigma, best.point[1], slip_force, amplitude[i]);
    fit.fitted.push_back(options.is_compliance ? 1.0 / stiffness : stiffness);
    residuals.push_back(response[i] - fit.fitted.back());
    squares += residuals.back() * residuals.back();
    about_mean += (response[i] - mean) * (response[i] - mean);
  }
  fit.rms = std::sqrt(squares / static_cast<double>(amplitude.size()));
  fit.r_squared = about_mean > 0 ? 1 - squares / about_mean : 1.0;
  fit.correlation_p_value = CorrelationPValue(amplitude, residuals);

  // Sums of squares are over the scale², and so is the variance.
  const double variance = best.sum_of_squares / degrees;
  const double quantile_of_one = FQuantile(1, degrees, 1 - options.confidence);
  const double limit = best.sum_of_squares + quantile_of_one * variance;
  const std::array<std::optional<double>, 3> errors = problem.Errors(best.point);
  for (std::size_t k = 0; k < kSweepNames.size(); ++k) {
    const bool is_log = k != 1;
    const auto value_of = [&](double coordinate) {
      return is_log ? std::exp(coordinate) : coordinate;
    };
    ParameterEstimate estimate;
    estimate.name = kSweepNames[k];
    estimate.unit = kUnits[k];
    estimate.value = value_of(best.point[k]);
    if (problem.is_fixed(k)) {
      estimate.status = ParameterStatus::kFixed;
      fit.parameters.push_back(std::move(estimate));
      continue;
    }
    constexpr double kAtBound = 1e-9;
    estimate.status = best.point[k] <= problem.lower(k) + kAtBound ? ParameterStatus::kAtLowerBound
                      : best.point[k] >= problem.upper(k) - kAtBound
                          ? ParameterStatus::kAtUpperBound
                          : ParameterStatus::kFree;
    constexpr double kFirstStep = 1e-3;  // of a coordinate that has no standard error
    const double error = errors[k].value_or(0.0) * std::sqrt(variance);
    const double step = error > 0 && std::isfinite(error) ? error : kFirstStep;
    if (estimate.status == ParameterStatus::kFree && error > 0) {
      estimate.standard_error = is_log ? estimate.value * error : error;
    }
    const auto end_at = [&](double bound) -> std::optional<double> {
      const auto end = IntervalEnd(problem, best, k, limit, step, bound);
      return end ? std::optional(value_of(*end)) : std::nullopt;
    };
    if (estimate.status != ParameterStatus::kAtLowerBound) {
      estimate.lower95 = end_at(problem.lower(k));
    }
    if (estimate.status != ParameterStatus::kAtUpperBound) {
      estimate.upper95 = end_at(problem.upper(k));
    }
    if (!estimate.lower95 && problem.IsLawBelow(k)) estimate.lower95 = value_of(problem.lower(k));
    estimate.identifiability = VerdictOf(estimate);
    fit.parameters.push_back(std::move(estimate));
  }
  return fit;
}

}  // namespace mindahl::identification
