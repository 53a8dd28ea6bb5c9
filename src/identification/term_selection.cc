#include "mindahl/identification/term_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <ranges>
#include <utility>

#include "identification/continued_fit.h"
#include "identification/diagnosis/adequacy.h"
#include "identification/diagnosis/diagnosis.h"
#include "identification/inference/estimates.h"
#include "identification/problem/parameters.h"
#include "identification/term_scores.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {

using loop::RecordView;

namespace {

constexpr std::size_t kMostAlone = 2;  // terms that are added one after the other

/// Lists what measured loops have in addition to the law. Which few of these gain most changes with
/// the excerpt, and Tc with them: where no few terms leave but noise, all are fitted together.
constexpr std::array<std::string_view, 6> kCommonTerms = {
    "slip_speed", "drag", "slip_position_quadratic", "slip_trend", "force_drift", "lag"};

/// A candidate of one selection.
struct TermCandidate : ConsideredTerm {
  TermChoice choice = {};
  std::optional<TermScore> score = {};  // at the present solution; empty where it has no effect

  /// True of a column that follows the force of the contact: its cause, or confounded with it.
  [[nodiscard]] bool FollowsForce() const {
    return !choice.covariate.empty() && obstacle == "confounded";
  }
};

std::vector<TermCandidate> CandidatesOf(std::span<const RecordView> records,
                                        const FitOptions& options, const FitResult& law) {
  std::vector<TermCandidate> candidates;
  const bool timed =
      std::ranges::all_of(records, [](const RecordView& record) { return !record.time.empty(); });
  for (const TermGroup& group : TermGroups()) {
    const bool has_data = std::ranges::all_of(
        group.terms, [&](std::string_view name) { return timed || !FindTerm(name)->needs_time; });
    if (!group.is_tried || !has_data) continue;
    TermCandidate& candidate = candidates.emplace_back();
    candidate.name = group.name;
    candidate.choice.terms.assign(group.terms.begin(), group.terms.end());
  }
  const RecordView& first = records.front();
  const auto is_fitted = [&](const loop::Covariate& column) {
    return std::ranges::count(options.covariates, column.name) > 0;
  };
  std::vector<std::span<const double>> channels = {first.displacement, first.force, first.time};
  for (const loop::Covariate& column : first.covariates | std::views::filter(is_fitted)) {
    channels.push_back(column.values);
  }
  for (const loop::Covariate& column : first.covariates) {
    const bool all_have_it = std::ranges::all_of(records, [&](const RecordView& record) {
      return std::ranges::count(record.covariates, column.name, &loop::Covariate::name) > 0;
    });
    const auto [lowest, highest] = std::ranges::minmax(column.values);
    if (is_fitted(column) || !all_have_it || !(highest > lowest)) continue;
    TermCandidate& candidate = candidates.emplace_back();
    candidate.name = NameOfCovariate(column.name);
    if (std::ranges::any_of(channels, [&](std::span<const double> channel) {
          return !channel.empty() && AreOneChannel(column.values, channel);
        })) {
      candidate.obstacle = "same_channel";  // reported, never fitted
      continue;
    }
    const double correlation = ColumnCorrelation(column.values, law.records.front().fitted_force);
    if (std::abs(correlation) > options.thresholds.follows_contact) {
      candidate.obstacle = "confounded";
    }
    channels.push_back(column.values);
    candidate.choice.covariate = column.name;
  }
  return candidates;
}

/// True if the search of a term stopped at a bound of the program's own: no parameter is known.
/// Bounds of the theory do not count, nor does the displacement at which a sliding contact was
/// unloaded.
bool StopsAtLimit(const FitResult& fit) {
  return std::ranges::any_of(fit.parameters, [&](const ParameterEstimate& estimate) {
    const Term& term = *TermOfParameter(estimate.name);
    const bool may_end = term.presence == Presence::kAlways || term.lowest_is_of_theory ||
                         term.highest_is_of_theory || term.id == TermId::kDisplacementOffset;
    return estimate.is_at_bound() && !may_end;
  });
}

/// Adds terms to a law: a few one after the other, or all common ones.
class Selection {
 public:
  /// @param law  fit of the records with the options
  Selection(std::span<const RecordView> records, const FitOptions& options, const FitResult& law)
      : records_(records),
        drawn_(loop::DrawReadings(loop::Prepare(records, options.preparation))),
        facts_(law.WidestRecord().facts),
        candidates_(CandidatesOf(records, options, law)),
        base_{.options = options, .fit = law},
        law_bounds_slip_force_(BoundsSlipForce(law)) {
    // Fitted as the candidates are, without an upper bound on Tc: a missing term may drive it high.
    base_ = law_ = FitWith({});
  }

