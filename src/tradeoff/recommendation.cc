#include "mindahl/tradeoff/recommendation.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/least_of.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/response.h"
#include "mindahl/tradeoff/approximation.h"

namespace mindahl::tradeoff {

std::vector<double> CyclesPassed(std::span<const double> displacement) {
  constexpr double kQuarter = 0.25;
  constexpr double kHalf = 0.5;
  std::vector<double> way = {0.0};  // the contact is unloaded there, wherever samples begin
  way.insert(way.end(), displacement.begin(), displacement.end());
  const std::vector<std::size_t> reversals = loop::FindReversals(way, 0.0);
  std::vector<double> extremes = {0.0};
  for (const std::size_t reversal : reversals) extremes.push_back(way[reversal]);
  // The last swing is not over: it is taken to be as long as the one before, or twice the first,
  // and without a reversal to end at the last sample.
  const double last = extremes.back();
  extremes.push_back(reversals.empty()       ? way.back()
                     : reversals.size() == 1 ? -last
                                             : extremes[extremes.size() - 2]);

  std::vector<double> cycles;
  cycles.reserve(displacement.size());
  std::size_t swing = 0;
  for (std::size_t i = 1; i < way.size(); ++i) {
    while (swing < reversals.size() && reversals[swing] < i) ++swing;
    const double length = std::abs(extremes[swing + 1] - extremes[swing]);
    const double done = std::abs(way[i] - extremes[swing]);
    const double share = length > 0 ? std::min(done / length, 1.0) : 1.0;
    const double before = swing == 0 ? 0.0 : kQuarter + kHalf * static_cast<double>(swing - 1);
    cycles.push_back(before + (swing == 0 ? kQuarter : kHalf) * share);
  }
  return cycles;
}

using methods::Drive;
using models::BranchLaw;
using models::FrictionModel;

namespace {

/// The exact response as a model is fitted to it.
struct Target {
  const Drive& drive;
  std::span<const double> force;  // [N], of every sample
  std::size_t first;              // from which they count
};

/// Forces are homogeneous of degree one in (σ, Tc): the factor on both that suits best.
struct Scaled {
  double factor = 0.0;
  double sum_of_squares = 0.0;  // [N²], of what is left
};

Scaled ScaleTo(const Target& target, std::span<const double> force) {
  double squares = 0.0;
  double product = 0.0;
  for (std::size_t i = target.first; i < force.size(); ++i) {
    squares += force[i] * force[i];
    product += force[i] * target.force[i];
  }
  Scaled scaled;
  if (squares > 0) scaled.factor = product / squares;
  for (std::size_t i = target.first; i < force.size(); ++i) {
    const double residual = scaled.factor * force[i] - target.force[i];
    scaled.sum_of_squares += residual * residual;
  }
  return scaled;
}

BranchLaw Times(const BranchLaw& law, double factor) {
  return {law.tangential_stiffness * factor, law.shape_exponent, law.slip_force * factor};
}

/// Steps of Gauss and Newton in ln σ and ln Tc while they gain: where a model can follow the
/// target they end within rounding of it, which a minimum alone does not.
class Polish {
 public:
  Polish(const Target& target, const FrictionModel& model, const models::LoadingPath& path)
      : target_(target),
        model_(model),
        path_(path),
        force_(target.force.size()),
        gradient_(target.force.size() * models::kGradientColumns) {}

  BranchLaw From(BranchLaw law) {
    constexpr int kMostSteps = 30;
    double cost = Differentiate(law);
    for (int i = 0; i < kMostSteps; ++i) {
      const std::optional<BranchLaw> next = Step(law);
      if (!next) break;
      const double next_cost = Differentiate(*next);
      if (!(next_cost < cost)) break;
      law = *next;
      cost = next_cost;
    }
    return law;
  }

 private:
  /// Returns Σr² [N²].
  double Differentiate(const BranchLaw& law) {
    EvaluateForceAndGradient(model_, law, path_, target_.drive.displacement, force_, gradient_);
    double squares = 0.0;
    for (std::size_t i = target_.first; i < force_.size(); ++i) {
      squares += (force_[i] - target_.force[i]) * (force_[i] - target_.force[i]);
    }
    return squares;
  }

  [[nodiscard]] std::optional<BranchLaw> Step(const BranchLaw& law) const {
    double ss = 0.0;
    double st = 0.0;
    double tt = 0.0;
    double rs = 0.0;
    double rt = 0.0;
    for (std::size_t i = target_.first; i < force_.size(); ++i) {
      const double* row = &gradient_[i * models::kGradientColumns];
      const double by_stiffness = row[models::kPerLogStiffness];
      const double by_slip = row[models::kPerLogSlipForce];
      const double residual = force_[i] - target_.force[i];
      ss += by_stiffness * by_stiffness;
      st += by_stiffness * by_slip;
      tt += by_slip * by_slip;
      rs += residual * by_stiffness;
      rt += residual * by_slip;
    }
    const double determinant = ss * tt - st * st;
    if (!(determinant > 0)) return std::nullopt;
    constexpr double kLongest = 1.0;  // of a logarithm: beyond it the law is no longer linear
    const double stiffness = (st * rt - tt * rs) / determinant;
    const double slip = (st * rs - ss * rt) / determinant;
    if (!(std::abs(stiffness) < kLongest && std::abs(slip) < kLongest)) return std::nullopt;
    return BranchLaw{law.tangential_stiffness * std::exp(stiffness), law.shape_exponent,
                     law.slip_force * std::exp(slip)};
  }

