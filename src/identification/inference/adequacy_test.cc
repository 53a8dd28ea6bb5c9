#include "identification/inference/adequacy_test.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "core/probability.h"
#include "identification/inference/column_test.h"
#include "identification/inference/evidence.h"
#include "identification/intervals.h"

namespace mindahl::identification {
namespace {

/// Returns the Jacobian without the columns of parameters at a bound, the user's or the program's:
/// what these would still explain, they may not.
Eigen::MatrixXd WithoutBounds(const Problem& problem, const Solution& solution,
                              Eigen::MatrixXd jacobian) {
  const auto& free = problem.parameters.free();
  for (std::size_t j = 0; j < free.size(); ++j) {
    if (solution.side[free[j]] != BoundSide::kInside) {
      jacobian.col(static_cast<Eigen::Index>(j)).setZero();
    }
  }
  return jacobian;
}

/// Tests the columns of all omitted terms together, and those of each.
AdequacyTest Ask(const Problem& problem, const ColumnTest& columns,
                 const DepartureColumns& departures, double before, const Thresholds& thresholds) {
  AdequacyTest test;
  test.noise = std::sqrt(columns.variance());
  test.degrees_of_freedom = columns.degrees_of_freedom();
  if (!columns.can_tell()) return test;
  test.p_value = columns.p_value();
  test.misfit_over_noise = columns.misfit_over_noise();
  test.effective_samples = columns.effective_samples();

  const Evidence evidence(problem.data->counted, columns.effective_samples());
  for (std::size_t group = 0; group < departures.groups; ++group) {
    std::vector<Eigen::Index> places;
    for (std::size_t c = 0; c < departures.group.size(); ++c) {
      if (departures.group[c] == group) places.push_back(static_cast<Eigen::Index>(c));
    }
    const ColumnTest::Part part = columns.Ask(places);
    if (part.columns == 0) continue;
    const auto first = static_cast<std::size_t>(places[0]);
    DepartureFit fit;
    fit.departure = departures.of[first];
    const std::size_t plain = departures.of.size() - departures.covariates.size();
    if (first >= plain) fit.covariate = departures.covariates[first - plain];
    fit.p_value = part.p_value;
    if (fit.p_value < thresholds.cause) {
      LinearStep step = columns.Step(places);
      fit.explains = step.explains;
      fit.size = step.size * departures.unit_of_size[first];
      fit.size_p_value = fit.p_value;
      if (places.size() > 1) {
        const double errors = step.size_error > 0 ? step.size / step.size_error : 0.0;
        fit.size_p_value = PValueOfF(errors * errors, columns.degrees_of_freedom());
      }
      fit.step = std::move(step.step);
      fit.error = std::move(step.error);
      const Departure& departure = Departures()[fit.departure];
      fit.unit = departures.timed || departure.unit_by_sample.empty() ? departure.unit
                                                                      : departure.unit_by_sample;
      const double after = before * (1 - fit.explains);
      fit.delta_aicc =
          2 * static_cast<double>(part.columns) - evidence.LikelihoodRatio(before, after);
    }
    test.fits.push_back(std::move(fit));
  }
  return test;
}

/// True if noise makes what was found rarely, and not so rarely that what the columns took up of
/// its autocorrelation could not matter.
bool IsOnTheEdge(const AdequacyTest& test) {
  constexpr double kClear = 1e-12;
  constexpr double kRare = 0.05;
  double least = test.p_value;
  for (const DepartureFit& fit : test.fits) {
    least = std::min(least, static_cast<double>(test.fits.size()) * fit.p_value);
  }
  return 2 * least < kRare && least > kClear;
}

}  // namespace

AdequacyTest TestAdequacy(const FittedProblem& fitted, const DisplacementEffect& displacement,
                          const Thresholds& thresholds, Response& response) {
  const auto& [problem, solution, noise, estimates] = fitted;
  const Eigen::MatrixXd jacobian = WithoutBounds(problem, solution, estimates.jacobian());
  const Eigen::VectorXd& residual = estimates.residual();
  const auto samples = static_cast<double>(problem.data->counted);
  if (samples <= static_cast<double>(jacobian.cols()) + 1) return {};
  const std::size_t most =
      (problem.data->counted - problem.parameters.free().size()) / kSamplesAColumn;
  const DepartureColumns departures = ColumnsOfDepartures(problem, solution.theta, response, most);
  const double before = residual.squaredNorm();
  const ColumnTest columns(problem, noise, displacement, jacobian, departures.columns, residual);
  AdequacyTest test = Ask(problem, columns, departures, before, thresholds);
  if (!columns.is_correlated() || !IsOnTheEdge(test)) return test;
  // So many columns take up most of what is slow in the noise, and what they left of it would call
  // the slow improbable.
  const ColumnTest restored(problem, noise, displacement, jacobian, departures.columns, residual,
                            nullptr, /*restores=*/true);
  return Ask(problem, restored, departures, before, thresholds);
}

namespace {

/// Returns the place of a parameter among those that are free, their number where it is not.
std::size_t PlaceAmongFree(const Problem& problem, std::size_t parameter) {
  const auto& free = problem.parameters.free();
  return static_cast<std::size_t>(std::ranges::find(free, parameter) - free.begin());
}

}  // namespace

double MoveOf(const Problem& problem, const Solution& solution, const DepartureFit& fit,
              std::size_t parameter, const ParameterEstimate& estimate) {
  const std::size_t place = PlaceAmongFree(problem, parameter);
  if (place == fit.step.size() || !estimate.lower95 || !estimate.upper95) return 0.0;
  const double half = (*estimate.upper95 - *estimate.lower95) / 2;
  const double moved =
      problem.parameters[parameter].ToValue(solution.theta[parameter] + fit.step[place]);
  return half > 0 ? std::abs(moved - estimate.value) / half : 0.0;
}

void WidenByDepartures(const Problem& problem, const Solution& solution,
                       std::span<const DepartureFit> fits, double quantile,
                       std::span<ParameterEstimate> estimates) {
  const auto& reported = problem.parameters.reported();
  for (std::size_t k = 0; k < reported.size(); ++k) {
    const std::size_t p = reported[k];
    const Parameter& parameter = problem.parameters[p];
    ParameterEstimate& estimate = estimates[k];
    const std::size_t place = PlaceAmongFree(problem, p);
    for (const DepartureFit& fit : fits) {
      if (place == fit.step.size()) continue;
      // Beyond a factor of e³ a linear step says only that little is known; short of it, it errs
      // by the like of its square.
      constexpr double kFarthest = 3.0;
      const double step = std::clamp(fit.step[place], -kFarthest, kFarthest);
      // σ and Tc are in proportion to the force; parts of the record may have their own.
      const bool is_of_force = p == kStiffness || p == kSlipForce;
      const double apart = Departures()[fit.departure].apart * std::abs(fit.size);
      const double half = quantile * std::min(fit.error[place], kFarthest) +
                          std::min(step * step, kFarthest) +
                          (is_of_force ? std::min(apart, kFarthest) : 0.0);
      const double one = parameter.ToValue(solution.theta[p] + step - half);
      const double other = parameter.ToValue(solution.theta[p] + step + half);
      const auto [lower, upper] = std::minmax(one, other);
      Include(estimate, {.source = IntervalSource::kOmittedTerms,
                         .lower = p == kShape ? std::max(lower, 0.0) : lower,
                         .upper = upper});
    }
  }
}

}  // namespace mindahl::identification