  TermSelection Run(FitResult law, MostTerms most) {
    while (base_.added.size() < kMostAlone && !IsNearlyWhite(base_.fit) && Round()) {
    }
    FitResult last;
    // Short of slip the law itself has the forms of several: together they would take its place.
    const bool may_be_common = most == MostTerms::kCommon && Slides();
    if (may_be_common && !IsNearlyWhite(base_.fit)) last = FitCommon();
    if (!IsFitted(last) && !base_.added.empty()) last = FitLast(base_);
    const bool is_kept = IsFitted(last);
    for (TermCandidate& candidate : candidates_) {
      if (!IsAdded(candidate.name)) continue;
      candidate.added = is_kept;
      candidate.obstacle = is_kept ? "" : "confounded";
    }
    if (is_kept) {
      // One term that leaves but noise rules out what leaves much more.
      const bool is_settled =
          base_.added.size() == 1 && last.adequacy.verdict == AdequacyVerdict::kAdequate;
      std::erase_if(alternatives_, [&](const TermCandidate& alternative) {
        return IsAdded(alternative.name) ||
               (is_settled && alternative.score->rms > Limits().larger_rms * last.rms);
      });
      IncludeAlternatives(last);
    }
    TermSelection result = std::move(is_kept ? base_ : law_);
    result.fit = std::move(is_kept ? last : law);
    result.considered.assign(candidates_.begin(), candidates_.end());
    std::ranges::stable_sort(result.considered, {}, [&](const ConsideredTerm& term) {
      return std::pair(std::ranges::find(result.added, term.name), -term.gain);
    });
    return result;
  }

  /// Fits each of the few candidates that promise most, and returns those that can be added, the
  /// one that gains most first; the gain of a column that follows the force counts twice.
  std::vector<std::string> Likely(std::size_t most) {
    std::vector<TermCandidate*> tried = Score();
    std::erase_if(tried, [&](TermCandidate* candidate) {
      return candidate->gain < Limits().worthwhile_gain || IsRefused(*candidate);
    });
    // A column whose force the law has taken up is fitted first: a linear step fails to predict it.
    const auto column = std::ranges::find_if(candidates_, &TermCandidate::FollowsForce);
    if (column != candidates_.end() && IsFitted(base_.fit)) tried.insert(tried.begin(), &*column);
    tried.resize(std::min(tried.size(), most));
    std::multimap<double, std::string, std::greater<>> by_gain;
    for (const TermCandidate* const candidate : tried) {
      const bool is_column = candidate->FollowsForce();
      const TermSelection model = FitWith(candidate->choice);
      // A column that causes a part of the force reduces Tc: that alone does not rule it out.
      const std::string_view obstacle = ObstacleTo(model);
      if (!obstacle.empty() && !(is_column && obstacle == "confounded" && Gains(model.fit)))
        continue;
      // A measured column is preferred to a term that gains less than twice as much.
      const double gain = base_.fit.rms - model.fit.rms;
      by_gain.emplace(is_column ? gain / Limits().rival : gain, candidate->name);
    }
    const auto names = by_gain | std::views::values;
    return {names.begin(), names.end()};
  }

