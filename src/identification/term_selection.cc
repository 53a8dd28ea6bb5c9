#include "mindahl/identification/term_selection.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "core/extremes.h"
#include "identification/continued_fit.h"
#include "identification/diagnosis/adequacy.h"
#include "identification/diagnosis/diagnosis.h"
#include "identification/inference/estimates.h"
#include "identification/problem/parameters.h"
#include "identification/solved_fit.h"
#include "identification/term_scores.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {

using loop::RecordView;

namespace {

/// Fits in all, nearly all of them at Depth::kEstimate.
constexpr std::size_t kMostFits = 15;

/// Central differences; enough to recognise a measured velocity.
std::vector<double> RoughVelocity(const RecordView& record) {
  std::vector<double> velocity(record.size(), 0.0);
  for (std::size_t i = 1; i + 1 < record.size() && !record.time.empty(); ++i) {
    const double duration = record.time[i + 1] - record.time[i - 1];
    if (duration > 0) {
      velocity[i] = (record.displacement[i + 1] - record.displacement[i - 1]) / duration;
    }
  }
  return velocity;
}

/// Names what keeps a column out: it repeats another one.
/// @param before  covariates that are candidates
std::string_view ObstacleToColumn(const loop::Covariate& covariate, const RecordView& record,
                                  const FitResult& law, std::span<const std::string> before,
                                  const Thresholds& thresholds) {
  const auto is_channel = [&](std::span<const double> other) {
    return AreOneChannel(covariate.values, other);
  };
  if (is_channel(record.displacement) || is_channel(record.force) ||
      is_channel(record.time.empty() ? record.displacement : record.time) ||
      is_channel(RoughVelocity(record))) {
    return "same_channel";
  }
  for (const loop::Covariate& other : record.covariates) {
    const bool is_before = std::ranges::find(before, other.name) != before.end();
    if (is_before && is_channel(other.values)) return "same_channel";
  }
  // The factor of a column that follows the force would take a part of Tc.
  const double correlation = ColumnCorrelation(covariate.values, law.records.front().fitted_force);
  return std::abs(correlation) > thresholds.follows_contact ? "confounded" : "";
}

bool HasCovariate(const RecordView& record, const std::string& name) {
  return std::ranges::find(record.covariates, name, &loop::Covariate::name) !=
         record.covariates.end();
}

bool IsConstant(std::span<const double> values) {
  const auto [lowest, highest] = ExtremesOf(values);
  return !(highest > lowest);
}

/// A candidate of one selection.
struct TermCandidate {
  ConsideredTerm considered;
  TermChoice choice;
};

/// True of a column that follows the force of the contact: its cause, or what it is confounded
/// with.
bool FollowsForce(const TermCandidate& candidate) {
  return !candidate.choice.covariate.empty() && candidate.considered.obstacle == "confounded";
}

/// True of a term whose effect is not linear: a fit says what it gains, a score does not.
bool MovesContact(const TermCandidate& candidate) {
  const std::vector<std::string>& terms = candidate.choice.terms;
  return !terms.empty() && FindTerm(terms.front())->motion != ContactMotion::kMeasured;
}

TermCandidate CandidateOf(const TermGroup& group) {
  TermCandidate candidate;
  candidate.considered.name = group.name;
  candidate.choice.terms.assign(group.terms.begin(), group.terms.end());
  return candidate;
}

std::vector<TermCandidate> TermCandidates(std::span<const RecordView> records,
                                          const FitOptions& options, const FitResult& law) {
  std::vector<TermCandidate> candidates;
  const auto is_timed = [](const RecordView& record) { return !record.time.empty(); };
  const bool timed = std::ranges::all_of(records, is_timed);
  for (const TermGroup& group : TermGroups()) {
    const bool has_data = std::ranges::all_of(
        group.terms, [&](std::string_view name) { return timed || !FindTerm(name)->needs_time; });
    if (group.is_tried && has_data) candidates.push_back(CandidateOf(group));
  }
  std::vector<std::string> columns = options.covariates;
  for (const loop::Covariate& covariate : records.front().covariates) {
    const bool is_there = std::ranges::find(columns, covariate.name) != columns.end();
    const auto has_it = [&](const RecordView& record) {
      return HasCovariate(record, covariate.name);
    };
    if (is_there || !std::ranges::all_of(records, has_it) || IsConstant(covariate.values)) continue;
    TermCandidate& candidate = candidates.emplace_back();
    candidate.considered.name = NameOfCovariate(covariate.name);
    candidate.considered.obstacle =
        ObstacleToColumn(covariate, records.front(), law, columns, options.thresholds);
    if (candidate.considered.obstacle == "same_channel") continue;  // reported, never fitted
    columns.push_back(covariate.name);
    candidate.choice.covariate = covariate.name;
  }
  return candidates;
}

/// True if hardly more than white noise is left.
bool IsNearlyWhite(const FitResult& fit, const Thresholds& thresholds) {
  return fit.rms * fit.rms <= thresholds.nearly_white * WhiteVariance(fit);
}

/// True if the interval of the slip force was closed and is open.
/// @param widest_ratio  of the ends of an interval that is closed
bool OpensSlipForce(const FitResult& without, const FitResult& with, double widest_ratio) {
  const auto is_closed = [&](const FitResult& fit) {
    const ParameterEstimate& slip_force = *fit.Find("slip_force");
    return slip_force.lower95 && slip_force.upper95 &&
           *slip_force.upper95 <= widest_ratio * *slip_force.lower95;
  };
  return is_closed(without) && !is_closed(with);
}

/// True if the search of a term stopped at a bound of the program's own: no parameter would be
/// known. Where a contact that slides was unloaded is no such term, and others end where the theory
/// does.
bool StopsAtLimit(const FitResult& fit) {
  return std::ranges::any_of(fit.parameters, [&](const ParameterEstimate& estimate) {
    const Term& term = *TermOfParameter(estimate.name);
    const bool may_end = term.presence == Presence::kAlways || term.lowest_is_of_theory ||
                         term.highest_is_of_theory || term.id == TermId::kDisplacementOffset;
    return estimate.is_at_bound() && !may_end;
  });
}

bool IsPositiveTerm(std::string_view parameter) {
  const Term* const term = TermOfParameter(parameter);
  return term != nullptr && term->is_never_negative;
}

bool IsUnphysical(const FitResult& fit) {
  return std::ranges::any_of(fit.parameters, [](const ParameterEstimate& estimate) {
    return IsPositiveTerm(estimate.name) && estimate.status != ParameterStatus::kFixed &&
           estimate.value < 0;
  });
}

/// Holds the law that another candidate of a round gives in place of the one that was added.
struct Alternative {
  std::string name;
  std::map<std::string, double> law;  // differences of θ of σ, α and Tc
  double rms = 0.0;                   // with it, to first order
};

/// Includes in the intervals what alternatives make of the law, Tc no further than what a loop that
/// slides has carried.
void IncludeAlternatives(std::span<const Alternative> alternatives, const Thresholds& thresholds,
                         FitResult& fit) {
  const RecordFit& widest = fit.WidestRecord();
  for (const Alternative& alternative : alternatives) {
    for (const auto& [name, difference] : alternative.law) {
      const auto estimate = std::ranges::find(fit.parameters, name, &ParameterEstimate::name);
      if (estimate == fit.parameters.end() || !estimate->lower95 || !estimate->upper95) continue;
      const double step = std::clamp(difference, -kFarthestStep, kFarthestStep);
      double value = name == "alpha" ? std::max(0.0, estimate->value + step)
                                     : estimate->value * std::exp(step);
      if (name == "slip_force" && loop::Slides(widest.facts)) {
        value =
            std::clamp(value, std::min(*widest.facts.half_gap / widest.load_ratio, estimate->value),
                       std::max(widest.facts.peak_force / widest.load_ratio, estimate->value));
      }
      Include(*estimate, {.lower = value, .upper = value});
    }
  }
  Append(fit.findings, FindWideIntervals(fit, thresholds));
  Judge(fit.parameters, fit.findings);
}

/// Adds terms to a law, one after the other.
class Selection {
 public:
  explicit Selection(std::span<const RecordView> records) : records_(records) {}

