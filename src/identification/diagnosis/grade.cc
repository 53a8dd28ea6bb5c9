#include "identification/diagnosis/grade.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/diagnosis/diagnosis.h"
#include "identification/intervals.h"

namespace mindahl::identification {

double WhiteVariance(const FitResult& result) {
  constexpr double kOfWhiteNoise = 1.5;  // mean square of (r₋₁ + r₊₁)/2 − r₀ over its variance
  double squares = 0.0;
  double count = 0.0;
  for (const RecordFit& record : result.records) {
    for (std::size_t i = 1; i + 1 < record.residual.size(); ++i) {
      if (record.counts[i - 1] == 0 || record.counts[i] == 0 || record.counts[i + 1] == 0) continue;
      const double off = (record.residual[i - 1] + record.residual[i + 1]) / 2 - record.residual[i];
      squares += off * off;
      ++count;
    }
  }
  return count > 0 ? squares / (kOfWhiteNoise * count) : 0.0;
}

bool RanAway(double slip_force, double half_gap) {
  constexpr double kFarthest = 1.25;
  const double ratio = slip_force / std::abs(half_gap);
  return !(ratio <= kFarthest && ratio >= 1 / kFarthest);
}

bool LeavesHalfGap(const loop::LoopFacts& facts, double without, double with) {
  if (!loop::Slides(facts) || !RanAway(with, *facts.half_gap)) return false;
  const auto distance = [&](double slip_force) {
    return std::abs(slip_force / *facts.half_gap - 1);
  };
  return !(distance(with) < distance(without));
}

std::optional<FitOptions> WithinMeasuredForce(const loop::LoopFacts& facts, double load_ratio,
                                              double slip_force, const FitOptions& options) {
  constexpr const char* kName = "slip_force";
  const double peak_force = facts.peak_force / load_ratio;
  if (options.bounds.contains(kName) || options.fixed.contains(kName) || !loop::Slides(facts) ||
      peak_force >= options.thresholds.mobilised_by_asymptote * slip_force) {
    return std::nullopt;
  }
  FitOptions within = options;
  within.bounds[kName] = {0.0, peak_force};
  return within;
}

std::optional<double> MeasuredHalfGap(const FitResult& result) {
  const RecordFit& widest = result.WidestRecord();
  const bool is_of_force = result.response == loop::Channel::kForce;
  if (IsScaledByLoad(result)) return std::nullopt;
  if (!is_of_force || !widest.facts.half_gap || !(*widest.facts.half_gap > 0)) return std::nullopt;
  return *widest.facts.half_gap / widest.load_ratio;
}

double ScaleOfMisfit(const FitResult& result) {
  const RecordFit& widest = result.WidestRecord();
  if (result.response == loop::Channel::kDisplacement) return widest.measures.amplitude;
  const std::optional<double> half_gap = MeasuredHalfGap(result);
  const bool slips = loop::Slides(widest.facts) || loop::ReachesSlip(widest.facts);
  if (half_gap && slips) return *half_gap;
  return result.PeakForce();
}

double MissedForce(const FitResult& result) {
  const double explained = result.adequacy.misfit;
  // The rms includes the readings that a robust loss weighs down.
  const bool is_noise = result.adequacy.verdict == AdequacyVerdict::kAdequate;
  if (is_noise || result.outliers > 0) return explained;
  const double not_white = result.rms * result.rms - WhiteVariance(result);
  return std::max(explained, std::sqrt(std::max(0.0, not_white)));
}

namespace {

/// Returns the variance [N² or m²] of the residuals that is noise whatever the model: where strokes
/// of both directions come back, of what does not repeat with them; else what differs between
/// neighbouring samples.
double NoiseVariance(const FitResult& result) {
  double repeats = 0.0;
  bool comes_back = false;
  for (const RecordFit& record : result.records) {
    repeats = std::max(repeats, record.structure.repeatable_share);
    const auto& [rising, falling] = record.structure.directions;
    comes_back = comes_back || (rising.strokes > 1 && falling.strokes > 1);
  }
  return comes_back ? (1 - repeats) * result.rms * result.rms : WhiteVariance(result);
}

}  // namespace

Adequacy DoubtedByNoise(const Thresholds& thresholds, const FitResult& result) {
  Adequacy adequacy = result.adequacy;
  const double noise = NoiseVariance(result);
  const double square = result.rms * result.rms;
  constexpr double kMost = 1.5;  // times the noise
  // The rms includes the readings that a robust loss weighs down.
  if (result.outliers > 0 || !(square > kMost * kMost * noise)) return adequacy;
  adequacy.verdict = AdequacyVerdict::kDoubtful;
  adequacy.p_value = std::min(adequacy.p_value, thresholds.repeat_chance);
  if (noise > 0) {
    adequacy.misfit_over_noise =
        std::max(adequacy.misfit_over_noise, std::sqrt(square / noise - 1));
  }
  return adequacy;
}

Adequacy GradeUse(const Thresholds& thresholds, const FitResult& result) {
  Adequacy adequacy = result.adequacy;
  const double missed = MissedForce(result);
  const std::optional<double> half_gap = MeasuredHalfGap(result);
  adequacy.misfit = missed;
  adequacy.misfit_over_half_gap.reset();
  if (half_gap) adequacy.misfit_over_half_gap = missed / *half_gap;
  const double scale = half_gap ? *half_gap : ScaleOfMisfit(result);
  const double ratio = scale > 0 ? missed / scale : std::numeric_limits<double>::infinity();
  const bool is_seen = !FindUnseenLoop(result, thresholds);
  adequacy.use = is_seen && ratio <= thresholds.quantitative_misfit ? Use::kQuantitative
                 : is_seen && ratio <= thresholds.failing_misfit    ? Use::kIndicative
                                                                    : Use::kNone;
  return adequacy;
}

}  // namespace mindahl::identification