 private:
  [[nodiscard]] const Thresholds& Limits() const { return base_.options.thresholds; }
  [[nodiscard]] bool IsAdded(std::string_view name) const {
    return std::ranges::count(base_.added, name) > 0;
  }
  /// True of a loop that slides, a large force of the position beside it or not.
  [[nodiscard]] bool Slides() const { return loop::Slides(facts_) || loop::HasEvenGap(facts_); }

  [[nodiscard]] bool IsNearlyWhite(const FitResult& fit) const {
    return fit.rms * fit.rms <= Limits().nearly_white * WhiteVariance(fit);
  }
  [[nodiscard]] bool BoundsSlipForce(const FitResult& fit) const {
    const ParameterEstimate& slip_force = fit.parameters[kSlipForce];
    return slip_force.lower95 && slip_force.upper95 &&
           *slip_force.upper95 <= Limits().widest_ratio * *slip_force.lower95;
  }

  /// Scores the candidates at the present solution and returns those with an effect, best first.
  std::vector<TermCandidate*> Score() {
    if (!IsFitted(base_.fit) || !base_.fit.converged) return {};
    std::vector<TermChoice> choices;
    for (const TermCandidate& candidate : candidates_) choices.push_back(candidate.choice);
    const auto scores = ScoreTerms(records_, base_.fit, base_.options, choices);
    std::vector<TermCandidate*> scored;
    for (std::size_t c = 0; c < candidates_.size(); ++c) {
      TermCandidate& candidate = candidates_[c];
      if (IsAdded(candidate.name)) continue;
      const bool stays = candidate.obstacle == "confounded" || candidate.obstacle == "same_channel";
      if (!stays) candidate.obstacle = "";
      candidate.score = scores[c];
      candidate.gain = candidate.score ? candidate.score->gain : 0.0;
      if (candidate.score) scored.push_back(&candidate);
    }
    std::ranges::stable_sort(scored, std::greater(), &TermCandidate::gain);
    return scored;
  }

  /// True if a candidate that gains is not to be added, and says why where that is to be reported.
  [[nodiscard]] bool IsRefused(TermCandidate& candidate) const {
    // Without a slip force of the speed, a drag and the slip force at rest are confounded.
    if (candidate.name == "drag" && !HasTerm(base_.options, "slip_speed")) return true;
    // Short of slip a slip force of the position and its spring take the law's place.
    if (candidate.name.starts_with("slip_position") && !Slides()) {
      candidate.obstacle = "confounded";
    }
    if (candidate.score->is_negative) candidate.obstacle = "unphysical";
    return !candidate.obstacle.empty();
  }

  /// Returns the best, or what has some of its terms only and gains at least half as much.
  [[nodiscard]] TermCandidate& Simplest(std::span<TermCandidate* const> candidates) const {
    const TermCandidate& most = *candidates.front();
    TermCandidate* best = candidates.front();
    for (TermCandidate* const one : candidates) {
      const bool is_part =
          one->choice.covariate.empty() &&
          std::ranges::all_of(one->choice.terms, [&](const std::string& term) {
            return HasTerm(base_.options, term) || std::ranges::count(most.choice.terms, term) > 0;
          });
      const bool is_smaller = one->score->parameters < best->score->parameters;
      if (is_part && is_smaller && one->gain >= Limits().rival * most.gain) best = one;
    }
    return *best;
  }

  /// Fits the present model with some more terms.
  /// @param from_here  from its solution, else from starts of its own
  TermSelection FitWith(const TermChoice& choice, bool from_here = true) {
    TermSelection model{.added = base_.added, .options = choice.AddedTo(base_.options)};
    FitOptions options = model.options;
    if (from_here) {
      options.initial_state = base_.fit.initial_state;
      StartFrom(base_.fit, options);
    }
    options.preparation.force_sense = base_.fit.force_sense;
    model.fit = FitTo(std::move(options), Depth::kEstimate);
    return model;
  }

  FitResult FitTo(FitOptions options, Depth depth) {
    constexpr int kEnoughIterations = 150;  // what needs more is nearly confounded with the rest
    options.preparation.drawn = drawn_;
    options.max_iterations = std::min(options.max_iterations, kEnoughIterations);
    return FitWithout({}, records_, std::move(options), depth);
  }

