#include "mindahl/identification/term_selection.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/extremes.h"
#include "identification/free_parameters.h"
#include "identification/held_out.h"
#include "identification/inference/evidence.h"
#include "identification/problem/parameters.h"
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
  bool is_given_up = false;

  [[nodiscard]] std::size_t size() const { return terms.size() + (covariate.empty() ? 0 : 1); }
  [[nodiscard]] bool is_lag() const { return considered.name == "lag"; }
  [[nodiscard]] bool is_of_speed() const {
    return std::ranges::any_of(terms, [](const std::string& term) {
      return term == "viscous" || term == "speed_exponent" || term == "slip_speed";
    });
  }
};

/// A model of the selection, fitted at Depth::kEstimate.
struct CandidateModel {
  FitOptions options;  // as the user gives them, with terms
  FitResult fit;
  double sum_of_squares = std::numeric_limits<double>::infinity();  // in units of rounding
  std::vector<double> predictions;  // mean squares [N²] of the parts; empty until they are made
};

/// Correlation of two columns of one size; 0 where one is constant.
double ColumnCorrelation(std::span<const double> one, std::span<const double> other) {
  double mean_of_one = 0.0;
  double mean_of_other = 0.0;
  const auto count = static_cast<double>(one.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    mean_of_one += one[i] / count;
    mean_of_other += other[i] / count;
  }
  double product = 0.0;
  double squares_of_one = 0.0;
  double squares_of_other = 0.0;
  for (std::size_t i = 0; i < one.size(); ++i) {
    const double a = one[i] - mean_of_one;
    const double b = other[i] - mean_of_other;
    product += a * b;
    squares_of_one += a * a;
    squares_of_other += b * b;
  }
  const double norm = std::sqrt(squares_of_one) * std::sqrt(squares_of_other);
  return norm > 0 ? product / norm : 0.0;
}

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

/// Whether a column says what another one says already.
/// @param before  covariates that are candidates
std::string_view ObstacleTo(const loop::Covariate& covariate, const RecordView& record,
                            const FitResult& law, std::span<const std::string> before) {
  constexpr double kSameChannel = 0.95;
  constexpr double kFollowsContact = 0.3;
  const auto follows = [&](std::span<const double> other, double limit) {
    return std::abs(ColumnCorrelation(covariate.values, other)) > limit;
  };
  if (follows(record.displacement, kSameChannel) || follows(record.force, kSameChannel) ||
      follows(record.time.empty() ? record.displacement : record.time, kSameChannel) ||
      follows(RoughVelocity(record), kSameChannel)) {
    return "same_channel";
  }
  for (const loop::Covariate& other : record.covariates) {
    const bool is_before = std::ranges::find(before, other.name) != before.end();
    if (is_before && follows(other.values, kSameChannel)) return "same_channel";
  }
  return follows(law.records.front().fitted_force, kFollowsContact) ? "confounded" : "";
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
    if (obstacle == "same_channel") continue;
    columns.push_back(covariate.name);
    TermCandidate& candidate = candidates.emplace_back();
    candidate.considered.name = NameOfCovariate(covariate.name);
    candidate.considered.obstacle = obstacle;
    candidate.covariate = covariate.name;
  }
  return candidates;
}

/// Returns the initial value for the search of a term that is not linear.
/// @param law  the fit without it
std::optional<double> FirstGuess(std::string_view term, const FitResult& law) {
  constexpr double kHardlyCompliant = 10.0;  // times the contact's stiffness
  if (term == "lag" || term == "asymmetry") return 0.0;
  if (term == "rig_stiffness") return kHardlyCompliant * law.law.tangential_stiffness;
  return std::nullopt;
}

