#include "mindahl/identification/model_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/continued_fit.h"
#include "identification/inference/noise.h"
#include "identification/problem/parameters.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {

using loop::RecordView;

namespace {

constexpr std::size_t kFolds = 5;

std::vector<ModelScore> ListCandidates(const FitOptions& options) {
  const auto alpha = options.fixed.find("alpha");
  const bool rig_is_known = options.fixed.contains("rig_stiffness");
  std::vector<ModelScore> scores;
  for (const models::FrictionModel& model : models::FrictionModels()) {
    if (model.shape_exponent && alpha != options.fixed.end() &&
        *model.shape_exponent != alpha->second) {
      continue;
    }
    scores.push_back({.model = &model});
    const bool may_have_rig = !rig_is_known && (model.memory != models::Memory::kNone ||
                                                !HasTerm(options, TermId::kAsymmetry));
    if (may_have_rig) scores.push_back({.model = &model, .rig = true});
  }
  return scores;
}

FitOptions OptionsOf(const ModelScore& score, FitOptions options) {
  options.model = score.model;
  if (score.rig) options.terms.emplace_back("rig_stiffness");
  return options;
}

/// Scores the candidates by the criterion.
/// @returns the fit with the least rms
const FitResult& ScoreByCriterion(std::span<const FitResult> fits,
                                  std::vector<ModelScore>& scores) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const FitResult& best = *std::ranges::min_element(
      fits, {}, [](const FitResult& fit) { return IsFitted(fit) ? fit.likelihood_rms : kNone; });
  const auto samples = static_cast<double>(best.residuals.samples);
  const Evidence evidence(best.residuals.samples,
                          std::min(best.residuals.effective_samples, samples));
  double least = kNone;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    ModelScore& score = scores[i];
    score.rms = score.aicc = kNone;
    if (!IsFitted(fits[i])) continue;
    // Over the largest force: the criterion's floor is the rounding of forces of about one.
    const double rms = fits[i].likelihood_rms / best.PeakForce();
    score.rms = fits[i].rms;
    score.aicc = evidence.Aicc(samples * rms * rms, score.free_parameters);
    if (score.converged) least = std::min(least, score.aicc);
  }
  for (ModelScore& score : scores) {
    score.delta_aicc = std::isfinite(least) ? score.aicc - least : score.aicc;
  }
  return best;
}

/// Returns the closed cycles, from one reversal to the next but one, of which samples count. A
/// single one of a record is none: without it nothing of the kind would be left to fit.
std::vector<SampleRange> CyclesOf(const FitResult& fit) {
  std::vector<SampleRange> cycles;
  for (std::size_t r = 0; r < fit.records.size(); ++r) {
    const std::vector<std::size_t>& reversals = fit.records[r].reversals;
    std::vector<SampleRange> closed;
    for (std::size_t j = 0; j + 2 < reversals.size(); j += 2) {
      const auto own =
          std::span(fit.records[r].counts).subspan(reversals[j], reversals[j + 2] - reversals[j]);
      if (std::ranges::count(own, 0) == std::ssize(own)) continue;
      closed.push_back({r, reversals[j], reversals[j + 2]});
    }
    if (closed.size() > 1) cycles.insert(cycles.end(), closed.begin(), closed.end());
  }
  return cycles;
}

/// Returns options under which the fit is found again from where it is.
FitOptions ContinuedFrom(const FitResult& fit, FitOptions options) {
  HoldInitialStates(fit, options);
  options.preparation.force_sense = fit.force_sense;
  for (const ParameterEstimate& parameter : fit.parameters) {
    if (parameter.status == ParameterStatus::kFixed) continue;
    // One that ran to a bound stays there.
    (parameter.status == ParameterStatus::kFree ? options.start : options.fixed)[parameter.name] =
        parameter.value;
  }
  return options;
}

/// Returns the root mean square error [N] of the prediction of cycles by fits to the others, dealt
/// in turn to the folds so that slow changes of the contact are in every one; empty where a fit
/// failed or refused its options. Samples held out still make history.
/// @param options  of these fits; what they hold out stays so
/// @param counted  fit to all, whose samples that count are predicted
std::optional<double> PredictCycles(std::span<const RecordView> records, const FitOptions& options,
                                    const FitResult& counted, std::span<const SampleRange> cycles) {
  const std::size_t folds = std::min(kFolds, cycles.size());
  double squares = 0.0;
  double predicted = 0.0;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    std::vector<SampleRange> held_out;
    for (std::size_t c = fold; c < cycles.size(); c += folds) held_out.push_back(cycles[c]);
    const std::optional<FitResult> fit = FitWithout(held_out, records, options);
    if (!fit) return std::nullopt;
    for (const auto& [record, begin, end] : held_out) {
      for (std::size_t i = begin; i < end; ++i) {
        if (counted.records[record].counts[i] == 0) continue;
        squares += fit->records[record].residual[i] * fit->records[record].residual[i];
        ++predicted;
      }
    }
  }
  return std::sqrt(squares / predicted);
}

}  // namespace

std::vector<ModelScore> CompareModels(std::span<const loop::Record> given,
                                      const FitOptions& options) {
  const std::vector<RecordView> records(given.begin(), given.end());
  if (options.response() != loop::Channel::kForce) {
    throw InvalidArgument("models are compared by fits of the force: name one for a displacement");
  }
  std::vector<ModelScore> scores = ListCandidates(options);
  std::vector<FitResult> fits;
  fits.reserve(scores.size());
  for (ModelScore& score : scores) {
    const FitResult& fit =
        fits.emplace_back(Fitter(OptionsOf(score, options)).Fit(records, Depth::kIntervals));
    score.converged = fit.converged;
    score.free_parameters = fit.CountFreeParameters();
  }
  if (std::ranges::none_of(fits, IsFitted)) return scores;
  const FitResult& best = ScoreByCriterion(fits, scores);
  const std::vector<SampleRange> cycles = CyclesOf(best);
  for (std::size_t i = 0; i < fits.size() && !cycles.empty(); ++i) {
    if (!scores[i].converged) continue;
    const FitOptions from_here = ContinuedFrom(fits[i], OptionsOf(scores[i], options));
    scores[i].held_out_rms = PredictCycles(records, from_here, best, cycles);
  }
  return scores;
}

}  // namespace mindahl::identification