  [[nodiscard]] bool Gains(const FitResult& fit) const {
    return fit.rms <= (1 - Limits().worthwhile_gain) * base_.fit.rms;
  }
  /// True if Tc leaves the half gap that was measured, and more than noise is left.
  [[nodiscard]] bool Leaves(const FitResult& fit) const {
    return LeavesHalfGap(facts_, base_.fit.law.slip_force, fit.law.slip_force) &&
           !IsNearlyWhite(fit);
  }

  /// Says why a larger model does not replace the present one; empty where it does.
  [[nodiscard]] std::string_view ObstacleTo(const TermSelection& model) const {
    const FitResult& fit = model.fit;
    if (!IsFitted(fit) || !fit.converged) return "not_converged";
    const auto is_unphysical = [](const ParameterEstimate& estimate) {
      return TermOfParameter(estimate.name)->is_never_negative && estimate.value < 0 &&
             estimate.status != ParameterStatus::kFixed;
    };
    if (std::ranges::any_of(fit.parameters, is_unphysical)) return "unphysical";
    const bool stops = StopsAtLimit(fit) && !StopsAtLimit(base_.fit);
    return Leaves(fit) || stops || !Gains(fit) ? "confounded" : "";
  }

  /// Adds the best candidate that can be added; false where there is none.
  bool Round() {
    std::vector<TermCandidate*> explaining = Score();
    const double chance =
        Limits().added_by_chance / static_cast<double>(std::max<std::size_t>(explaining.size(), 1));
    std::erase_if(explaining, [&](const TermCandidate* candidate) {
      return candidate->gain < Limits().worthwhile_gain || !(candidate->score->p_value < chance);
    });
    std::vector<TermCandidate*> left = explaining;
    std::erase_if(left, [&](TermCandidate* candidate) { return IsRefused(*candidate); });
    // Moves to a model with a candidate, unless there is an obstacle, which the candidate keeps.
    const auto is_added = [&](TermCandidate& candidate, bool from_here) {
      TermSelection model = FitWith(candidate.choice, from_here);
      candidate.obstacle = ObstacleTo(model);
      if (!candidate.obstacle.empty()) return false;
      model.added.push_back(candidate.name);
      base_ = std::move(model);
      return true;
    };
    constexpr double kMost = 0.5;
    while (!left.empty()) {
      TermCandidate& best = Simplest(left);
      // A search from a solution that most of the misfit has led astray may end elsewhere.
      if (!is_added(best, true) && !(best.gain > kMost && is_added(best, false))) {
        std::erase(left, &best);
        continue;
      }
      // Candidates that gain at least half as much are alternatives, by the law beside each.
      for (const TermCandidate* const other : explaining) {
        const bool is_column = !other->choice.covariate.empty();
        const bool is_unphysical = other->score->is_negative || other->obstacle == "unphysical";
        if (is_column || is_unphysical || other->gain < Limits().rival * best.gain) continue;
        TermScore& score = *alternatives_.emplace_back(*other).score;
        std::ranges::transform(score.law, best.score->law, score.law.begin(), std::minus());
      }
      return true;
    }
    return false;
  }

  /// Fits a model to the end, from its solution.
  /// @returns a fit without parameters where Tc is lost
  FitResult FitLast(const TermSelection& model) {
    FitOptions options = model.options;
    StartFrom(model.fit, options);
    FitResult last = FitTo(std::move(options), Depth::kFull);
    if (IsFitted(last) && !Leaves(last) && (!law_bounds_slip_force_ || BoundsSlipForce(last))) {
      return last;
    }
    return {};
  }

