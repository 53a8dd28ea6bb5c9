#include "identification/inference/backlash_trial.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <vector>

#include "core/probability.h"
#include "identification/inference/evidence.h"

namespace mindahl::identification {
namespace {

/// θ of least cost among stiffer contacts: what was the gap's was taken for theirs.
std::vector<double> StifferLook(std::span<const double> theta, const Parameters& parameters,
                                Solver& solver) {
  constexpr std::array kStiffer = {1.0, 2.0, 4.0, 8.0, 16.0};
  const std::array shapes = {theta[kShape], 0.0, 1.0 / 3, 1.0};
  std::vector<double> best(theta.begin(), theta.end());
  double least = std::numeric_limits<double>::infinity();
  for (const double shape : shapes) {
    if (parameters[kShape].fixed && shape != theta[kShape]) continue;
    for (const double factor : kStiffer) {
      std::vector<double> look(theta.begin(), theta.end());
      look[kShape] = std::clamp(shape, parameters[kShape].lower, parameters[kShape].upper);
      look[kStiffness] =
          std::min(look[kStiffness] + std::log(factor), parameters[kStiffness].upper);
      const double cost = solver.CostAt(look);
      if (!(cost < least)) continue;
      least = cost;
      best = look;
    }
  }
  return best;
}

}  // namespace

void TryBacklash(const Problem& problem, const Solution& solution,
                 std::span<const std::optional<loop::Backlash>> gaps, const SolverOptions& options,
                 SearchBuffers& buffers, AdequacyTest& test) {
  const bool all = std::ranges::all_of(gaps, [](const auto& gap) { return gap.has_value(); });
  if (gaps.empty() || !all || problem.parameters.moves_contact()) return;
  const auto has = [](std::string_view code) {
    return [code](const DepartureFit& tried) { return Departures()[tried.departure].code == code; };
  };
  if (std::ranges::none_of(test.fits, has("backlash"))) return;
  std::erase_if(test.fits, has("force_saturates"));
  const auto fit = std::ranges::find_if(test.fits, has("backlash"));
  Problem behind = problem;
  const std::size_t gap = problem.parameters.PositionOf("backlash", 0);
  std::vector<double> start = solution.theta;
  start[gap] = behind.parameters[gap].ToTheta(gaps.front()->width);
  behind.parameters.Release(gap);
  behind.parameters.Fix(gap, start[gap]);
  Solution after;
  buffers.solver.Bind(behind, buffers.response);
  start = StifferLook(start, behind.parameters, buffers.solver);
  buffers.solver.Solve(start, options, after);
  buffers.response.Bind(problem);
  const double before = solution.sum_of_squares;
  fit->size = gaps.front()->width;
  fit->size_p_value = 0.0;
  fit->unit = Departures()[fit->departure].unit;
  fit->is_measured = true;
  const auto& free = problem.parameters.free();
  fit->step.resize(free.size(), 0.0);
  fit->error.resize(free.size(), 0.0);
  // Other effects in addition to the gap may leave a fit behind it no better than one without.
  if (!after.converged || !(after.sum_of_squares < before)) return;
  const Evidence evidence(problem.data->counted, test.effective_samples);
  fit->explains = 1 - after.sum_of_squares / before;
  fit->delta_aicc = 2 - evidence.LikelihoodRatio(before, after.sum_of_squares);
  fit->p_value =
      PValueOfF(evidence.FStatistic(before, after.sum_of_squares, test.noise * test.noise),
                test.degrees_of_freedom);
  for (std::size_t j = 0; j < free.size(); ++j) {
    fit->step[j] = after.theta[free[j]] - solution.theta[free[j]];
  }
}

}  // namespace mindahl::identification
