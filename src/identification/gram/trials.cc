#include "identification/gram/trials.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory_resource>
#include <string_view>
#include <utility>
#include <vector>

#include "core/probability.h"
#include "identification/inference/noise.h"
#include "identification/problem/moved_samples.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {

namespace {

std::vector<DepartureFit>::iterator FindFit(AdequacyTest& test, std::string_view code) {
  return std::ranges::find_if(test.fits, [code](const DepartureFit& tried) {
    return Departures()[tried.departure].code == code;
  });
}

/// Puts what a term explains, everything else searched again, in the place of what its first order
/// does. The first order did not determine the errors.
/// @param data    the samples of both fits, which may be fewer than those of the test
/// @param before  sum of squares without the term
/// @param free    positions of the parameters that the test had
/// @param theta   from which these are moved
void PutInPlace(const ScaledRecords& data, double before, const Solution& after,
                std::span<const std::size_t> free, std::span<const double> theta,
                const AdequacyTest& test, DepartureFit& fit) {
  const Evidence evidence(data.counted, test.effective_samples);
  fit.explains = 1 - after.sum_of_squares / before;
  fit.delta_aicc = 2 - evidence.LikelihoodRatio(before, after.sum_of_squares);
  fit.p_value =
      PValueOfF(evidence.FStatistic(before, after.sum_of_squares, test.noise * test.noise),
                test.degrees_of_freedom);
  for (std::size_t j = 0; j < free.size(); ++j) fit.step[j] = after.theta[free[j]] - theta[free[j]];
}

/// Keeps the θ of least cost of those that it is shown.
class CheapestLook {
 public:
  CheapestLook(std::span<const double> theta, Solver& solver)
      : solver_(solver), theta_(theta.begin(), theta.end()) {}

  /// @param theta  kept with the linear parameters that are best beside the others
  void See(std::vector<double> theta) {
    const double cost = solver_.CostAt(theta);
    if (!(cost < cost_)) return;
    cost_ = cost;
    theta_ = std::move(theta);
  }
  [[nodiscard]] const std::vector<double>& theta() const { return theta_; }

 private:
  Solver& solver_;
  std::vector<double> theta_;
  double cost_ = std::numeric_limits<double>::infinity();
};

/// θ of least cost among stiffer contacts: what was the gap's was taken for theirs.
std::vector<double> StifferLook(std::span<const double> theta, const Parameters& parameters,
                                Solver& solver) {
  constexpr std::array kStiffer = {1.0, 2.0, 4.0, 8.0, 16.0};
  CheapestLook cheapest(theta, solver);
  for (const double shape : {theta[kShape], 0.0, 1.0 / 3, 1.0}) {
    if (parameters[kShape].fixed && shape != theta[kShape]) continue;
    for (const double factor : kStiffer) {
      std::vector<double> look(theta.begin(), theta.end());
      look[kShape] = std::clamp(shape, parameters[kShape].lower, parameters[kShape].upper);
      look[kStiffness] =
          std::min(look[kStiffness] + std::log(factor), parameters[kStiffness].upper);
      cheapest.See(std::move(look));
    }
  }
  return cheapest.theta();
}

}  // namespace

void TryBacklash(const Problem& problem, const Solution& solution,
                 std::span<const std::optional<loop::Backlash>> gaps, const SolverOptions& options,
                 SearchBuffers& buffers, AdequacyTest& test) {
  const bool all = std::ranges::all_of(gaps, [](const auto& gap) { return gap.has_value(); });
  if (gaps.empty() || !all || problem.parameters.moves_contact()) return;
  if (FindFit(test, "backlash") == test.fits.end()) return;
  const auto saturation = FindFit(test, "force_saturates");
  if (saturation != test.fits.end()) test.fits.erase(saturation);
  const auto fit = FindFit(test, "backlash");
  Problem behind = problem;
  const std::size_t gap = problem.parameters.PositionOf(TermId::kBacklash, 0);
  std::vector<double> start = solution.theta;
  start[gap] = behind.parameters[gap].ToTheta(gaps.front()->width);
  behind.parameters.Release(gap);
  behind.parameters.Fix(gap, start[gap]);
  Solution after;
  buffers.solver.Bind(behind, buffers.response);
  start = StifferLook(start, behind.parameters, buffers.solver);
  buffers.solver.Solve(start, options, after);
  buffers.response.Bind(problem);
  fit->size = gaps.front()->width;
  fit->size_p_value = 0.0;
  fit->unit = Departures()[fit->departure].unit;
  fit->is_measured = true;
  const auto& free = problem.parameters.free();
  fit->step.resize(free.size(), 0.0);
  // Other effects in addition to the gap may leave a fit behind it no better than one without.
  if (!after.converged || !(after.sum_of_squares < solution.sum_of_squares)) return;
  PutInPlace(*problem.data, solution.sum_of_squares, after, free, solution.theta, test, *fit);
}