  /// Fits the law with all common terms, which begin without effect, and moves there unless there
  /// is an obstacle or the terms that were added one after the other leave hardly more.
  /// @returns a fit without parameters where it does not move
  FitResult FitCommon() {
    TermSelection common{.options = law_.options};
    for (const TermCandidate& candidate : candidates_) {
      if (std::ranges::count(kCommonTerms, candidate.name) == 0) continue;
      common.added.push_back(candidate.name);
      common.options = candidate.choice.AddedTo(std::move(common.options));
    }
    FitOptions from_terms = common.options;
    for (const std::string& term :
         common.options.terms | std::views::drop(law_.options.terms.size())) {
      const std::optional<double> start = FindTerm(term)->start;
      if (start) from_terms.start[term] = *start;
    }
    common.fit = FitTo(std::move(from_terms), Depth::kEstimate);
    if (!Gains(common.fit)) return {};
    TermSelection alone = std::exchange(base_, law_);
    FitResult last;
    if (ObstacleTo(common).empty()) last = FitLast(common);
    base_ = std::move(IsFitted(last) ? common : alone);
    if (IsFitted(last)) alternatives_.clear();
    return last;
  }

  /// Includes what alternatives make of the law; Tc no further than a loop that slides carries.
  void IncludeAlternatives(FitResult& fit) const {
    const std::optional<double> half_gap = fit.MeasuredHalfGap();
    for (const TermCandidate& alternative : alternatives_) {
      for (const std::size_t p : {kStiffness, kShape, kSlipForce}) {
        ParameterEstimate& estimate = fit.parameters[p];
        if (!estimate.lower95 || !estimate.upper95) continue;
        const double step = std::clamp(alternative.score->law[p], -kFarthestStep, kFarthestStep);
        double value =
            p == kShape ? std::max(0.0, estimate.value + step) : estimate.value * std::exp(step);
        if (p == kSlipForce && half_gap && loop::Slides(fit.WidestRecord().facts)) {
          value = std::clamp(value, std::min(*half_gap, estimate.value),
                             std::max(fit.PeakForce(), estimate.value));
        }
        Include(estimate, {.lower = value, .upper = value});
      }
    }
    Append(fit.findings, FindWideIntervals(fit, Limits()));
    Judge(fit.parameters, fit.findings);
  }

  std::span<const RecordView> records_;
  std::shared_ptr<const loop::DrawnReadings> drawn_;  // the same for all fits
  loop::LoopFacts facts_;                             // of the widest record
  std::vector<TermCandidate> candidates_;
  TermSelection law_;           // fitted at Depth::kEstimate, without terms
  TermSelection base_;          // likewise, with the terms that were added
  bool law_bounds_slip_force_;  // without terms
  /// Candidates that gain nearly as much as one that was added; score.law is the difference from
  /// its law.
  std::vector<TermCandidate> alternatives_;
};

}  // namespace

TermSelection SelectTerms(std::span<const RecordView> records, const FitOptions& options,
                          FitResult fit, MostTerms most) {
  if (!IsFitted(fit) || fit.adequacy.verdict == AdequacyVerdict::kAdequate ||
      options.response() != loop::Channel::kForce) {
    return {.options = options, .fit = std::move(fit)};
  }
  return Selection(records, options, fit).Run(std::move(fit), most);
}

std::vector<std::string> LikelyTerms(std::span<const RecordView> records, const FitOptions& options,
                                     const FitResult& fit, std::size_t most) {
  if (!IsFitted(fit) || options.response() != loop::Channel::kForce) return {};
  return Selection(records, options, fit).Likely(most);
}

void IncludeFit(const FitResult& with_term, const Thresholds& thresholds, FitResult& fit) {
  for (const std::size_t p : {kStiffness, kShape}) {
    ParameterEstimate& estimate = fit.parameters[p];
    const ParameterEstimate& other = with_term.parameters[p];
    if (!estimate.lower95 || !estimate.upper95) continue;
    Include(estimate, {.lower = std::min(other.value, other.lower95.value_or(other.value)),
                       .upper = std::max(other.value, other.upper95.value_or(other.value))});
  }
  Append(fit.findings, FindWideIntervals(fit, thresholds));
  Judge(fit.parameters, fit.findings);
}

}  // namespace mindahl::identification