/// True if a fit has a slip force that another one has lost: the interval that was closed is open,
/// or, of a loop that mostly slides, Tc left the half gap that was measured by more than half of
/// it.
/// @param widest_ratio  of the ends of an interval that is closed
bool LosesSlipForce(const FitResult& without, const FitResult& with, double widest_ratio) {
  constexpr double kMostlySlides = 0.5;  // energy ratio
  constexpr double kRunsAway = 1.5;      // times the half gap
  const auto is_closed = [&](const FitResult& fit) {
    const ParameterEstimate& slip_force = *fit.Find("slip_force");
    return slip_force.lower95 && slip_force.upper95 &&
           *slip_force.upper95 <= widest_ratio * *slip_force.lower95;
  };
  if (is_closed(without) && !is_closed(with)) return true;
  const loop::LoopFacts& facts = without.WidestRecord().facts;
  if (!facts.half_gap || !(facts.energy_ratio > kMostlySlides)) return false;
  const auto is_that_of_the_gap = [&](const FitResult& fit) {
    const double ratio = fit.law.slip_force / std::abs(*facts.half_gap);
    return ratio <= kRunsAway && ratio >= 1 / kRunsAway;
  };
  return is_that_of_the_gap(without) && !is_that_of_the_gap(with);
}

/// True if a mass or a damping is negative: the term stands for something else.
bool IsUnphysical(const FitResult& fit) {
  return std::ranges::any_of(fit.parameters, [](const ParameterEstimate& estimate) {
    const bool is_positive = estimate.name == "inertia" || estimate.name == "viscous";
    return is_positive && estimate.status != ParameterStatus::kFixed && estimate.value < 0;
  });
}

class Selection {
 public:
  Selection(std::span<const RecordView> records, const TermSelectionOptions& options,
            TermSelection& result)
      : records_(records), selection_(options), result_(result) {}

  void Run(const FitOptions& options);

 private:
  [[nodiscard]] FitOptions With(const TermCandidate& candidate, FitOptions options) const;
  std::optional<CandidateModel> FitFrom(const CandidateModel& base, const TermCandidate* candidate);
  std::optional<CandidateModel> FitAnew(const FitOptions& options);
  void KeepToSamplesOfLag(const FitOptions& options);
  void DivideIntoParts(const FitResult& fit);
  bool Predict(CandidateModel& model);
  void Judge(const CandidateModel& base, const CandidateModel& trial,
             ConsideredTerm& considered) const;
  bool Round(std::vector<TermCandidate>& candidates, CandidateModel& base, FitResult& judged);
  bool Accept(CandidateModel& model, FitResult& judged);
  [[nodiscard]] double SquaresOf(const FitResult& fit) const;

  std::span<const RecordView> records_;
  const TermSelectionOptions& selection_;
  TermSelection& result_;
  ScoredSamples samples_;
  std::vector<Part> parts_;
  std::size_t folds_ = 0;
  std::vector<std::vector<bool>> held_out_;
};

FitOptions Selection::With(const TermCandidate& candidate, FitOptions options) const {
  options.terms.insert(options.terms.end(), candidate.terms.begin(), candidate.terms.end());
  if (!candidate.covariate.empty()) options.covariates.push_back(candidate.covariate);
  return options;
}

double Selection::SquaresOf(const FitResult& fit) const { return SumOfSquares(fit.rms, samples_); }

/// From the solution of a smaller model; nothing where the data are not enough, or it fails.
std::optional<CandidateModel> Selection::FitFrom(const CandidateModel& base,
                                                 const TermCandidate* candidate) {
  CandidateModel model;
  model.options = candidate != nullptr ? With(*candidate, base.options) : base.options;
  FitOptions options = model.options;
  HoldInitialStates(base.fit, options);
  options.preparation.force_sense = base.fit.force_sense;
  options.preparation.held_out = held_out_;
  options.starts = 1;
  options.max_iterations = std::min(options.max_iterations, kEnoughIterations);
  for (const ParameterEstimate& parameter : base.fit.parameters) {
    if (parameter.status != ParameterStatus::kFixed)
      options.start[parameter.name] = parameter.value;
  }
  for (const std::string& term : candidate != nullptr ? candidate->terms : base.options.terms) {
    const std::optional<double> start = FirstGuess(term, base.fit);
    if (start) options.start.emplace(term, *start);
  }
  try {
    ++result_.estimates;
    Fitter fitter(options);
    model.fit = fitter.Fit(records_, Depth::kEstimate);
  } catch (const InvalidArgument&) {
    return std::nullopt;  // it is confounded with the others here, or the rig is softer than the
                          // loop
  }
  if (!IsFitted(model.fit) || !model.fit.converged) return std::nullopt;
  model.sum_of_squares = SquaresOf(model.fit);
  return model;
}

