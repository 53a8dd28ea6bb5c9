#include "identification/diagnosis/adequacy.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"

namespace mindahl::identification {

bool LeavesHalfGap(const loop::LoopFacts& facts, double without, double with) {
  constexpr double kFarthest = 1.25;
  if (!loop::Slides(facts)) return false;
  const double ratio = with / *facts.half_gap;
  const double before = without / *facts.half_gap;
  const bool is_far = ratio > kFarthest || ratio < 1 / kFarthest;
  return is_far && !(std::abs(ratio - 1) < std::abs(before - 1));
}

double MissedForce(const FitResult& result) {
  const double explained = result.adequacy.misfit;
  // The rms includes the readings that a robust loss weighs down.
  const bool is_noise = result.adequacy.verdict == AdequacyVerdict::kAdequate;
  if (is_noise || result.outliers > 0) return explained;
  const double not_white = result.rms * result.rms - WhiteVariance(result);
  return std::max(explained, std::sqrt(std::max(0.0, not_white)));
}

bool AreUnlikeNoise(const FitResult& result, const Thresholds& thresholds) {
  const double least = thresholds.poor_misfit * result.MisfitScale();
  if (result.outliers > 0 || !(least > 0) || !(result.residuals.rms > least)) return false;
  for (const RecordFit& record : result.records) {
    if (record.structure.carried_over > thresholds.carried_over) return true;
  }
  // The residuals correlate by 1 − DW/2 from one sample to the next, and so decay at this rate.
  const double correlation = 1 - result.residuals.durbin_watson / 2;
  const double forgotten = -std::log(correlation);
  if (!std::isfinite(forgotten)) return false;
  const RecordFit& widest = result.WidestRecord();
  const auto samples = static_cast<double>(widest.residual.size());
  const auto strokes = static_cast<double>(widest.reversals.size() + 1);
  return strokes > thresholds.noise_memory * std::max(1.0, forgotten * samples);
}

void JudgeAdequacy(bool is_limited, const Thresholds& thresholds, FitResult& result) {
  Adequacy& adequacy = result.adequacy;
  // Noise whatever the model: where strokes of both directions come back what does not repeat with
  // them, else what differs between neighbouring samples.
  double share = 1.0;
  bool comes_back = false;
  for (const RecordFit& record : result.records) {
    share = std::min(share, record.structure.noise_share);
    comes_back = comes_back || std::ranges::min(record.structure.strokes) > 1;
  }
  const double noise = comes_back ? share * result.rms * result.rms : WhiteVariance(result);
  const double square = result.rms * result.rms;
  // The rms includes the readings that a robust loss weighs down.
  const bool exceeds_noise =
      result.outliers == 0 && square > thresholds.larger_rms * thresholds.larger_rms * noise;
  if (exceeds_noise) {
    adequacy.p_value = std::min(adequacy.p_value, thresholds.rare_chance);
    const double excess = noise > 0 ? std::sqrt(square / noise - 1) : 0.0;
    adequacy.misfit_over_noise = std::max(adequacy.misfit_over_noise, excess);
  }
  const bool is_doubtful = adequacy.p_value < thresholds.doubt || is_limited || exceeds_noise ||
                           AreUnlikeNoise(result, thresholds);
  adequacy.verdict = is_doubtful ? AdequacyVerdict::kDoubtful : AdequacyVerdict::kAdequate;
}

bool MayOmitTerms(const Adequacy& adequacy, const Thresholds& thresholds) {
  return adequacy.verdict != AdequacyVerdict::kAdequate ||
         adequacy.p_value < thresholds.omission_chance;
}

void GradeUse(const Thresholds& thresholds, FitResult& result) {
  Adequacy& adequacy = result.adequacy;
  adequacy.misfit = MissedForce(result);
  const std::optional<double> half_gap = result.MeasuredHalfGap();
  if (half_gap) adequacy.misfit_over_half_gap = adequacy.misfit / *half_gap;
  const double scale = half_gap.value_or(result.MisfitScale());
  const double ratio = adequacy.misfit / scale;
  adequacy.use = Use::kNone;
  if (!IsLoopSeen(result, thresholds) || !(scale > 0)) return;
  if (ratio <= thresholds.failing_misfit) adequacy.use = Use::kIndicative;
  if (ratio <= thresholds.quantitative_misfit) adequacy.use = Use::kQuantitative;
}

bool IsLoopSeen(const FitResult& result, const Thresholds& thresholds) {
  // If a robust loss reduced the weight of readings, the variance is mostly theirs.
  return result.outliers > 0 || result.residuals.r_squared >= thresholds.seen_loop;
}

void WithdrawIfInadequate(const Thresholds& thresholds, FitResult& result) {
  Adequacy& adequacy = result.adequacy;
  const bool is_loop = IsLoopSeen(result, thresholds);
  const bool fails = adequacy.verdict == AdequacyVerdict::kDoubtful &&
                     adequacy.misfit > thresholds.failing_misfit * result.MisfitScale();
  if (is_loop && !fails) return;
  adequacy.verdict = AdequacyVerdict::kInadequate;
  Finding finding{.code = "model_inadequate"};
  if (!is_loop) {
    finding.numbers = {{"r_squared", result.residuals.r_squared}};
    finding.kind = "no_loop";
    adequacy.causes.clear();  // to first order about a curve that is not the record's
  }
  // Another account of a curve that is not there goes too, even if it is only a note.
  std::erase_if(result.findings, [](const Finding& other) {
    return other.code == "shape_or_rig" ||
           (!other.parameters.empty() && !other.code.row().holds_without_model);
  });
  for (ParameterEstimate& estimate : result.parameters) {
    // The interval of Tc holds what is measured, whatever the use.
    const bool covers = is_loop && estimate.includes_discrepancy &&
                        (adequacy.use != Use::kNone || estimate.name == "slip_force");
    if (estimate.status == ParameterStatus::kFixed || covers) continue;
    SetInterval(estimate, {});
    finding.parameters.push_back(estimate.name);
  }
  result.findings.insert(result.findings.begin(), std::move(finding));
}

void Judge(std::span<ParameterEstimate> estimates, std::span<const Finding> findings) {
  for (ParameterEstimate& estimate : estimates) {
    Identifiability& verdict = estimate.identifiability;
    verdict = estimate.includes_discrepancy ? Identifiability::kEffective
                                            : Identifiability::kIdentifiable;
    if (estimate.status == ParameterStatus::kFixed) continue;
    if (!estimate.upper95) verdict = Identifiability::kBoundedBelow;
    if (!estimate.lower95) verdict = Identifiability::kNotIdentifiable;
    for (const Finding& finding : findings) {
      const bool is_named = std::ranges::count(finding.parameters, estimate.name) > 0;
      if (is_named) verdict = std::max(verdict, finding.code.row().verdict);
    }
  }
}

}  // namespace mindahl::identification