  TermSelection Run(const FitOptions& options);
  std::vector<std::string> Likely(const FitOptions& options, const FitResult& law,
                                  std::size_t most);

 private:
  /// A model of the selection, fitted at Depth::kEstimate.
  struct Model {
    FitOptions options;  // as the user gives them, with terms
    FitResult fit;
  };

  /// A candidate and its score.
  struct Gain {
    std::size_t candidate;
    TermScore score;
  };

  bool Begin(const FitOptions& options, const FitResult& law);
  [[nodiscard]] const Thresholds& Limits() const { return base_.options.thresholds; }
  [[nodiscard]] std::optional<std::size_t> Find(std::string_view name) const;
  std::vector<Gain> Score();
  [[nodiscard]] bool IsRefused(const Gain& gain);
  [[nodiscard]] const Gain& Simplest(std::span<const Gain> gains) const;
  Model FitWith(const TermChoice& choice, const std::map<std::string, double>* starts);
  FitResult FitTo(FitOptions options, Depth depth);
  [[nodiscard]] bool Leaves(const FitResult& fit) const;
  [[nodiscard]] bool Gains(const FitResult& fit) const;
  [[nodiscard]] std::string_view ObstacleTo(const Model& model) const;
  bool Add(std::size_t candidate, Model model);
  bool Round();
  bool Move();
  void KeepAlternatives(const Gain& added, std::span<const Gain> gains);
  void FitLast(const FitResult& law);