/// From the data alone.
std::optional<CandidateModel> Selection::FitAnew(const FitOptions& options) {
  CandidateModel model;
  model.options = options;
  FitOptions whole = options;
  whole.preparation.held_out = held_out_;
  ++result_.estimates;
  Fitter fitter(whole);
  model.fit = fitter.Fit(records_, Depth::kEstimate);
  if (!IsFitted(model.fit) || !model.fit.converged) return std::nullopt;
  model.sum_of_squares = SquaresOf(model.fit);
  return model;
}

/// Leaves out for all what a lag would leave out: else fits would be compared on other samples.
void Selection::KeepToSamplesOfLag(const FitOptions& options) {
  FitOptions with_lag = options;
  if (!HasTerm(options, "lag")) with_lag.fixed.emplace("lag", 0.0);
  Fitter fitter(with_lag);
  try {
    const FitResult& fit = fitter.Fit(records_, Depth::kEstimate);
    held_out_.resize(records_.size());
    for (std::size_t r = 0; r < records_.size(); ++r) {
      held_out_[r].assign(records_[r].size(), false);
      for (std::size_t i = 0; i < records_[r].size(); ++i) {
        held_out_[r][i] = fit.records[r].counts[i] == 0;
      }
    }
  } catch (const InvalidArgument&) {
    held_out_ = options.preparation.held_out;  // no time that goes on: no lag either
  }
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

/// Fills the predictions of the parts; false where a fit without some of them failed.
bool Selection::Predict(CandidateModel& model) {
  if (!model.predictions.empty() || parts_.empty()) return true;
  FitOptions options = ContinuedFrom(model.fit, model.options);
  options.preparation.held_out = held_out_;
  result_.estimates += folds_;
  model.predictions = PredictParts(records_, std::move(options), CountFreeParameters(model.fit),
                                   samples_, parts_, folds_);
  return !model.predictions.empty();
}

/// The gain of prediction and its probability by chance: by the logarithms of the ratios of errors,
/// part by part, which a few parts with large errors do not make or hide.
void Selection::Judge(const CandidateModel& base, const CandidateModel& trial,
                      ConsideredTerm& considered) const {
  const double rounding = samples_.rounding * samples_.rounding;
  std::vector<double> log_ratio(parts_.size());
  for (std::size_t c = 0; c < parts_.size(); ++c) {
    log_ratio[c] = std::log(std::max(base.predictions[c], rounding) /
                            std::max(trial.predictions[c], rounding)) /
                   2;
  }
  const MeanOverParts gain = Mean(log_ratio, parts_, folds_);
  considered.is_predicted = true;
  considered.gain = 1 - std::exp(-gain.mean);
  const double t = gain.standard_error > 0 ? gain.mean / gain.standard_error : 0.0;
  const double beyond = PValueOfF(t * t, static_cast<double>(parts_.size() - 1)) / 2;
  considered.p_value = t > 0 ? beyond : 1 - beyond;
}

/// Moves to the model with the best candidate that is no chance; false where there is none.
bool Selection::Round(std::vector<TermCandidate>& candidates, CandidateModel& base,
                      FitResult& judged) {
  constexpr std::size_t kPredicted = 4;
  constexpr double kHopelessGain = 0.1;  // of the least gain: not tried again in later rounds
  const Evidence evidence(samples_.count, std::min(judged.residuals.effective_samples,
                                                   static_cast<double>(samples_.count)));
  const double before = evidence.Aicc(base.sum_of_squares, CountFreeParameters(base.fit));
  struct TermTrial {
    TermCandidate* candidate;
    CandidateModel model;
    double delta_aicc;
    double rank;  // ln of the rms with each parameter taken for worth the least gain; or ΔAICc
  };
  std::vector<TermTrial> trials;
  double least_of_speed = std::numeric_limits<double>::infinity();
  std::size_t tried = 0;
  for (TermCandidate& candidate : candidates) {
    ConsideredTerm& considered = candidate.considered;
    if (considered.added || candidate.is_given_up) continue;
    std::optional<CandidateModel> model = FitFrom(base, &candidate);
    if (!model) continue;
    ++tried;
    const double ratio = evidence.LikelihoodRatio(base.sum_of_squares, model->sum_of_squares);
    considered.gain = 1 - std::sqrt(std::min(model->sum_of_squares / base.sum_of_squares, 1.0));
    considered.p_value =
        ratio > 0 ? PValueOfChiSquared(ratio, static_cast<double>(candidate.size())) : 1.0;
    considered.is_predicted = false;
    if (considered.obstacle != "confounded") considered.obstacle = "";
    candidate.is_given_up =
        !result_.added.empty() && considered.gain < kHopelessGain * selection_.smallest_gain;
    if (candidate.is_of_speed()) least_of_speed = std::min(least_of_speed, model->sum_of_squares);
    const double delta =
        evidence.Aicc(model->sum_of_squares, CountFreeParameters(model->fit)) - before;
    const double rank = parts_.empty()
                            ? delta
                            : std::log(model->sum_of_squares) / 2 +
                                  selection_.smallest_gain * static_cast<double>(candidate.size());
    trials.push_back({&candidate, std::move(*model), delta, rank});
  }
  std::ranges::stable_sort(trials, {}, &TermTrial::rank);
  const double chance = selection_.chance / static_cast<double>(std::max<std::size_t>(tried, 1));
  // True if a candidate with only some of these terms explains nearly as much.
  const auto simpler_does = [&](const TermTrial& trial) {
    const double nearly = (1 + selection_.smallest_gain) * (1 + selection_.smallest_gain);
    return std::ranges::any_of(trials, [&](const TermTrial& other) {
      return other.candidate->terms.size() < trial.candidate->terms.size() &&
             other.candidate->covariate.empty() &&
             std::ranges::all_of(other.candidate->terms,
                                 [&](const std::string& term) {
                                   return std::ranges::find(trial.candidate->terms, term) !=
                                          trial.candidate->terms.end();
                                 }) &&
             other.model.sum_of_squares <= nearly * trial.model.sum_of_squares;
    });
  };
  std::size_t predicted = 0;
  for (TermTrial& trial : trials) {
    ConsideredTerm& considered = trial.candidate->considered;
    if (simpler_does(trial)) continue;
    if (parts_.empty() && !(trial.delta_aicc < 0)) continue;
    if (considered.gain < selection_.smallest_gain) continue;
    if (considered.obstacle == "confounded") continue;
    if (trial.candidate->is_lag() && trial.model.sum_of_squares > least_of_speed / 2) {
      considered.obstacle = "rate_dependent";
      continue;
    }
    if (IsUnphysical(trial.model.fit)) {
      considered.obstacle = "unphysical";
      continue;
    }
    if (predicted == kPredicted) break;
    ++predicted;
    if (!parts_.empty()) {
      if (!Predict(base) || !Predict(trial.model)) continue;
      Judge(base, trial.model, considered);
    }
    if (!(considered.p_value < chance) || considered.gain < selection_.smallest_gain) continue;
    if (!Accept(trial.model, judged)) {
      considered.obstacle = "confounded";
      continue;
    }
    considered.added = true;
    result_.added.push_back(considered.name);
    base = std::move(trial.model);
    return true;
  }
  return false;
}

/// True if a larger model keeps the slip force of the one that was judged, which it then replaces.
bool Selection::Accept(CandidateModel& model, FitResult& judged) {
  // Its minimum may be elsewhere.
  std::optional<CandidateModel> anew = FitAnew(model.options);
  if (anew && anew->sum_of_squares < model.sum_of_squares) model = std::move(*anew);
  Fitter fitter(ContinuedFrom(model.fit, model.options));
  const FitResult& now = fitter.Fit(records_, Depth::kIntervals);
  if (!IsFitted(now) || IsUnphysical(now)) return false;
  if (LosesSlipForce(judged, now, model.options.thresholds.widest_ratio)) return false;
  judged = now;
  return true;
}

void Selection::Run(const FitOptions& options) {
  Fitter first(options);
  result_.options = options;
  result_.fit = first.Fit(records_, Depth::kThorough);
  const bool is_described = result_.fit.adequacy.verdict == AdequacyVerdict::kAdequate;
  if (!IsFitted(result_.fit) || is_described || options.response() != loop::Channel::kForce) return;

  KeepToSamplesOfLag(options);
  CandidateModel base;
  base.options = options;
  base.fit = result_.fit;
  std::optional<CandidateModel> start = FitFrom(base, nullptr);
  if (!start) return;
  base = std::move(*start);
  samples_ = CountedSamples(base.fit, records_);
  base.sum_of_squares = SquaresOf(base.fit);
  DivideIntoParts(base.fit);

  std::vector<TermCandidate> candidates = ListTermCandidates(records_, options, result_.fit);
  FitResult judged = result_.fit;
  while (result_.added.size() < selection_.most_terms && Round(candidates, base, judged)) {
    if (judged.adequacy.verdict == AdequacyVerdict::kAdequate) break;
  }
  for (const TermCandidate& candidate : candidates)
    result_.considered.push_back(candidate.considered);
  std::ranges::stable_sort(result_.considered, std::greater(), &ConsideredTerm::gain);
  const auto place = [&](const ConsideredTerm& term) {
    return std::ranges::find(result_.added, term.name) - result_.added.begin();
  };
  std::ranges::stable_sort(result_.considered, {}, place);
  if (result_.added.empty()) return;
  result_.options = base.options;
  FitOptions from_here = base.options;
  for (const ParameterEstimate& parameter : base.fit.parameters) {
    if (parameter.status != ParameterStatus::kFixed) {
      from_here.start[parameter.name] = parameter.value;
    }
  }
  Fitter last(from_here);
  result_.fit = last.Fit(records_, Depth::kThorough);
}

}  // namespace