  const Target& target_;
  const FrictionModel& model_;
  const models::LoadingPath& path_;
  std::vector<double> force_;
  std::vector<double> gradient_;
};

/// @param law  with the model's α, σ and Tc from where the search begins
std::optional<BranchLaw> RefitModel(const Target& target, const FrictionModel& model,
                                    const BranchLaw& law) {
  const models::LoadingPath path = methods::MakeDrivePath(model, target.drive);
  std::vector<double> force(target.force.size());
  const auto scaled_at = [&](double log_rate) {
    EvaluateForce(model, {law.slip_force * std::exp(log_rate), law.shape_exponent, law.slip_force},
                  path, target.drive.displacement, force);
    return ScaleTo(target, force);
  };
  const double centre = std::log(law.tangential_stiffness / law.slip_force);
  const double reach = std::log(100.0);
  constexpr int kPlaces = 40;
  const double log_rate = LeastOf([&](double at) { return scaled_at(at).sum_of_squares; },
                                  centre - reach, centre + reach, kPlaces);
  const double factor = scaled_at(log_rate).factor;
  if (!(factor > 0)) return std::nullopt;
  const BranchLaw found =
      Times({law.slip_force * std::exp(log_rate), law.shape_exponent, law.slip_force}, factor);
  return Polish(target, model, path).From(found);
}

std::optional<BranchLaw> RefitLimit(const Target& target, const models::LimitLaw& limit,
                                    const BranchLaw& law) {
  std::vector<double> force(target.force.size());
  limit.evaluate_force(law, target.drive.displacement, force);
  const double factor = ScaleTo(target, force).factor;
  if (!(factor > 0)) return std::nullopt;
  return Times(law, factor);
}

/// Returns a rung with a law of its own, where it has one.
std::optional<Approximation> Refitted(const Target& target, Approximation rung,
                                      const BranchLaw& law) {
  if (const models::LimitLaw* limit = models::FindLimitLaw(rung.model)) {
    rung.law = RefitLimit(target, *limit, law);
  } else {
    rung.law = RefitModel(target, *models::FindFrictionModel(rung.model), law);
  }
  if (!rung.law) return std::nullopt;
  return rung;
}

}  // namespace

std::vector<Approximation> RefittedLadder(const BranchLaw& law, const Drive& drive,
                                          const ReferenceResponse& reference, std::size_t first) {
  Validate(law);
  RequireSameSize("displacement", drive.displacement.size(), "reference", reference.force.size());
  if (first >= reference.force.size()) {
    ThrowInvalid("first sample that counts [-]", static_cast<double>(first),
                 "must be a sample of the drive");
  }
  const Target target{drive, reference.force, first};
  std::vector<Approximation> ladder;
  const auto add = [&](const Approximation& rung, const BranchLaw& from) {
    if (std::optional<Approximation> refitted = Refitted(target, rung, from)) {
      ladder.push_back(std::move(*refitted));
    }
  };
  const std::string exact = ExactModel(law);
  for (const Approximation& rung : ModelLadder(law)) {
    if (rung.model == exact) continue;
    const BranchLaw own = LawOf(rung, law);
    add(rung, own);
    if (rung.model != "dahl" || own.shape_exponent == 1) continue;
    add(rung, {own.tangential_stiffness, 1.0, own.slip_force});
  }
  return ladder;
}

std::vector<Approximation> AllApproximationsAlong(const BranchLaw& law, const Drive& drive,
                                                  const ReferenceResponse& reference,
                                                  std::size_t first) {
  const std::vector<Approximation> refitted = RefittedLadder(law, drive, reference, first);
  std::vector<Approximation> all;
  const std::string exact = ExactModel(law);
  for (const Approximation& approximation : AllApproximations(law)) {
    all.push_back(approximation);
    if (approximation.model == exact) continue;
    std::ranges::copy_if(refitted, std::back_inserter(all), [&](const Approximation& own) {
      return own.model == approximation.model;
    });
  }
  return all;
}

namespace {

/// Fraction of a cycle below which a number of cycles is whole.
constexpr double kRounding = 1e-9;

void RequireRecommendOptions(const RecommendOptions& options) {
  if (!(options.tolerance > 0 && options.tolerance <= 1)) {
    ThrowInvalid("tolerance [-]", options.tolerance, "must be in (0, 1]");
  }
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
