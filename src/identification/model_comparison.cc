#include "mindahl/identification/model_comparison.h"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

#include "identification/continued_fit.h"
#include "identification/inference/noise.h"
#include "identification/problem/parameters.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {

namespace {

constexpr std::size_t kFolds = 5;

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

/// Returns the rms error [N] of the prediction of cycles by fits to the others, dealt in turn to
/// the folds so that slow changes of the contact are in every one; empty where a fit failed.
/// @param options  of these fits; what they hold out stays so
/// @param counted  fit to all, whose samples that count are predicted
std::optional<double> PredictCycles(std::span<const loop::RecordView> records,
                                    const FitOptions& options, const FitResult& counted,
                                    std::span<const SampleRange> cycles) {
  const std::size_t folds = std::min(kFolds, cycles.size());
  double squares = 0.0;
  double predicted = 0.0;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    std::vector<SampleRange> held_out;
    for (std::size_t c = fold; c < cycles.size(); c += folds) held_out.push_back(cycles[c]);
    const FitResult fit = FitWithout(held_out, records, options);
    if (!fit.converged) return std::nullopt;
    for (const auto& [record, begin, end] : held_out) {
      for (std::size_t i = begin; i < end; ++i) {
        if (counted.records[record].counts[i] == 0) continue;
        squares += fit.records[record].residual[i] * fit.records[record].residual[i];
        ++predicted;
      }
    }
  }
  return std::sqrt(squares / predicted);
}

}  // namespace

std::vector<ModelScore> CompareModels(std::span<const loop::Record> given,
                                      const FitOptions& options) {
  const std::vector<loop::RecordView> records(given.begin(), given.end());
  if (options.response() != loop::Channel::kForce) {
    throw InvalidArgument("models are compared by fits of the force: name one for a displacement");
  }
  const auto alpha = options.fixed.find("alpha");
  const bool holds_alpha = alpha != options.fixed.end();
  std::vector<std::pair<FitOptions, FitResult>> compared;
  for (const models::FrictionModel& model : models::FrictionModels()) {
    if (holds_alpha && model.shape_exponent.value_or(alpha->second) != alpha->second) continue;
    for (const bool rig : {false, true}) {
      const bool may_have_rig =
          !options.fixed.contains("rig_stiffness") &&
          (model.memory != models::Memory::kNone || !HasTerm(options, TermId::kAsymmetry));
      if (rig && !may_have_rig) continue;
      FitOptions own = options;
      own.model = &model;
      if (rig) own.terms.emplace_back("rig_stiffness");
      FitResult fit = Fitter(own).Fit(records, Depth::kIntervals);
      if (fit.converged) compared.emplace_back(std::move(own), std::move(fit));
    }
  }
  if (compared.empty()) return {};
  const FitResult& best =
      *std::ranges::min_element(compared | std::views::values, {}, &FitResult::likelihood_rms);
  const auto samples = static_cast<double>(best.residuals.samples);
  const Evidence evidence{best.residuals.samples, best.residuals.effective_samples};
  const std::vector<SampleRange> cycles = CyclesOf(best);
  std::vector<ModelScore> scores;
  for (auto& [own, fit] : compared) {
    // Over the largest force: the criterion's floor is the rounding of forces of about one.
    const double rms = fit.likelihood_rms / best.PeakForce();
    ModelScore& score = scores.emplace_back(ModelScore{
        .model = own.model,
        .rig = HasTerm(own, TermId::kRigStiffness) && !HasTerm(options, TermId::kRigStiffness),
        .free_parameters = fit.CountFreeParameters(),
        .rms = fit.rms,
        .delta_aicc = evidence.Aicc(samples * rms * rms, fit.CountFreeParameters())});
    if (cycles.empty()) continue;
    // Without a rig, which comes first, the model is the same as with a rigid one.
    const ParameterEstimate* const stiffness = score.rig ? fit.Find("rig_stiffness") : nullptr;
    const auto last = scores.rbegin() + 1;
    if (stiffness != nullptr && stiffness->status == ParameterStatus::kAtUpperBound &&
        last != scores.rend() && last->model == own.model) {
      score.held_out_rms = last->held_out_rms;
      continue;
    }
    own.initial_state = fit.initial_state;
    own.preparation.force_sense = fit.force_sense;
    StartFrom(fit, own);
    score.held_out_rms = PredictCycles(records, own, best, cycles);
  }
  const double least = std::ranges::min(scores, {}, &ModelScore::delta_aicc).delta_aicc;
  for (ModelScore& score : scores) score.delta_aicc -= least;
  return scores;
}

}  // namespace mindahl::identification