std::span<const TermGroup> TermGroups() {
  static const std::vector<TermGroup> groups = {
      {"viscous", {"viscous"}},
      {"speed_exponent", {"speed_exponent", "viscous"}},
      {"inertia", {"inertia"}},
      {"plateau_slope", {"plateau_slope"}},
      {"slip_speed", {"slip_speed", "slip_speed_exponent"}},
      {"slip_position", {"slip_slope", "plateau_slope"}},
      {"slip_position_quadratic",
       {"slip_slope", "slip_curvature", "plateau_slope", "plateau_curvature"}},
      {"ripple",
       {"ripple_period", "ripple_cosine_up", "ripple_sine_up", "ripple_cosine_down",
        "ripple_sine_down"}},
      {"force_drift", {"force_drift"}},
      {"rig_stiffness", {"rig_stiffness"}},
      {"asymmetry", {"asymmetry"}},
      {"lag", {"lag"}},
  };
  return groups;
}

const TermGroup* FindTermGroup(std::string_view name) {
  const std::span<const TermGroup> groups = TermGroups();
  const auto group = std::ranges::find(groups, name, &TermGroup::name);
  return group == groups.end() ? nullptr : &*group;
}

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
  Selection(records, selection, result).Run(options);
  return result;
}

}  // namespace mindahl::identification
