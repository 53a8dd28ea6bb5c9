#include "identification/diagnosis/adequacy.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "identification/inference/estimates.h"

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

namespace {

/// Returns the variance [N² or m²] of the residuals that is noise whatever the model: where strokes
/// of both directions come back, of what does not repeat with them, else what differs between
/// neighbouring samples.
double NoiseVariance(const FitResult& result) {
  double share = 1.0;
  bool comes_back = false;
  for (const RecordFit& record : result.records) {
    const ResidualStructure& structure = record.structure;
    share = std::min(share, structure.noise_share);
    const auto& [rising, falling] = structure.strokes;
    comes_back = comes_back || (rising > 1 && falling > 1);
  }
  return comes_back ? share * result.rms * result.rms : WhiteVariance(result);
}

}  // namespace

bool LeavesHalfGap(const loop::LoopFacts& facts, double without, double with) {
  constexpr double kFarthest = 1.25;
  if (!loop::Slides(facts)) return false;
  const double ratio = with / *facts.half_gap;
  if (ratio <= kFarthest && ratio >= 1 / kFarthest) return false;
  const auto distance = [&](double slip_force) {
    return std::abs(slip_force / *facts.half_gap - 1);
  };
  return !(distance(with) < distance(without));
}

std::optional<FitOptions> WithinMeasuredForce(const FitResult& result, const FitOptions& options) {
  constexpr const char* kName = "slip_force";
  // Below, nothing says that the model does not follow the record.
  if (result.depth < Depth::kIntervals) return std::nullopt;
  const Thresholds& thresholds = options.thresholds;
  // The other law may carry it.
  if (result.prefers_other_law()) return std::nullopt;
  const bool is_followed = result.adequacy.verdict == AdequacyVerdict::kAdequate ||
                           result.adequacy.misfit <= thresholds.poor_misfit * result.MisfitScale();
  if (is_followed || result.parameters.empty() || result.response == loop::Channel::kDisplacement ||
      result.is_scaled_by_load() || options.bounds.contains(kName) ||
      options.fixed.contains(kName)) {
    return std::nullopt;
  }
  const double peak_force = result.PeakForce();
  if (!loop::Slides(result.WidestRecord().facts) ||
      peak_force >= thresholds.mobilised * result.law.slip_force) {
    return std::nullopt;
  }
  FitOptions within = options;
  within.bounds[kName] = {0.0, peak_force};
  within.start.clear();
  return within;
}

double MissedForce(const FitResult& result) {
  const double explained = result.adequacy.misfit;
  // The rms includes the readings that a robust loss weighs down.
  const bool is_noise = result.adequacy.verdict == AdequacyVerdict::kAdequate;
  if (is_noise || result.outliers > 0) return explained;
  const double not_white = result.rms * result.rms - WhiteVariance(result);
  return std::max(explained, std::sqrt(std::max(0.0, not_white)));
}

std::vector<OmittedTerm> CausesOf(const AdequacyTest& test, const Thresholds& thresholds) {
  std::vector<OmittedTerm> causes = test.fits;
  std::erase_if(causes, [&](const OmittedTerm& fit) {
    return !(fit.p_value < thresholds.rare_chance && fit.delta_aicc < 0);
  });
  std::ranges::stable_sort(causes, {}, &OmittedTerm::delta_aicc);
  const double best = causes.empty() ? 0.0 : causes.front().explains;
  std::erase_if(causes,
                [&](const OmittedTerm& fit) { return fit.explains < thresholds.rival * best; });
  // Causes that a fit can model come first: the user can try only those.
  std::ranges::stable_partition(causes, [](const OmittedTerm& fit) { return !fit.term.empty(); });
  return causes;
}

bool AreUnlikeNoise(const FitResult& result, const Thresholds& thresholds) {
  const double size = result.MisfitScale();
  const bool is_small =
      result.outliers > 0 || !(size > 0) || !(result.residuals.rms > thresholds.poor_misfit * size);
  if (is_small) return false;
  const bool is_carried_over = std::ranges::any_of(result.records, [&](const RecordFit& record) {
    return record.structure.carried_over > thresholds.carried_over;
  });
  if (is_carried_over) return true;
  // The residuals correlate by 1 − DW/2 from one sample to the next, and so decay at this rate.
  const double correlation = 1 - result.residuals.durbin_watson / 2;
  const double forgotten = -std::log(correlation);
  if (!std::isfinite(forgotten)) return false;
  const RecordFit& widest = result.WidestRecord();
  const auto samples = static_cast<double>(widest.residual.size());
  const auto strokes = static_cast<double>(widest.reversals.size() + 1);
  return strokes > thresholds.noise_memory * std::max(1.0, forgotten * samples);
}

Adequacy JudgeAdequacy(const ScaledRecords& data, const AdequacyTest& test,
                       std::span<const OmittedTerm> causes, bool is_limited,
                       const FitResult& result, const Thresholds& thresholds) {
  Adequacy adequacy;
  adequacy.misfit_over_noise = test.misfit_over_noise;
  adequacy.misfit = test.misfit_over_noise * test.noise * data.response_unit();
  adequacy.p_value = test.p_value;
  adequacy.tried = test.fits.size();
  adequacy.causes.assign(causes.begin(), causes.end());
  const double noise = NoiseVariance(result);
  const double square = result.rms * result.rms;
  // The rms includes the readings that a robust loss weighs down.
  const bool exceeds_noise =
      result.outliers == 0 && square > thresholds.larger_rms * thresholds.larger_rms * noise;
  if (exceeds_noise) {
    adequacy.p_value = std::min(adequacy.p_value, thresholds.rare_chance);
    if (noise > 0) {
      adequacy.misfit_over_noise =
          std::max(adequacy.misfit_over_noise, std::sqrt(square / noise - 1));
    }
  }
  const bool is_doubtful = test.p_value < thresholds.doubt || is_limited || exceeds_noise ||
                           AreUnlikeNoise(result, thresholds);
  adequacy.verdict = is_doubtful ? AdequacyVerdict::kDoubtful : AdequacyVerdict::kAdequate;
  return adequacy;
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
  const double scale = half_gap ? *half_gap : result.MisfitScale();
  const double ratio =
      scale > 0 ? adequacy.misfit / scale : std::numeric_limits<double>::infinity();
  const bool is_seen = IsLoopSeen(result, thresholds);
  adequacy.use = is_seen && ratio <= thresholds.quantitative_misfit ? Use::kQuantitative
                 : is_seen && ratio <= thresholds.failing_misfit    ? Use::kIndicative
                                                                    : Use::kNone;
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
    estimate.identifiability = estimate.includes_discrepancy ? Identifiability::kEffective
                                                             : Identifiability::kIdentifiable;
    if (estimate.status == ParameterStatus::kFixed) continue;
    const auto worsen = [&](Identifiability verdict) {
      estimate.identifiability = std::max(estimate.identifiability, verdict);
    };
    if (!estimate.lower95) {
      worsen(Identifiability::kNotIdentifiable);
    } else if (!estimate.upper95) {
      worsen(Identifiability::kBoundedBelow);
    }
    for (const Finding& finding : findings) {
      const auto& named = finding.parameters;
      if (std::ranges::find(named, estimate.name) != named.end()) {
        worsen(finding.code.row().verdict);
      }
    }
  }
}

}  // namespace mindahl::identification