namespace {

/// Samples so near to an end that a lag may reach beyond it do not count.
/// @param longest  lag, in units of the first record's time
void LeaveOutEnds(ScaledRecords& data, double longest) {
  data.counted = 0;
  for (ScaledRecord& record : data.records) {
    const double within = longest / record.units.half_duration;
    for (std::size_t i = 0; i < record.size(); ++i) {
      const double to_end =
          std::min(record.clock[i] - record.clock.front(), record.clock.back() - record.clock[i]);
      if (to_end < within) record.counts[i] = 0;
      if (record.counts[i] == 0) record.root_weight[i] = 0.0;
      data.counted += record.counts[i];
    }
  }
}

/// θ with the lag of least cost, everything that is not linear as it was.
std::vector<double> BestLook(std::span<const double> theta, std::size_t lag,
                             const Parameter& parameter, Solver& solver) {
  constexpr std::array kShares = {0.06, 0.15, 0.3, 0.6, 1.0};  // of the longest
  CheapestLook cheapest(theta, solver);
  std::vector<double> look(theta.begin(), theta.end());
  cheapest.See(look);
  for (const double end : {parameter.lower, parameter.upper}) {
    for (const double share : kShares) {
      look[lag] = share * end;
      cheapest.See(look);
    }
  }
  return cheapest.theta();
}

}  // namespace

void TryLag(const Problem& problem, const Solution& solution, const SolverOptions& options,
            SearchBuffers& buffers, AdequacyTest& test) {
  const auto fit = FindFit(test, "channel_lag");
  if (fit == test.fits.end() || problem.parameters.moves_contact()) return;
  ScaledRecords data(*problem.data);
  if (!MayHaveClocks(data)) return;
  SetClocks(data);
  Problem without = problem;
  without.data = &data;
  Problem with = without;
  const std::size_t lag = problem.parameters.PositionOf(TermId::kLag, 0);
  with.parameters.Release(lag);
  // Longer ones are looked for where they are asked for: a knee that depends on the speed is like a
  // lag of a tenth of a cycle too.
  with.parameters.KeepWithin(lag, TermOf(TermId::kLag).highest);
  const Parameter& parameter = with.parameters[lag];
  LeaveOutEnds(data, parameter.scale * std::max(-parameter.lower, parameter.upper));
  if (data.counted <= 2 * with.parameters.free().size()) return;

  Solution before;
  buffers.solver.Bind(without, buffers.response);
  buffers.solver.Solve(solution.theta, options, before);
  Solution after;
  buffers.solver.Bind(with, buffers.response);
  buffers.solver.Solve(BestLook(before.theta, lag, parameter, buffers.solver), options, after);
  buffers.response.Bind(problem);
  if (!before.converged || !after.converged || !(before.sum_of_squares > 0)) return;
  if (!(1 - after.sum_of_squares / before.sum_of_squares > fit->explains)) return;

  fit->size = parameter.ToValue(after.theta[lag]);
  const bool timed = !data.records.front().velocity.empty();
  fit->unit = timed ? parameter.term->unit : parameter.term->unit_by_sample;
  const auto& free = problem.parameters.free();
  fit->step.resize(free.size(), 0.0);
  PutInPlace(data, before.sum_of_squares, after, free, solution.theta, test, *fit);
}

}  // namespace mindahl::identification
