#include "mindahl/identification/model_comparison.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/held_out.h"
#include "identification/inference/noise.h"
#include "identification/problem/parameters.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {

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

double Rms(const FitResult& fit, const ScoredSamples& samples) {
  double sum = 0.0;
  for (std::size_t r = 0; r < samples.mask.size(); ++r) sum += SquaresOf(fit, samples, r).sum;
  return std::sqrt(sum / static_cast<double>(samples.count));
}

/// Scores the candidates by the criterion.
/// @returns the position of the fit with the least rms
std::size_t ScoreByCriterion(std::span<const FitResult> fits, const ScoredSamples& samples,
                             std::vector<ModelScore>& scores) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  std::vector<double> rms;
  rms.reserve(fits.size());
  for (const FitResult& fit : fits) {
    rms.push_back(IsFitted(fit) ? LikelihoodRms(fit, samples) : kNone);
  }
  const auto best = static_cast<std::size_t>(std::ranges::min_element(rms) - rms.begin());
  const Evidence evidence(samples.count, std::min(fits[best].residuals.effective_samples,
                                                  static_cast<double>(samples.count)));
  double least = kNone;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    ModelScore& score = scores[i];
    score.rms = score.aicc = kNone;
    if (!IsFitted(fits[i])) continue;
    score.rms = Rms(fits[i], samples);
    score.aicc = evidence.Aicc(SumOfSquares(rms[i], samples), score.free_parameters);
    if (score.converged) least = std::min(least, score.aicc);
  }
  for (ModelScore& score : scores) {
    score.delta_aicc = std::isfinite(least) ? score.aicc - least : score.aicc;
  }
  return best;
}

}  // namespace

std::vector<ModelScore> CompareModels(std::span<const loop::Record> given,
                                      const FitOptions& options) {
  const std::vector<loop::RecordView> records(given.begin(), given.end());
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
  const auto fitted = std::ranges::find_if(fits, IsFitted);
  if (fitted == fits.end()) return scores;
  const ScoredSamples samples = CountedSamples(*fitted, records);
  const std::size_t best = ScoreByCriterion(fits, samples, scores);
  const std::vector<Part> cycles = CyclesOf(fits[best], samples.mask);
  const std::size_t folds = std::min(kFolds, cycles.size());
  for (std::size_t i = 0; i < fits.size() && !cycles.empty(); ++i) {
    ModelScore& score = scores[i];
    if (!score.converged) continue;
    const std::optional<double> mean_square =
        PredictParts(records, ContinuedFrom(fits[i], OptionsOf(score, options)),
                     score.free_parameters, samples, cycles, folds);
    if (mean_square) score.held_out_rms = std::sqrt(*mean_square);
  }
  return scores;
}

}  // namespace mindahl::identification