  static constexpr std::size_t kLastFits = 3;  // of a round and of FitLast()
  std::span<const RecordView> records_;
  TermSelection result_;
  std::size_t fits_ = 0;  // that were made
  std::vector<TermCandidate> candidates_;
  Model base_;  // with the terms that were added
  std::optional<TermScores> scores_;
  std::vector<Alternative> alternatives_;
  std::shared_ptr<const loop::DrawnReadings> drawn_;  // the same for all fits
  loop::LoopFacts facts_;                             // of the widest record
};

std::optional<std::size_t> Selection::Find(std::string_view name) const {
  const auto found = std::ranges::find(candidates_, name, [](const TermCandidate& candidate) {
    return std::string_view(candidate.considered.name);
  });
  if (found == candidates_.end()) return std::nullopt;
  return found - candidates_.begin();
}

/// Prepares the records for all candidates at once.
/// @returns false where the law has no fit
bool Selection::Begin(const FitOptions& options, const FitResult& law) {
  candidates_ = TermCandidates(records_, options, law);
  std::vector<TermChoice> choices;
  choices.reserve(candidates_.size());
  for (const TermCandidate& candidate : candidates_) choices.push_back(candidate.choice);
  FitOptions as_fitted = options;
  as_fitted.preparation.force_sense = law.force_sense;
  try {
    scores_.emplace(records_, as_fitted, choices);
  } catch (const InvalidArgument&) {
    const auto lag = Find("lag");  // no time that goes on
    if (!lag) throw;
    candidates_.erase(candidates_.begin() + static_cast<std::ptrdiff_t>(*lag));
    choices.erase(choices.begin() + static_cast<std::ptrdiff_t>(*lag));
    scores_.emplace(records_, as_fitted, choices);
  }
  drawn_ = loop::DrawReadings(scores_->prepared());
  facts_ = law.WidestRecord().facts;
  base_ = {.options = options, .fit = law};
  // The law is fitted again as the candidates are, without an upper bound on the slip force: a
  // missing term may drive it beyond the measured force.
  const std::map<std::string, double> none;
  base_ = FitWith({}, &none);
  return IsFitted(base_.fit) && base_.fit.converged;
}

/// Scores the candidates at the present solution and returns them, the best first.
std::vector<Selection::Gain> Selection::Score() {
  std::vector<TermChoice> choices;
  for (TermCandidate& candidate : candidates_) {
    std::erase_if(candidate.choice.terms,
                  [&](const std::string& term) { return HasTerm(base_.options, term); });
    choices.push_back(candidate.considered.added ? TermChoice() : candidate.choice);
  }
  scores_->StepFrom(base_.fit, base_.options, choices);
  std::vector<Gain> gains;
  for (std::size_t c = 0; c < candidates_.size(); ++c) {
    ConsideredTerm& considered = candidates_[c].considered;
    if (considered.added) continue;
    const bool stays = considered.obstacle == "confounded" || considered.obstacle == "same_channel";
    if (!stays) considered.obstacle = "";
    std::optional<TermScore> score = scores_->Of(c);
    considered.gain = score ? score->gain : 0.0;
    if (score) gains.push_back({c, std::move(*score)});
  }
  std::ranges::stable_sort(gains, std::greater(), [](const Gain& one) { return one.score.gain; });
  return gains;
}

/// True if a candidate that gains is not to be added, and says why where that is to be reported.
bool Selection::IsRefused(const Gain& gain) {
  TermCandidate& candidate = candidates_[gain.candidate];
  // Beside a slip force of the speed a further force of speed and the slip force at rest are
  // confounded; a drag is that force with the slip force that at v₀.
  if (candidate.considered.name == "drag" && !HasTerm(base_.options, "slip_speed")) return true;
  if (std::ranges::any_of(gain.score.values, [](const auto& value) {
        return IsPositiveTerm(value.first) && value.second < 0;
      })) {
    candidate.considered.obstacle = "unphysical";
  }
  return !candidate.considered.obstacle.empty();
}

/// Returns the best, or what has some of its terms only and gains at least half as much.
const Selection::Gain& Selection::Simplest(std::span<const Gain> gains) const {
  const Gain& most = gains.front();
  const Gain* best = &most;
  for (const Gain& one : gains) {
    const TermChoice& choice = candidates_[one.candidate].choice;
    const std::vector<std::string>& all = candidates_[most.candidate].choice.terms;
    const bool is_part =
        choice.covariate.empty() && std::ranges::all_of(choice.terms, [&](const std::string& term) {
          return std::ranges::find(all, term) != all.end();
        });
    const bool is_smaller = one.score.values.size() < best->score.values.size();
    if (is_part && is_smaller && one.score.gain >= Limits().rival * most.score.gain) best = &one;
  }
  return *best;
}

/// Fits the present model with some more terms.
/// @param starts  of these, beside its solution; null: from starts of its own
Selection::Model Selection::FitWith(const TermChoice& choice,
                                    const std::map<std::string, double>* starts) {
  Model model{.options = choice.AddedTo(base_.options), .fit = {}};
  FitOptions options = model.options;
  if (starts != nullptr) {
    HoldInitialStates(base_.fit, options);
    StartFrom(base_.fit, options);
    for (const auto& [name, value] : *starts) options.start[name] = value;
  }
  options.preparation.force_sense = base_.fit.force_sense;
  model.fit = FitTo(options, Depth::kEstimate);
  return model;
}

/// Returns a fit without parameters where a term is not identifiable, or the rig softer than the
/// loop.
FitResult Selection::FitTo(FitOptions options, Depth depth) {
  constexpr int kEnoughIterations = 150;  // what needs more is nearly confounded with the rest
  options.preparation.drawn = drawn_;
  options.max_iterations = std::min(options.max_iterations, kEnoughIterations);
  try {
    ++fits_;
    return Fitter(options).Fit(records_, depth);
  } catch (const InvalidArgument&) {
    return {};
  }
}

/// True if Tc leaves the half gap that was measured, and more than noise is left.
bool Selection::Leaves(const FitResult& fit) const {
  return LeavesHalfGap(facts_, base_.fit.law.slip_force, fit.law.slip_force) &&
         !IsNearlyWhite(fit, Limits());
}

bool Selection::Gains(const FitResult& fit) const {
  return fit.rms <= (1 - Limits().worthwhile_gain) * base_.fit.rms;
}

/// Says why a larger model does not replace the present one; empty where it does.
std::string_view Selection::ObstacleTo(const Model& model) const {
  const FitResult& fit = model.fit;
  if (!IsFitted(fit) || !fit.converged) return "not_converged";
  if (IsUnphysical(fit)) return "unphysical";
  const bool stops = StopsAtLimit(fit) && !StopsAtLimit(base_.fit);
  return Leaves(fit) || stops || !Gains(fit) ? "confounded" : "";
}

/// Moves to a model with a candidate, unless there is an obstacle to it, which the candidate keeps.
bool Selection::Add(std::size_t candidate, Model model) {
  ConsideredTerm& considered = candidates_[candidate].considered;
  considered.obstacle = ObstacleTo(model);
  if (!considered.obstacle.empty()) return false;
  considered.added = true;
  result_.added.push_back(considered.name);
  base_ = std::move(model);
  return true;
}

/// Keeps what candidates that gain at least half as much as the one that is added would make of the
/// law: the record may have been made by them.
void Selection::KeepAlternatives(const Gain& added, std::span<const Gain> gains) {
  for (const auto& [c, score] : gains) {
    const bool is_column = !candidates_[c].choice.covariate.empty();
    if (candidates_[c].considered.obstacle == "unphysical") continue;
    if (is_column || score.gain < Limits().rival * added.score.gain) continue;
    Alternative& alternative =
        alternatives_.emplace_back(Alternative{candidates_[c].considered.name, {}, score.rms});
    for (const auto& [name, step] : score.law) {
      const auto of_added = added.score.law.find(name);
      if (of_added != added.score.law.end()) alternative.law[name] = step - of_added->second;
    }
  }
}

/// Adds the best candidate that can be added; false where there is none.
bool Selection::Round() {
  std::vector<Gain> gains = Score();
  const double chance =
      Limits().added_by_chance / static_cast<double>(std::max<std::size_t>(gains.size(), 1));
  std::erase_if(gains, [&](const Gain& gain) {
    return gain.score.gain < Limits().worthwhile_gain || !(gain.score.p_value < chance);
  });
  constexpr double kMost = 0.5;
  const std::vector<Gain> explaining = gains;
  std::erase_if(gains, [&](const Gain& gain) { return IsRefused(gain); });
  while (!gains.empty() && fits_ + kLastFits < kMostFits) {
    const Gain& best = Simplest(gains);
    const std::size_t candidate = best.candidate;
    const TermChoice& choice = candidates_[candidate].choice;
    // A search from a solution that most of the misfit has led astray may end elsewhere.
    if (Add(candidate, FitWith(choice, &best.score.values)) ||
        (best.score.gain > kMost && Add(candidate, FitWith(choice, nullptr)))) {
      KeepAlternatives(best, explaining);
      return true;
    }
    std::erase_if(gains, [&](const Gain& gain) { return gain.candidate == candidate; });
  }
  return false;
}

/// Adds the better of the terms that move the contact, where no other can be added.
bool Selection::Move() {
  if (IsNearlyWhite(base_.fit, Limits())) return false;
  std::optional<std::pair<std::size_t, Model>> best;
  for (const Gain& gain : Score()) {
    const TermCandidate& candidate = candidates_[gain.candidate];
    if (!MovesContact(candidate) || fits_ + kLastFits >= kMostFits) continue;
    Model model = FitWith(candidate.choice, &gain.score.values);
    if (!ObstacleTo(model).empty()) continue;
    if (!best || model.fit.rms < best->second.fit.rms) best = {gain.candidate, std::move(model)};
  }
  return best && Add(best->first, std::move(best->second));
}

TermSelection Selection::Run(const FitOptions& options) {
  ++fits_;
  result_.options = options;
  result_.fit = Fitter(options).Fit(records_, Depth::kFull);
  const bool is_described = result_.fit.adequacy.verdict == AdequacyVerdict::kAdequate;
  if (!IsFitted(result_.fit) || is_described || options.response() != loop::Channel::kForce) {
    return std::move(result_);
  }
  const FitResult law = result_.fit;
  if (!Begin(options, law)) return std::move(result_);
  while (Round() || Move()) {
  }
  if (!result_.added.empty()) FitLast(law);
  for (const TermCandidate& candidate : candidates_) {
    result_.considered.push_back(candidate.considered);
  }
  std::ranges::stable_sort(result_.considered, std::greater(), &ConsideredTerm::gain);
  std::ranges::stable_sort(result_.considered, {}, [&](const ConsideredTerm& term) {
    return std::ranges::find(result_.added, term.name) - result_.added.begin();
  });
  return std::move(result_);
}

/// Fits the chosen model: from starts of its own, as where the terms are named, unless these lose
/// Tc or leave more than is known to be left, else from where it is. The law stays where its Tc
/// would be lost.
void Selection::FitLast(const FitResult& law) {
  FitResult last = FitTo(base_.options, Depth::kFull);
  const double most_left = (1 + Limits().worthwhile_gain) * base_.fit.rms;
  const auto is_kept = [&](const FitResult& fit) {
    return IsFitted(fit) && !Leaves(fit) && !OpensSlipForce(law, fit, Limits().widest_ratio);
  };
  if (!is_kept(last) || last.rms > most_left) {
    FitOptions from_here = base_.options;
    StartFrom(base_.fit, from_here);
    last = FitTo(from_here, Depth::kFull);
  }
  if (is_kept(last)) {
    // One term that leaves but noise rules out what leaves much more.
    const bool is_settled =
        result_.added.size() == 1 && last.adequacy.verdict == AdequacyVerdict::kAdequate;
    std::erase_if(alternatives_, [&](const Alternative& alternative) {
      return std::ranges::find(result_.added, alternative.name) != result_.added.end() ||
             (is_settled && alternative.rms > Limits().larger_rms * last.rms);
    });
    IncludeAlternatives(alternatives_, Limits(), last);
    result_.fit = std::move(last);
    result_.options = base_.options;
    return;
  }
  for (const std::string& name : result_.added) {
    ConsideredTerm& considered = candidates_[*Find(name)].considered;
    considered.added = false;
    considered.obstacle = "confounded";
  }
  result_.added.clear();
}

/// Fits each of the few candidates that promise most, and returns those that can be added, the one
/// that gains most first; the gain of a column that follows the force counts twice.
std::vector<std::string> Selection::Likely(const FitOptions& options, const FitResult& law,
                                           std::size_t most) {
  if (!IsFitted(law) || !Begin(options, law)) return {};
  std::vector<Gain> tried = Score();
  std::erase_if(tried, [&](const Gain& gain) {
    return gain.score.gain < Limits().worthwhile_gain || IsRefused(gain);
  });
  // A linear step does not predict the gain of a column whose force the law has taken up: it is
  // fitted first.
  const auto column = std::ranges::find_if(candidates_, FollowsForce);
  if (column != candidates_.end()) {
    const auto c = static_cast<std::size_t>(column - candidates_.begin());
    std::erase_if(tried, [&](const Gain& gain) { return gain.candidate == c; });
    tried.insert(tried.begin(), {c, {}});
  }
  tried.resize(std::min(tried.size(), most));
  std::multimap<double, std::string, std::greater<>> by_gain;
  for (const auto& [c, score] : tried) {
    const Model model =
        FitWith(candidates_[c].choice, score.values.empty() ? nullptr : &score.values);
    // A column that causes a part of the force reduces Tc: that alone does not rule it out.
    const std::string_view obstacle = ObstacleTo(model);
    const bool is_column = FollowsForce(candidates_[c]);
    if (!obstacle.empty() && !(is_column && obstacle == "confounded" && Gains(model.fit))) continue;
    // A measured column is preferred to a term that gains less than twice as much.
    const double gain = base_.fit.rms - model.fit.rms;
    by_gain.emplace(is_column ? gain / Limits().rival : gain, candidates_[c].considered.name);
  }
  std::vector<std::string> names;
  for (auto& [gain, name] : by_gain) names.push_back(std::move(name));
  return names;
}

}  // namespace

TermSelection SelectTerms(std::span<const RecordView> records, const FitOptions& options) {
  return Selection(records).Run(options);
}

std::vector<std::string> LikelyTerms(std::span<const RecordView> records, const FitOptions& options,
                                     const FitResult& fit, std::size_t most) {
  if (options.response() != loop::Channel::kForce) return {};
  return Selection(records).Likely(options, fit, most);
}

}  // namespace mindahl::identification
