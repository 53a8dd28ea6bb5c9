#include "mindahl/tradeoff/recommendation.h"

#include <algorithm>
#include <cmath>

#include "mindahl/core/error.h"
#include "mindahl/tradeoff/cost_model.h"
#include "mindahl/tradeoff/refit.h"
#include "tradeoff/cycle_count.h"

namespace mindahl::tradeoff {
namespace {

/// Fraction of a cycle below which a number of cycles is whole.
constexpr double kRounding = 1e-9;

void RequireRecommendOptions(const RecommendOptions& options) {
  RequirePositive("tolerance [-]", options.tolerance);
  if (options.largest_cost) RequirePositive("largest cost [ns/sample]", *options.largest_cost);
}

/// Returns the sample from which |ΔT| stays within the tolerance, as whole cycles.
std::optional<std::size_t> SettlesAfter(const ReferenceResponse& reference,
                                        std::span<const double> force,
                                        std::span<const double> cycles, double tolerance) {
  const double allowed = tolerance * reference.peak_force;
  std::size_t settled = force.size();
  while (settled > 0 && std::abs(force[settled - 1] - reference.force[settled - 1]) <= allowed) {
    --settled;
  }
  if (settled == 0) return 0;
  const double after = std::ceil(cycles[settled - 1] - kRounding);
  if (after + 1 > cycles.back() + kRounding) return std::nullopt;
  return static_cast<std::size_t>(after);
}

/// Returns the most precise of those within the limit of cost; of equals the cheaper.
std::optional<std::size_t> MostPrecise(const std::vector<Candidate>& candidates,
                                       Criterion criterion) {
  std::optional<std::size_t> best;
  const auto error = [&](std::size_t i) {
    return ErrorBy(criterion, candidates[i].point.precision);
  };
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!candidates[i].meets) continue;
    const bool better =
        !best || error(i) < error(*best) ||
        (error(i) == error(*best) && candidates[i].point.cost < candidates[*best].point.cost);
    if (better) best = i;
  }
  return best;
}

}  // namespace

Recommendation Recommend(const models::BranchLaw& law, const methods::Drive& drive,
                         const RecommendOptions& options) {
  RequireRecommendOptions(options);
  const ReferenceResponse reference = MakeReferenceResponse(law, drive);
  const std::vector<double> cycles = CyclesPassed(drive.displacement);
  const auto transient = static_cast<double>(options.transient_cycles);
  const auto first = static_cast<std::size_t>(
      std::ranges::lower_bound(cycles, transient - kRounding) - cycles.begin());
  if (first >= cycles.size()) {
    ThrowInvalid("transient cycles [-]", transient, "must be fewer than the cycles of the drive");
  }

  Recommendation result;
  result.floor = ModelledCostFloor();
  result.peak_force = reference.peak_force;
  result.cycles = cycles.back();
  const std::vector<Approximation> ladder = AllApproximationsAlong(law, drive, reference, first);
  std::vector<double> force(drive.displacement.size());
  for (const Approximation& approximation : ladder) {
    const WorkPrecision point = Assess(approximation, law, drive, reference, force, first);
    const double error = ErrorBy(options.criterion, point.precision);
    const bool meets =
        options.largest_cost ? point.cost <= *options.largest_cost : error <= options.tolerance;
    const auto settles_after = SettlesAfter(reference, force, cycles, options.tolerance);
    result.candidates.push_back({point, meets, settles_after});
  }
  const std::string exact_model = ExactModel(law);
  for (std::size_t i = 0; i < ladder.size(); ++i) {
    if (ladder[i].model == exact_model && ladder[i].method == "exact") result.exact = i;
  }
  if (options.largest_cost) {
    result.choice = MostPrecise(result.candidates, options.criterion);
    return result;
  }
  std::vector<double> costs;
  costs.reserve(result.candidates.size());
  for (const Candidate& candidate : result.candidates) costs.push_back(candidate.point.cost);
  result.choice = CheapestOf(costs, [&](std::size_t i) { return result.candidates[i].meets; });
  // Simpler is what stands before it in the ladder.
  const std::size_t simpler = std::min(result.choice.value_or(result.exact), result.exact);
  result.after_transient = CheapestOf(costs, [&](std::size_t i) {
    const Candidate& candidate = result.candidates[i];
    return i < simpler && !candidate.meets && candidate.settles_after.value_or(0) > 0;
  });
  return result;
}

}  // namespace mindahl::tradeoff
