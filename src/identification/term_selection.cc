#include "mindahl/identification/term_selection.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "core/extremes.h"
#include "core/probability.h"
#include "identification/diagnosis/adequacy.h"
#include "identification/diagnosis/diagnosis.h"
#include "identification/diagnosis/grade.h"
#include "identification/inference/noise.h"
#include "identification/intervals.h"
#include "identification/judge/judge.h"
#include "identification/problem/parameters.h"
#include "identification/term_scores.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/terms.h"

namespace mindahl::identification {

using loop::RecordView;

namespace {

/// A candidate that needs more is nearly confounded with the rest.
constexpr int kEnoughIterations = 60;

/// A candidate of one selection.
struct TermCandidate {
  ConsideredTerm considered;
  std::vector<std::string> terms;
  std::string covariate;  // the column; empty where it is none

  [[nodiscard]] std::size_t size() const { return terms.size() + (covariate.empty() ? 0 : 1); }
  [[nodiscard]] bool is_lag() const { return considered.name == "lag"; }
  [[nodiscard]] bool is_drag() const { return considered.name == "drag"; }
  [[nodiscard]] bool is_of_speed() const {
    return std::ranges::any_of(terms, [](const std::string& term) {
      return term == "viscous" || term == "speed_exponent" || term == "slip_speed" ||
             term == "drag_fraction";
    });
  }
};

/// A model of the selection, fitted at Depth::kEstimate.
struct CandidateModel {
  FitOptions options;  // as the user gives them, with terms
  FitResult fit;
  double sum_of_squares = std::numeric_limits<double>::infinity();  // in units of rounding
};

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
std::string_view ObstacleTo(const loop::Covariate& covariate, const RecordView& record,
                            const FitResult& law, std::span<const std::string> before) {
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
  return FollowsContact(covariate.values, law.records.front().fitted_force) ? "confounded" : "";
}

bool HasCovariate(const RecordView& record, const std::string& name) {
  return std::ranges::find(record.covariates, name, &loop::Covariate::name) !=
         record.covariates.end();
}

bool IsConstant(std::span<const double> values) {
  const auto [lowest, highest] = ExtremesOf(values);
  return !(highest > lowest);
}

std::vector<TermCandidate> ListTermCandidates(std::span<const RecordView> records,
                                              const FitOptions& options, const FitResult& law) {
  std::vector<TermCandidate> candidates;
  const auto is_timed = [](const RecordView& record) { return !record.time.empty(); };
  const bool timed = std::ranges::all_of(records, is_timed);
  for (const TermGroup& group : TermGroups()) {
    if (!group.is_tried) continue;
    TermCandidate candidate;
    candidate.considered.name = group.name;
    bool has_data = true;
    for (const std::string_view name : group.terms) {
      const Term& term = *FindTerm(name);
      has_data = has_data && (timed || !term.needs_time);
      if (!HasTerm(options, std::string(name))) candidate.terms.emplace_back(name);
    }
    if (has_data && !candidate.terms.empty()) candidates.push_back(std::move(candidate));
  }
  std::vector<std::string> columns = options.covariates;
  for (const loop::Covariate& covariate : records.front().covariates) {
    const bool is_there = std::ranges::find(columns, covariate.name) != columns.end();
    const auto has_it = [&](const RecordView& record) {
      return HasCovariate(record, covariate.name);
    };
    if (is_there || !std::ranges::all_of(records, has_it) || IsConstant(covariate.values)) continue;
    const std::string_view obstacle = ObstacleTo(covariate, records.front(), law, columns);
    TermCandidate& candidate = candidates.emplace_back();
    candidate.considered.name = NameOfCovariate(covariate.name);
    candidate.considered.obstacle = obstacle;
    if (obstacle == "same_channel") continue;  // reported, never fitted
    columns.push_back(covariate.name);
    candidate.covariate = covariate.name;
  }
  return candidates;
}

/// True if the slip force lies within a quarter of its value.
bool KnowsSlipForce(const FitResult& fit) {
  constexpr double kQuarter = 0.25;
  const ParameterEstimate& slip_force = *fit.Find("slip_force");
  if (slip_force.status == ParameterStatus::kFixed) return true;
  return slip_force.lower95 && slip_force.upper95 &&
         *slip_force.upper95 - *slip_force.lower95 <= 2 * kQuarter * std::abs(slip_force.value);
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
    const bool is_at_bound = estimate.status == ParameterStatus::kAtLowerBound ||
                             estimate.status == ParameterStatus::kAtUpperBound;
    const Term& term = *TermOfParameter(estimate.name);
    const bool may_end = term.positive || term.theory_bound != TheoryBound::kNone ||
                         term.id == TermId::kDisplacementOffset;
    return is_at_bound && !may_end;
  });
}

