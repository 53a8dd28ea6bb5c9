#include "mindahl/identification/model_selection.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string_view>
#include <tuple>
#include <utility>

#include "identification/held_out.h"
#include "identification/inference/noise.h"
#include "identification/inference/reweighting.h"
#include "identification/intervals.h"
#include "identification/problem/parameters.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"

namespace mindahl::identification {

using loop::RecordView;

namespace {

std::string Label(const ModelScore& score) {
  return fmt::format("{}{}", score.model->name, score.rig ? " with a rig" : "");
}

std::vector<ModelScore> ListCandidates(const FitOptions& options) {
  const auto alpha = options.fixed.find("alpha");
  const bool rig_is_known = options.fixed.contains("rig_stiffness");
  std::vector<ModelScore> scores;
  for (const models::FrictionModel& model : models::FrictionModels()) {
    if (model.scaled_by_peak) continue;
    if (model.shape_exponent && alpha != options.fixed.end() &&
        *model.shape_exponent != alpha->second) {
      continue;
    }
    for (const bool rig : {false, true}) {
      if (rig && rig_is_known) continue;
      if (rig && model.memory == models::Memory::kNone && HasTerm(options, TermId::kAsymmetry))
        continue;
      ModelScore& score = scores.emplace_back();
      score.model = &model;
      score.rig = rig;
    }
  }
  return scores;
}

FitOptions OptionsOf(const ModelScore& score, FitOptions options) {
  options.model = score.model;
  if (score.rig) options.terms.emplace_back("rig_stiffness");
  return options;
}

/// The residuals [N] that are scored, one series a record.
std::vector<std::vector<double>> ScoredResiduals(const FitResult& fit, const SampleMask& mask) {
  std::vector<std::vector<double>> residuals;
  for (std::size_t r = 0; r < mask.size(); ++r) {
    std::vector<double>& series = residuals.emplace_back();
    for (std::size_t i = 0; i < mask[r].size(); ++i) {
      if (mask[r][i] != 0) series.push_back(fit.records[r].residual[i]);
    }
  }
  return residuals;
}

double Rms(const FitResult& fit, const SampleMask& mask) {
  double sum = 0.0;
  double count = 0.0;
  for (const std::vector<double>& series : ScoredResiduals(fit, mask)) {
    for (const double residual : series) sum += residual * residual;
    count += static_cast<double>(series.size());
  }
  return std::sqrt(sum / count);
}

/// The rms by which fits are compared: of records whose noise differs the mean of the logarithms
/// over the samples, so that each counts by its own noise.
double LikelihoodRms(const FitResult& fit, const SampleMask& mask) {
  double logarithms = 0.0;
  double count = 0.0;
  for (const std::vector<double>& series : ScoredResiduals(fit, mask)) {
    if (series.empty()) continue;
    double sum = 0.0;
    for (const double residual : series) sum += residual * residual;
    const auto samples = static_cast<double>(series.size());
    logarithms += samples * std::log(sum / samples) / 2;
    count += samples;
  }
  return std::exp(logarithms / count);
}

double ScoredRobustScale(const FitResult& fit, const SampleMask& mask) {
  std::vector<double> residuals;
  for (const std::vector<double>& series : ScoredResiduals(fit, mask)) {
    residuals.insert(residuals.end(), series.begin(), series.end());
  }
  return identification::RobustScale(std::move(residuals));
}

/// The fit that a measure of its residuals is least for.
template <typename Measure>
const FitResult& Best(std::span<const FitResult> fits, Measure measure) {
  return *std::ranges::min_element(fits, {}, [&](const FitResult& fit) {
    return IsFitted(fit) ? measure(fit) : std::numeric_limits<double>::infinity();
  });
}

void LeaveOutOutliers(ScoredSamples& samples, std::span<const FitResult> fits) {
  constexpr double kOutlier = 4.685;  // where Tukey's loss ends
  const FitResult& best =
      Best(fits, [&](const FitResult& fit) { return ScoredRobustScale(fit, samples.mask); });
  const double limit = kOutlier * std::max(ScoredRobustScale(best, samples.mask), samples.rounding);
  for (std::size_t r = 0; r < samples.mask.size(); ++r) {
    for (std::size_t i = 0; i < samples.mask[r].size(); ++i) {
      if (samples.mask[r][i] == 0 || std::abs(best.records[r].residual[i]) <= limit) continue;
      samples.mask[r][i] = 0;
      --samples.count;
    }
  }
}

void WeighCandidates(std::vector<ModelScore>& scores) {
  double least = std::numeric_limits<double>::infinity();
  for (const ModelScore& score : scores) {
    if (score.converged) least = std::min(least, score.aicc);
  }
  double sum = 0.0;
  for (ModelScore& score : scores) {
    score.delta_aicc = std::isfinite(least) ? score.aicc - least : score.aicc;
    score.akaike_weight = score.converged ? std::exp(-score.delta_aicc / 2) : 0.0;
    sum += score.akaike_weight;
  }
  for (ModelScore& score : scores) {
    if (sum > 0) score.akaike_weight /= sum;
  }
}

void AddRemark(ModelScore& score, std::string_view remark) {
  if (!score.remark.empty()) score.remark += "; ";
  score.remark += remark;
}

double CorrelationOf(const FitResult& fit, std::string_view first, std::string_view second) {
  const ParameterEstimate* one = fit.Find(first);
  const ParameterEstimate* other = fit.Find(second);
  if (one == nullptr || other == nullptr) return 0.0;
  const auto row = static_cast<std::size_t>(one - fit.parameters.data());
  const auto column = static_cast<std::size_t>(other - fit.parameters.data());
  return fit.correlation[row * fit.parameters.size() + column];
}

/// Adds the comments that follow from the fit alone.
void RemarkOnFit(ModelScore& score, const FitResult& fit, const Thresholds& thresholds) {
  if (!fit.converged) AddRemark(score, "not converged: " + fit.solver.message);
  for (const ParameterEstimate& estimate : fit.parameters) {
    if (estimate.status != ParameterStatus::kAtLowerBound &&
        estimate.status != ParameterStatus::kAtUpperBound) {
      continue;
    }
    score.at_bound = true;
    AddRemark(score, estimate.name + " at its bound");
  }
  if (std::abs(CorrelationOf(fit, "alpha", "rig_stiffness")) > thresholds.known_together) {
    AddRemark(score, "alpha and rig_stiffness are known only together");
  }
}

/// Marks candidates that are simpler ones in disguise.
/// @param squares  by which they are compared, one a candidate
void FindRedundant(std::vector<ModelScore>& scores, std::span<const FitResult> fits,
                   const Evidence& evidence, std::span<const double> squares,
                   const Thresholds& thresholds) {
  const auto gains_nothing_on = [&](const ModelScore& score, std::string_view model, bool rig) {
    const auto simpler = std::ranges::find_if(scores, [&](const ModelScore& other) {
      return other.model->name == model && other.rig == rig && other.converged;
    });
    return simpler != scores.end() &&
           evidence.LikelihoodRatio(squares[static_cast<std::size_t>(simpler - scores.begin())],
                                    squares[static_cast<std::size_t>(&score - scores.data())]) <
               thresholds.redundant_gain;
  };
  for (std::size_t i = 0; i < scores.size(); ++i) {
    ModelScore& score = scores[i];
    if (!score.converged) continue;
    if (score.rig && gains_nothing_on(score, score.model->name, false)) {
      score.redundant = true;
      AddRemark(score, "rig not needed: the fit is the same without it");
    }
    if (score.at_bound && !score.model->shape_exponent &&
        fits[i].law.shape_exponent < thresholds.jenkins_shape &&
        gains_nothing_on(score, "jenkins", score.rig)) {
      score.redundant = true;
      AddRemark(score, "the same as jenkins");
    }
  }
}

/// The converged ones, the best first; without those that may not be chosen, unless nothing else is
/// left.
std::vector<std::size_t> Rank(std::span<const ModelScore> scores) {
  std::vector<std::size_t> ranking(scores.size());
  std::iota(ranking.begin(), ranking.end(), std::size_t{0});
  std::erase_if(ranking, [&](std::size_t i) { return !scores[i].converged; });
  std::ranges::sort(ranking, {}, [&](std::size_t i) { return scores[i].aicc; });
  std::vector<std::size_t> eligible = ranking;
  std::erase_if(eligible, [&](std::size_t i) { return scores[i].redundant || scores[i].at_bound; });
  return eligible.empty() ? ranking : eligible;
}

std::string VerdictOn(const ModelSelection& selection, const Thresholds& thresholds,
                      std::span<const std::size_t> ranking) {
  const std::vector<ModelScore>& scores = selection.scores;
  const ModelScore& chosen = scores[selection.chosen];
  if (ranking.empty()) {
    return fmt::format("No model converged; {} fits best.", Label(chosen));
  }
  std::string verdict;
  if (selection.indistinguishable.size() > 1) {
    std::vector<std::string> names;
    names.reserve(selection.indistinguishable.size());
    for (const std::size_t i : selection.indistinguishable) names.push_back(Label(scores[i]));
    verdict = fmt::format(
        "The records do not distinguish {}: ΔAICc below {:g}{}. The simplest, {}, is reported.",
        fmt::join(names, ", "), thresholds.indistinguishable,
        selection.held_out_cycles > 0
            ? fmt::format(", and {} cycles held out are predicted equally well within a standard "
                          "error",
                          selection.held_out_cycles)
            : "",
        Label(chosen));
    const auto has_rig = [&](std::size_t i) { return scores[i].rig; };
    if (std::ranges::any_of(selection.indistinguishable, has_rig) &&
        !std::ranges::all_of(selection.indistinguishable, has_rig)) {
      verdict += " Whether the rig is compliant is open: measure its stiffness and fix it.";
    }
  } else {
    verdict = fmt::format("{} is the best", Label(chosen));
    const auto next =
        std::ranges::find_if(ranking, [&](std::size_t i) { return i != selection.chosen; });
    if (next != ranking.end()) {
      verdict += fmt::format(", by ΔAICc = {:.3g} before {}", scores[*next].aicc - chosen.aicc,
                             Label(scores[*next]));
      if (scores[*next].aicc - chosen.aicc < thresholds.indistinguishable) {
        verdict += ", which predicts cycles held out worse by more than a standard error";
      }
    }
    verdict += ".";
  }
  for (const ModelScore& score : scores) {
    if (!score.converged || !score.at_bound || score.redundant) continue;
    if (chosen.aicc - score.aicc < thresholds.indistinguishable) continue;
    verdict += fmt::format(
        " {} fits better by ΔAICc = {:.3g}, but with a parameter at its bound: none of the models "
        "has the shape of the loop.",
        Label(score), chosen.aicc - score.aicc);
    break;
  }
  if (selection.held_out_cycles == 0) {
    verdict += " Fewer than two closed cycles: nothing was held out, AICc alone decides.";
  }
  return verdict;
}

}  // namespace

ModelSelection SelectModel(std::span<const loop::Record> records, const FitOptions& options,
                           const SelectionOptions& selection) {
  const std::vector<RecordView> views(records.begin(), records.end());
  return SelectModel(views, options, selection);
}

ModelSelection SelectModel(std::span<const RecordView> records, const FitOptions& options,
                           const SelectionOptions& selection) {
  if (selection.folds < 2) {
    ThrowInvalid("folds [-]", static_cast<double>(selection.folds), "must be >= 2");
  }
  RequireNonNegative("largest ΔAICc [-]", options.thresholds.indistinguishable);
  if (options.response() != loop::Channel::kForce) {
    throw InvalidArgument("models are chosen by fits of the force: name one for a displacement");
  }

  ModelSelection result;
  result.scores = ListCandidates(options);
  std::vector<FitResult> fits;
  for (ModelScore& score : result.scores) {
    Fitter fitter(OptionsOf(score, options));
    const FitResult& fit = fits.emplace_back(fitter.Fit(records, Depth::kIntervals));
    score.converged = fit.converged;
    score.free_parameters = CountFreeParameters(fit);
    score.rms = score.aicc = std::numeric_limits<double>::infinity();
    RemarkOnFit(score, fit, options.thresholds);
  }
  if (std::ranges::none_of(fits, IsFitted)) {
    result.fit = std::move(fits.front());
    result.verdict = VerdictOn(result, options.thresholds, {});
    return result;
  }

  ScoredSamples samples = CountedSamples(fits.front(), records);
  if (options.loss != Loss::kNone) LeaveOutOutliers(samples, fits);
  const FitResult& best_fit =
      Best(fits, [&](const FitResult& fit) { return LikelihoodRms(fit, samples.mask); });
  result.effective_samples =
      std::min(best_fit.residuals.effective_samples, static_cast<double>(samples.count));
  const Evidence evidence(samples.count, result.effective_samples);
  std::vector<double> squares(fits.size(), std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < fits.size(); ++i) {
    ModelScore& score = result.scores[i];
    if (!IsFitted(fits[i])) continue;
    score.rms = Rms(fits[i], samples.mask);
    squares[i] = SumOfSquares(LikelihoodRms(fits[i], samples.mask), samples);
    score.aicc = evidence.Aicc(squares[i], score.free_parameters);
  }
  WeighCandidates(result.scores);
  FindRedundant(result.scores, fits, evidence, squares, options.thresholds);

  const std::vector<Part> cycles =
      PartsOf(best_fit, samples.mask, options.preparation.skip_cycles, 2, 2);
  result.held_out_cycles = cycles.size();
  result.folds = std::min(selection.folds, cycles.size());
  std::vector<std::vector<double>> predictions(fits.size());
  for (std::size_t i = 0; i < fits.size() && !cycles.empty(); ++i) {
    ModelScore& score = result.scores[i];
    if (!score.converged || score.redundant) continue;  // those predict as the simpler one does
    predictions[i] = PredictParts(records, ContinuedFrom(fits[i], OptionsOf(score, options)),
                                  score.free_parameters, samples, cycles, result.folds);
    if (predictions[i].empty()) {
      AddRemark(score, "no fit without some of the cycles");
      continue;
    }
    const MeanOverParts mean_square = Mean(predictions[i], cycles, result.folds);
    score.held_out_rms = std::sqrt(mean_square.mean);
    // d√m = dm/(2√m)
    score.held_out_standard_error =
        mean_square.mean > 0 ? mean_square.standard_error / (2 * *score.held_out_rms) : 0.0;
  }

  const std::vector<std::size_t> ranking = Rank(result.scores);
  if (ranking.empty()) {
    result.chosen = static_cast<std::size_t>(
        std::ranges::min_element(result.scores, {}, &ModelScore::rms) - result.scores.begin());
    result.indistinguishable = {result.chosen};
  } else {
    const std::size_t best = ranking.front();
    for (const std::size_t i : ranking) {
      const bool close =
          result.scores[i].aicc - result.scores[best].aicc < options.thresholds.indistinguishable;
      if (i == best || (close && !PredictsWorse(predictions[i], predictions[best], cycles,
                                                result.folds, samples.rounding))) {
        result.indistinguishable.push_back(i);
      }
    }
    std::ranges::sort(result.indistinguishable, {}, [&](std::size_t i) {
      const ModelScore& score = result.scores[i];
      return std::tuple(score.free_parameters, score.rig, score.aicc);
    });
    result.chosen = result.indistinguishable.front();
  }
  Fitter chosen(OptionsOf(result.scores[result.chosen], options));
  result.fit = chosen.Fit(records, Depth::kFull);
  result.verdict = VerdictOn(result, options.thresholds, ranking);
  return result;
}

}  // namespace mindahl::identification