/// True if hardly more than white noise is left.
bool IsNearlyWhite(const FitResult& fit) {
  constexpr double kNearlyWhite = 1.2;  // mean square over the variance of the white part
  return fit.rms * fit.rms <= kNearlyWhite * WhiteVariance(fit);
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

bool IsUnphysical(const TermScore& score) {
  return std::ranges::any_of(score.values, [](const auto& value) {
    return IsPositiveTerm(value.first) && value.second < 0;
  });
}

/// Holds the law that another candidate of a round gives in place of the one that was added.
struct Alternative {
  std::string name;
  std::map<std::string, double> law;  // differences of θ of σ, α and Tc
  double sum_of_squares = 0.0;        // with it, to first order
};

/// Includes in the intervals what alternatives make of the law, Tc no further than what a loop that
/// slides has carried.
void IncludeAlternatives(std::span<const Alternative> alternatives, const Thresholds& thresholds,
                         FitResult& fit) {
  const loop::LoopFacts& facts = fit.WidestRecord().facts;
  const bool slides = loop::Slides(facts);
  for (const Alternative& alternative : alternatives) {
    for (const auto& [name, difference] : alternative.law) {
      const auto estimate = std::ranges::find(fit.parameters, name, &ParameterEstimate::name);
      if (estimate == fit.parameters.end() || !estimate->lower95 || !estimate->upper95) continue;
      const double step = std::clamp(difference, -kFarthestStep, kFarthestStep);
      const bool is_shape = name == "alpha";
      double value =
          is_shape ? std::max(0.0, estimate->value + step) : estimate->value * std::exp(step);
      if (name == "slip_force" && slides) {
        const double ratio = fit.WidestRecord().load_ratio;
        value = std::clamp(value, std::min(*facts.half_gap / ratio, estimate->value),
                           std::max(facts.peak_force / ratio, estimate->value));
      }
      Include(*estimate, {.source = IntervalSource::kOmittedTerms, .lower = value, .upper = value});
    }
  }
  for (Finding& finding : FindWideIntervals(fit, thresholds)) {
    const bool is_there = std::ranges::any_of(fit.findings, [&](const Finding& other) {
      return std::string_view(other.code) == std::string_view(finding.code);
    });
    if (!is_there) fit.findings.push_back(std::move(finding));
  }
  Judge(fit.parameters, fit.findings);
}

/// Drops the causes whose remedy was tried and refused: advice that would be followed in vain.
void DropCausesOf(const ConsideredTerm& refused, std::vector<Cause>& causes) {
  const TermGroup* group = FindTermGroup(refused.name);
  std::erase_if(causes, [&](const Cause& cause) {
    if (group == nullptr) return NameOfCovariate(cause.term) == refused.name;
    const TermGroup* other = FindTermGroup(cause.term);
    return other != nullptr && other->terms.front() == group->terms.front();
  });
}

/// Gives the options the values of what a fit has found, to begin with.
void StartFrom(const FitResult& fit, FitOptions& options) {
  for (const ParameterEstimate& parameter : fit.parameters) {
    if (parameter.status != ParameterStatus::kFixed) {
      options.start[parameter.name] = parameter.value;
    }
  }
}

class Selection {
 public:
  Selection(std::span<const RecordView> records, const TermSelectionOptions& options,
            TermSelection& result)
      : records_(records), selection_(options), result_(result) {}

  void Run(const FitOptions& options);
  std::vector<std::string> Likely(const FitOptions& options, const FitResult& law);
  bool RunNamed(FitOptions options, std::span<const std::string> names);

 private:
  /// A candidate that was scored in a round.
  struct TermTrial {
    TermCandidate* candidate;
    TermScore score;
    double sum_of_squares;  // in units of rounding, after the linear step
    double rank;            // ln of the rms of prediction; or ΔAICc
  };

  [[nodiscard]] FitOptions With(const TermCandidate& candidate, FitOptions options) const;
  std::optional<CandidateModel> FitFrom(const CandidateModel& base, FitOptions options,
                                        const std::map<std::string, double>& starts);
  bool Begin(const FitOptions& options, const FitResult& law);
  void MakeScores(const FitOptions& options, const FitResult& law);
  void DivideIntoParts(const FitResult& fit);
  void Judge(const TermScore& base, const TermScore& trial, ConsideredTerm& considered) const;
  [[nodiscard]] Evidence EvidenceOfJudged() const;
  TermCandidate* FindCandidate(std::string_view name);
  std::vector<TermTrial> ScoreCandidates();
  bool IsRefused(const TermTrial& trial, std::span<const TermTrial> trials) const;
  std::vector<const TermTrial*> WithSimpler(const TermTrial& trial,
                                            std::span<const TermTrial> trials) const;
  bool Round();
  void AddMeasuredGap();
  bool Accept(const CandidateModel& model);
  void Add(TermCandidate& candidate, CandidateModel model, double gain);
  bool MoveWithout(const std::vector<std::string_view>& dropped, std::string_view instead);
  void Simplify();
  [[nodiscard]] bool MayBeVirgin(const FitOptions& options);
  void FitLast();
  void KeepAlternatives(const TermTrial& added, std::span<const TermTrial> trials, double chance);
  [[nodiscard]] double SquaresOf(double rms) const { return SumOfSquares(rms, samples_); }
  [[nodiscard]] bool MayFit(std::size_t more) const {
    return result_.estimates + more + kMostLast <= selection_.most_fits;
  }

  static constexpr std::size_t kMostLast = 4;  // fits of FitLast()
  std::span<const RecordView> records_;
  const TermSelectionOptions& selection_;
  TermSelection& result_;
  std::vector<TermCandidate> candidates_;
  CandidateModel base_;  // with the terms that were added
  FitResult judged_;     // the last one with intervals; of base_ or of a smaller model
  std::optional<TermScores> scores_;
  std::vector<Alternative> alternatives_;
  ScoredSamples samples_;
  std::vector<Part> parts_;
  std::size_t folds_ = 0;
  std::vector<std::vector<bool>> held_out_;
  loop::LoopFacts facts_;    // of the widest record
  double load_ratio_ = 1.0;  // likewise
};

FitOptions Selection::With(const TermCandidate& candidate, FitOptions options) const {
  options.terms.insert(options.terms.end(), candidate.terms.begin(), candidate.terms.end());
  if (!candidate.covariate.empty()) options.covariates.push_back(candidate.covariate);
  return options;
}

/// Fits from the solution of a smaller model; nothing where the data are not enough, or it fails.
/// @param options  with the terms of the larger one
/// @param starts   of these
std::optional<CandidateModel> Selection::FitFrom(const CandidateModel& base, FitOptions options,
                                                 const std::map<std::string, double>& starts) {
  CandidateModel model;
  model.options = options;
  HoldInitialStates(base.fit, options);
  options.preparation.force_sense = base.fit.force_sense;
  options.preparation.held_out = held_out_;
  options.starts = 1;
  options.max_iterations = std::min(options.max_iterations, kEnoughIterations);
  StartFrom(base.fit, options);
  for (const auto& [name, value] : starts) options.start[name] = value;
  try {
    ++result_.estimates;
    Fitter fitter(options);
    model.fit = fitter.Fit(records_, Depth::kEstimate);
  } catch (const InvalidArgument&) {
    return std::nullopt;  // not identifiable here, or the rig is softer than the loop
  }
  if (!IsFitted(model.fit) || !model.fit.converged) return std::nullopt;
  if (const std::optional<FitOptions> within =
          WithinMeasuredForce(facts_, load_ratio_, model.fit.law.slip_force, model.options)) {
    std::map<std::string, double> at_bound = starts;
    at_bound["slip_force"] = within->bounds.at("slip_force").upper;
    return FitFrom(model, *within, at_bound);
  }
  model.sum_of_squares = SquaresOf(model.fit.rms);
  return model;
}

/// Prepares the records for all candidates at once. What a lag leaves out is left out for all: else
/// fits would be compared on other samples.
void Selection::MakeScores(const FitOptions& options, const FitResult& law) {
  std::vector<std::string> terms;
  std::vector<std::string> covariates = options.covariates;
  for (const TermCandidate& candidate : candidates_) {
    terms.insert(terms.end(), candidate.terms.begin(), candidate.terms.end());
    if (!candidate.covariate.empty()) covariates.push_back(candidate.covariate);
  }
  FitOptions as_fitted = options;
  as_fitted.preparation.force_sense = law.force_sense;
  try {
    scores_.emplace(records_, as_fitted, terms, covariates);
  } catch (const InvalidArgument&) {
    std::erase(terms, "lag");  // no time that goes on
    scores_.emplace(records_, as_fitted, terms, covariates);
  }
  held_out_ = scores_->LeftOut();
}

/// Into cycles where there are four, else into strokes.
void Selection::DivideIntoParts(const FitResult& fit) {
  constexpr std::size_t kEnoughCycles = 4;
  parts_ = ClosedCycles(fit, samples_.mask, 0);
  if (parts_.size() < kEnoughCycles) parts_ = Strokes(fit, samples_.mask, 0);
  folds_ = std::min(selection_.folds, parts_.size());
  if (folds_ % 2 == 0 && folds_ > 2) --folds_;
  result_.held_out_parts = parts_.size();
}

/// The gain of prediction, by the logarithms of the ratios of errors, part by part, which a few
/// parts with large errors do not make or hide; and its probability by chance, by the terms'
/// effects on the parts or, of few parts, by these logarithms.
void Selection::Judge(const TermScore& base, const TermScore& trial,
                      ConsideredTerm& considered) const {
  const double rounding = samples_.rounding * samples_.rounding;
  std::vector<double> log_ratio(parts_.size());
  for (std::size_t c = 0; c < parts_.size(); ++c) {
    log_ratio[c] = std::log(std::max(base.predictions[c], rounding) /
                            std::max(trial.predictions[c], rounding)) /
                   2;
  }
  const MeanOverParts gain = Mean(log_ratio, parts_, folds_);
  considered.gain = 1 - std::exp(-gain.mean);
  considered.p_value = trial.p_value ? *trial.p_value : ChanceOfMean(gain, parts_.size());
}

/// Weighs fits by the independent samples that the judged one has.
Evidence Selection::EvidenceOfJudged() const {
  return Evidence(samples_.count, std::min(judged_.residuals.effective_samples,
                                           static_cast<double>(samples_.count)));
}

/// Returns a null pointer where the records do not allow that candidate.
TermCandidate* Selection::FindCandidate(std::string_view name) {
  const auto found = std::ranges::find_if(candidates_, [&](const TermCandidate& candidate) {
    return candidate.considered.name == name;
  });
  return found == candidates_.end() ? nullptr : &*found;
}

/// Scores every candidate that is left by a linear step; the best first.
std::vector<Selection::TermTrial> Selection::ScoreCandidates() {
  const Evidence evidence = EvidenceOfJudged();
  const std::size_t free = CountFreeParameters(base_.fit);
  scores_->StepFrom(base_.fit, base_.options, parts_, folds_);
  const TermScore before = scores_->OfFit();
  std::vector<TermTrial> trials;
  for (TermCandidate& candidate : candidates_) {
    ConsideredTerm& considered = candidate.considered;
    if (considered.added) continue;
    std::erase_if(candidate.terms,
                  [&](const std::string& term) { return HasTerm(base_.options, term); });
    if (candidate.size() == 0) {  // another one that was added has it all
      considered.gain = 0.0;
      considered.p_value = 1.0;
      continue;
    }
    std::optional<TermScore> score;
    try {
      score = scores_->Of(With(candidate, base_.options));
    } catch (const InvalidArgument&) {
      continue;  // no lag where time does not go on
    }
    if (!score) continue;
    considered.is_predicted = !parts_.empty();
    if (considered.obstacle != "confounded") considered.obstacle = "";
    TermTrial trial{&candidate, std::move(*score), 0.0, 0.0};
    trial.sum_of_squares = SquaresOf(trial.score.rms);
    if (considered.is_predicted) {
      Judge(before, trial.score, considered);
      trial.rank = -considered.gain;
    } else {
      const double squares = SquaresOf(before.rms);
      const double ratio = evidence.LikelihoodRatio(squares, trial.sum_of_squares);
      considered.gain = 1 - std::min(trial.score.rms / before.rms, 1.0);
      considered.p_value =
          ratio > 0 ? PValueOfChiSquared(ratio, static_cast<double>(candidate.size())) : 1.0;
      trial.rank = evidence.Aicc(trial.sum_of_squares, free + candidate.size()) -
                   evidence.Aicc(squares, free);
    }
    trials.push_back(std::move(trial));
  }
  std::ranges::stable_sort(trials, {}, &TermTrial::rank);
  return trials;
}

/// True if a candidate that gains is not to be added, and says why where that is to be reported.
bool Selection::IsRefused(const TermTrial& trial, std::span<const TermTrial> trials) const {
  ConsideredTerm& considered = trial.candidate->considered;
  if (considered.obstacle == "confounded") return true;
  // Beside a slip force of the speed a further force of speed and the slip force at rest are
  // confounded; a drag is that force with the slip force that at v₀.
  const bool has_slip_speed = std::ranges::find(result_.added, "slip_speed") != result_.added.end();
  if (trial.candidate->is_drag() && !has_slip_speed) return true;
  const bool is_of_knee =
      trial.candidate->is_lag() && std::ranges::any_of(trials, [&](const TermTrial& other) {
        return other.candidate->is_of_speed() && other.sum_of_squares < 2 * trial.sum_of_squares;
      });
  if (is_of_knee) considered.obstacle = "rate_dependent";
  if (IsUnphysical(trial.score)) considered.obstacle = "unphysical";
  return !considered.obstacle.empty();
}

/// Returns the candidates that have some of a candidate's terms and at least half its gain, the
/// simplest first, and the candidate itself.
std::vector<const Selection::TermTrial*> Selection::WithSimpler(
    const TermTrial& trial, std::span<const TermTrial> trials) const {
  constexpr double kOfGain = 0.5;
  std::vector<const TermTrial*> all;
  for (const TermTrial& other : trials) {
    const std::vector<std::string>& terms = trial.candidate->terms;
    const auto is_of_trial = [&](const std::string& term) {
      return std::ranges::find(terms, term) != terms.end();
    };
    const bool is_simpler = other.candidate->covariate.empty() &&
                            other.candidate->terms.size() < terms.size() &&
                            std::ranges::all_of(other.candidate->terms, is_of_trial);
    const bool gains =
        other.candidate->considered.gain >= kOfGain * trial.candidate->considered.gain;
    if (is_simpler && gains && !IsRefused(other, trials)) all.push_back(&other);
  }
  std::ranges::stable_sort(all, {}, [](const TermTrial* one) { return one->candidate->size(); });
  all.push_back(&trial);
  return all;
}

/// Keeps what candidates that gain at least half as much as the one that is added would make of the
/// law: the record may have been made by them.
void Selection::KeepAlternatives(const TermTrial& added, std::span<const TermTrial> trials,
                                 double chance) {
  constexpr double kOfGain = 0.5;
  for (const TermTrial& other : trials) {
    const ConsideredTerm& considered = other.candidate->considered;
    const bool explains = considered.p_value < chance &&
                          considered.gain >= kOfGain * added.candidate->considered.gain;
    if (&other == &added || !explains || !other.candidate->covariate.empty()) continue;
    if (considered.obstacle == "unphysical") continue;
    Alternative& alternative =
        alternatives_.emplace_back(Alternative{considered.name, {}, other.sum_of_squares});
    for (const auto& [name, step] : other.score.law) {
      const auto of_added = added.score.law.find(name);
      if (of_added != added.score.law.end()) alternative.law.emplace(name, step - of_added->second);
    }
  }
}

/// Moves to the model with the best candidate that is no chance; false where there is none.
bool Selection::Round() {
  constexpr std::size_t kMostTried = 4;  // fits a round
  const std::vector<TermTrial> trials = ScoreCandidates();
  const double chance =
      selection_.chance / static_cast<double>(std::max<std::size_t>(trials.size(), 1));
  // A simpler candidate is taken where a larger one would not leave that much less.
  const double nearly = (1 + selection_.smallest_gain) * (1 + selection_.smallest_gain);
  const bool is_first = result_.added.empty();
  std::map<const TermCandidate*, std::optional<CandidateModel>> fitted;
  const auto fit = [&](const TermTrial& trial) -> std::optional<CandidateModel>* {
    const auto found = fitted.find(trial.candidate);
    if (found != fitted.end()) return &found->second;
    if (fitted.size() == (is_first ? 2 * kMostTried : kMostTried) || !MayFit(1)) return nullptr;
    return &fitted
                .emplace(trial.candidate,
                         FitFrom(base_, With(*trial.candidate, base_.options), trial.score.values))
                .first->second;
  };
  const auto is_wanted = [&](const TermTrial& trial) {
    const ConsideredTerm& considered = trial.candidate->considered;
    if (parts_.empty() && !(trial.rank < 0)) return false;
    return considered.p_value < chance && considered.gain >= selection_.smallest_gain &&
           !IsRefused(trial, trials);
  };
  const auto add = [&](const TermTrial& trial, CandidateModel& model) {
    ConsideredTerm& considered = trial.candidate->considered;
    const double gain = 1 - std::sqrt(model.sum_of_squares / base_.sum_of_squares);
    if (gain < selection_.smallest_gain) return false;
    if (IsUnphysical(model.fit)) {
      considered.obstacle = "unphysical";
      return false;
    }
    if (!Accept(model)) {
      considered.obstacle = "confounded";
      return false;
    }
    KeepAlternatives(trial, trials, chance);
    Add(*trial.candidate, std::move(model), gain);
    return true;
  };
  // One term that leaves nothing but noise comes before any that only predicts best at first, the
  // simplest before others; it gains most of what is missed already to first order.
  constexpr double kMost = 0.5;
  std::vector<std::pair<const TermTrial*, CandidateModel>> alone;
  for (const TermTrial& trial : trials) {
    if (!is_first || fitted.size() == kMostTried || !MayFit(2)) break;
    if (!is_wanted(trial) || trial.candidate->considered.gain < kMost) continue;
    std::optional<CandidateModel> model = *fit(trial);
    if (model && IsNearlyWhite(model->fit)) alone.emplace_back(&trial, std::move(*model));
  }
  std::ranges::stable_sort(alone, {}, [](const auto& one) { return one.first->candidate->size(); });
  for (auto& [trial, model] : alone) {
    if (add(*trial, model)) return true;
  }
  for (const TermTrial& best : trials) {
    if (!is_wanted(best)) continue;
    for (const TermTrial* trial : WithSimpler(best, trials)) {
      if (!trial->candidate->considered.obstacle.empty()) continue;
      std::optional<CandidateModel>* const model = fit(*trial);
      if (model == nullptr) return false;
      if (!*model || !((*model)->sum_of_squares < base_.sum_of_squares)) continue;
      if (trial != &best && (*model)->sum_of_squares > nearly * best.sum_of_squares) continue;
      if (add(*trial, **model)) return true;
    }
  }
  return false;
}

/// Moves to the model with a gap that was measured without one, in all records, where that gains:
/// no linear step from a contact that is too soft for the want of a gap predicts it.
void Selection::AddMeasuredGap() {
  TermCandidate* const gap = FindCandidate("backlash");
  const bool is_measured = std::ranges::all_of(
      judged_.records, [](const RecordFit& record) { return record.facts.backlash.has_value(); });
  if (gap == nullptr || !is_measured) return;
  CandidateModel from = base_;
  from.fit.parameters.clear();  // from starts of its own
  std::optional<CandidateModel> model = FitFrom(from, With(*gap, base_.options), {});
  if (!model || !(model->sum_of_squares < base_.sum_of_squares)) return;
  const double ratio =
      EvidenceOfJudged().LikelihoodRatio(base_.sum_of_squares, model->sum_of_squares);
  const double p_value = PValueOfChiSquared(ratio, 1.0);
  const double gain = 1 - std::sqrt(model->sum_of_squares / base_.sum_of_squares);
  if (gain < selection_.smallest_gain || !(p_value < selection_.chance) ||
      IsUnphysical(model->fit) || !Accept(*model)) {
    return;
  }
  gap->considered.p_value = p_value;
  Add(*gap, std::move(*model), gain);
}

/// True if a larger model keeps the slip force of the smaller one. Of a loop that slides over most
/// of its stroke the half gap is enough to see that, and the estimates are; otherwise, or where the
/// residuals are nearly white, the larger model is judged, and replaces the one that was.
bool Selection::Accept(const CandidateModel& model) {
  const FitResult& fit = model.fit;
  const bool is_nearly_white = IsNearlyWhite(fit);
  if (LeavesHalfGap(facts_, base_.fit.law.slip_force, fit.law.slip_force) && !is_nearly_white) {
    return false;
  }
  if (StopsAtLimit(fit) && !StopsAtLimit(base_.fit)) return false;
  if (loop::Slides(facts_) && !is_nearly_white) return true;
  ++result_.estimates;
  Fitter fitter(ContinuedFrom(fit, model.options));
  const FitResult& now = fitter.Fit(records_, Depth::kIntervals);
  // At a limit of the search no parameter would be known.
  const bool is_limited = now.FindFinding("search_limit") != nullptr;
  if (!IsFitted(now) || IsUnphysical(now)) return false;
  if (is_limited && judged_.FindFinding("search_limit") == nullptr) return false;
  if (OpensSlipForce(judged_, now, model.options.thresholds.widest_ratio)) return false;
  judged_ = now;
  return true;
}

/// Moves to the model with a candidate.
/// @param gain  reduction of the rms [-]
void Selection::Add(TermCandidate& candidate, CandidateModel model, double gain) {
  candidate.considered.gain = gain;
  candidate.considered.added = true;
  result_.added.push_back(candidate.considered.name);
  base_ = std::move(model);
}

/// Moves to the model without some terms, and with one in their place unless that is empty, where
/// it leaves nothing but noise and has no larger AICc.
/// @returns false where the present model stays
bool Selection::MoveWithout(const std::vector<std::string_view>& dropped,
                            std::string_view instead) {
  CandidateModel from = base_;
  for (const std::string_view name : dropped) {
    for (const std::string& term : FindCandidate(name)->terms) {
      std::erase(from.options.terms, term);
      std::erase_if(from.fit.parameters, [&](const ParameterEstimate& estimate) {
        return TermNameOf(estimate.name) == term;
      });
    }
  }
  TermCandidate* const simpler = FindCandidate(instead);
  if (!instead.empty()) {
    if (simpler == nullptr || simpler->considered.added) return false;
    from.options = With(*simpler, from.options);
    from.fit.parameters.clear();  // from starts of its own
  }
  if (!MayFit(1)) return false;
  std::optional<CandidateModel> model = FitFrom(from, from.options, {});
  if (!model || IsUnphysical(model->fit) || StopsAtLimit(model->fit) ||
      !IsNearlyWhite(model->fit)) {
    return false;
  }
  const Evidence evidence = EvidenceOfJudged();
  if (evidence.Aicc(model->sum_of_squares, CountFreeParameters(model->fit)) >
      evidence.Aicc(base_.sum_of_squares, CountFreeParameters(base_.fit))) {
    return false;
  }
  for (const std::string_view name : dropped) {
    FindCandidate(name)->considered.added = false;
    std::erase(result_.added, std::string(name));
  }
  alternatives_.clear();  // to terms that are not there any more
  if (simpler == nullptr) {
    base_ = std::move(*model);
  } else {
    simpler->considered.obstacle = "";
    const double gain = 1 - std::sqrt(model->sum_of_squares / SquaresOf(result_.fit.rms));
    Add(*simpler, std::move(*model), gain);
  }
  return true;
}

/// Drops the terms that are needless where nothing but noise is left: one that was added early may
/// have nothing left to do beside those added later, and a slip force of the speed with a drag may
/// be a slip force and a force of the speed, which takes a part of the half gap: where nothing but
/// noise is left, that is no reason against it.
void Selection::Simplify() {
  if (!IsNearlyWhite(base_.fit)) return;  // what is needless shows where nothing else is wrong
  const auto is_added = [&](std::string_view name) {
    const TermCandidate* const candidate = FindCandidate(name);
    return candidate != nullptr && candidate->considered.added;
  };
  if (is_added("slip_speed") && is_added("drag")) {
    for (const std::string_view simpler : {"viscous", "speed_exponent"}) {
      if (MoveWithout({"slip_speed", "drag"}, simpler)) break;
    }
  }
  if (result_.added.size() < 2) return;
  for (const std::string& name : std::vector<std::string>(result_.added)) {
    const bool is_needed = name == "slip_speed" && is_added("drag");
    if (!is_needed && FindCandidate(name)->covariate.empty()) MoveWithout({name}, "");
  }
}

/// Lists the candidates and takes the law as the model to add to; false where it has no fit.
bool Selection::Begin(const FitOptions& options, const FitResult& law) {
  candidates_ = ListTermCandidates(records_, options, law);
  MakeScores(options, law);
  facts_ = law.WidestRecord().facts;
  load_ratio_ = law.WidestRecord().load_ratio;
  samples_ = CountedSamples(law, records_);
  base_.fit = law;
  std::optional<CandidateModel> start = FitFrom(base_, options, {});
  if (!start) return false;
  base_ = std::move(*start);
  DivideIntoParts(base_.fit);
  judged_ = law;
  return true;
}

std::vector<std::string> Selection::Likely(const FitOptions& options, const FitResult& law) {
  std::vector<std::string> names;
  if (!IsFitted(law) || !Begin(options, law)) return names;
  if (std::ranges::all_of(
          law.records, [](const RecordFit& record) { return record.facts.backlash.has_value(); })) {
    names.emplace_back("backlash");
  }
  const std::vector<TermTrial> trials = ScoreCandidates();
  for (const TermTrial& trial : trials) {
    const ConsideredTerm& considered = trial.candidate->considered;
    const bool gains = considered.gain >= selection_.smallest_gain;
    const bool is_there = std::ranges::find(names, considered.name) != names.end();
    if (gains && !is_there && !IsRefused(trial, trials)) names.push_back(considered.name);
  }
  return names;
}

void Selection::Run(const FitOptions& options) {
  ++result_.estimates;
  Fitter first(options);
  result_.options = options;
  result_.fit = first.Fit(records_, Depth::kFull);
  const Adequacy& adequacy = result_.fit.adequacy;
  const bool is_described = adequacy.verdict == AdequacyVerdict::kAdequate ||
                            (selection_.only_for_use && adequacy.use == Use::kQuantitative &&
                             KnowsSlipForce(result_.fit));
  if (!IsFitted(result_.fit) || is_described || options.response() != loop::Channel::kForce) return;

  if (!Begin(options, result_.fit)) return;
  AddMeasuredGap();
  while (judged_.adequacy.verdict != AdequacyVerdict::kAdequate &&
         result_.added.size() < selection_.most_terms && Round()) {
  }
  if (!result_.added.empty()) {
    Simplify();
    FitResult law = std::move(result_.fit);
    FitLast();
    // Terms replace a law of quantitative use where nothing but noise is left.
    const bool is_of_no_use =
        selection_.only_for_use && (result_.fit.adequacy.use == Use::kNone ||
                                    (law.adequacy.use == Use::kQuantitative &&
                                     result_.fit.adequacy.verdict != AdequacyVerdict::kAdequate));
    if (!IsFitted(result_.fit) || is_of_no_use) {
      result_.fit = std::move(law);
      result_.added.clear();
      for (TermCandidate& candidate : candidates_) candidate.considered.added = false;
    } else {
      result_.options.terms = base_.options.terms;
      result_.options.covariates = base_.options.covariates;
    }
  }
  for (const TermCandidate& candidate : candidates_) {
    const ConsideredTerm& considered = candidate.considered;
    if (!considered.obstacle.empty()) DropCausesOf(considered, result_.fit.adequacy.causes);
    result_.considered.push_back(considered);
  }
  std::ranges::stable_sort(result_.considered, std::greater(), &ConsideredTerm::gain);
  const auto place = [&](const ConsideredTerm& term) {
    return std::ranges::find(result_.added, term.name) - result_.added.begin();
  };
  std::ranges::stable_sort(result_.considered, {}, place);
}

/// True if an initial state that was found steady may be virgin: what was held out, and the want of
/// terms, may have hidden it.
/// @param options  with starts where the chosen model is
bool Selection::MayBeVirgin(const FitOptions& options) {
  const bool is_open = !options.initial_state && options.initial_states.empty() &&
                       std::ranges::any_of(base_.fit.records, [](const RecordFit& record) {
                         return record.initial_state == models::InitialState::kSteady;
                       });
  if (!is_open) return false;
  const auto rms_of = [&](const FitOptions& tried) {
    ++result_.estimates;
    const FitResult estimate = Fitter(tried).Fit(records_, Depth::kEstimate);
    return IsFitted(estimate) && estimate.converged ? estimate.rms
                                                    : std::numeric_limits<double>::infinity();
  };
  FitOptions virgin = options;
  virgin.initial_state = models::InitialState::kVirgin;
  return rms_of(virgin) < (1 - selection_.smallest_gain) * rms_of(options);
}

/// Fits the chosen model at full depth from where it is. A slip force that was kept within the
/// measured force is let go where the model is adequate.
void Selection::FitLast() {
  FitOptions from_here = base_.options;
  StartFrom(base_.fit, from_here);
  if (MayBeVirgin(from_here)) from_here = base_.options;  // from all starts
  const auto fit = [&] {
    ++result_.estimates;
    Fitter last(from_here);
    result_.fit = last.Fit(records_, Depth::kFull);
  };
  fit();
  const bool is_bounded_by_user = result_.options.bounds.contains("slip_force");
  const bool is_bounded = from_here.bounds.contains("slip_force") && !is_bounded_by_user;
  if (is_bounded && IsFitted(result_.fit) &&
      result_.fit.adequacy.verdict == AdequacyVerdict::kAdequate) {
    from_here.bounds.erase("slip_force");
    fit();
  }
  // One term that leaves but noise rules out what leaves twice as much.
  const bool is_settled =
      result_.added.size() == 1 && result_.fit.adequacy.verdict == AdequacyVerdict::kAdequate;
  std::erase_if(alternatives_, [&](const Alternative& alternative) {
    return std::ranges::find(result_.added, alternative.name) != result_.added.end() ||
           (is_settled && alternative.sum_of_squares > 2 * SquaresOf(result_.fit.rms));
  });
  if (IsFitted(result_.fit)) {
    IncludeAlternatives(alternatives_, base_.options.thresholds, result_.fit);
  }
}

/// Adds the named terms one after the other, each from the solution without it.
/// @returns false where one of them cannot be fitted
bool Selection::RunNamed(FitOptions options, std::span<const std::string> names) {
  result_.options = options;
  for (const std::string& name : names) {
    TermCandidate& candidate = candidates_.emplace_back();
    candidate.considered.name = name;
    for (const std::string_view term : FindTermGroup(name)->terms) {
      if (std::erase(options.terms, std::string(term)) > 0) candidate.terms.emplace_back(term);
    }
  }
  ++result_.estimates;
  base_ = {.options = options, .fit = Fitter(options).Fit(records_, Depth::kErrors)};
  if (!IsFitted(base_.fit) || !base_.fit.converged) return false;
  MakeScores(options, base_.fit);
  held_out_ = options.preparation.held_out;
  facts_ = base_.fit.WidestRecord().facts;
  load_ratio_ = base_.fit.WidestRecord().load_ratio;
  samples_ = CountedSamples(base_.fit, records_);
  for (const TermCandidate& candidate : candidates_) {
    scores_->StepFrom(base_.fit, base_.options, {}, 0);
    const std::optional<TermScore> score = scores_->Of(With(candidate, base_.options));
    if (!score) return false;
    std::optional<CandidateModel> model =
        FitFrom(base_, With(candidate, base_.options), score->values);
    if (!model) return false;
    base_ = std::move(*model);
  }
  FitLast();
  return IsFitted(result_.fit);
}

}  // namespace

TermSelection SelectTerms(std::span<const loop::Record> records, const FitOptions& options,
                          const TermSelectionOptions& selection) {
  const std::vector<RecordView> views(records.begin(), records.end());
  return SelectTerms(views, options, selection);
}

TermSelection SelectTerms(std::span<const RecordView> records, const FitOptions& options,
                          const TermSelectionOptions& selection) {
  if (selection.folds < 2) {
    ThrowInvalid("folds [-]", static_cast<double>(selection.folds), "must be >= 2");
  }
  if (!(selection.chance > 0 && selection.chance < 1)) {
    ThrowInvalid("chance [-]", selection.chance, "must lie between 0 and 1");
  }
  RequireNonNegative("smallest gain [-]", selection.smallest_gain);
  TermSelection result;
  if (selection.named.empty()) {
    Selection(records, selection, result).Run(options);
  } else if (!options.start.empty() ||
             !Selection(records, selection, result).RunNamed(options, selection.named)) {
    Fitter all_at_once(options);
    result.fit = all_at_once.Fit(records, Depth::kFull);
  }
  return result;
}

std::vector<std::string> LikelyTerms(std::span<const RecordView> records, const FitOptions& options,
                                     const FitResult& fit, std::size_t most) {
  if (options.response() != loop::Channel::kForce) return {};
  const TermSelectionOptions defaults;
  TermSelection unused;
  std::vector<std::string> names = Selection(records, defaults, unused).Likely(options, fit);
  names.resize(std::min(names.size(), most));
  return names;
}

}  // namespace mindahl::identification
