#include "identification/diagnosis/adequacy.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>
#include <vector>

#include "identification/diagnosis/grade.h"

namespace mindahl::identification {

bool FollowsContact(std::span<const double> column, std::span<const double> fitted_force) {
  constexpr double kFollows = 0.3;  // correlation
  return std::abs(ColumnCorrelation(column, fitted_force)) > kFollows;
}

bool IsDoubtful(const AdequacyTest& test, const Thresholds& thresholds) {
  return test.p_value < thresholds.doubt;
}

std::vector<DepartureFit> CausesOf(const AdequacyTest& test, const Thresholds& thresholds) {
  std::vector<DepartureFit> causes = test.fits;
  std::erase_if(causes, [&](const DepartureFit& fit) {
    return !(fit.p_value < thresholds.cause && fit.delta_aicc < 0);
  });
  std::ranges::stable_sort(causes, {}, &DepartureFit::delta_aicc);
  const double best = causes.empty() ? 0.0 : causes.front().explains;
  std::erase_if(causes, [&](const DepartureFit& fit) {
    return fit.explains < thresholds.rival_cause * best;
  });
  // Causes that a fit can model come first: the user can try only those.
  std::ranges::stable_partition(
      causes, [](const DepartureFit& fit) { return !Departures()[fit.departure].group.empty(); });
  return causes;
}

Adequacy JudgeAdequacy(const ScaledRecords& data, const AdequacyTest& test,
                       std::span<const DepartureFit> causes) {
  Adequacy adequacy;
  adequacy.misfit_over_noise = test.misfit_over_noise;
  adequacy.misfit = test.misfit_over_noise * test.noise * data.response_unit();
  adequacy.p_value = test.p_value;
  adequacy.tried = test.fits.size();
  for (const DepartureFit& fit : causes) {
    const Departure& departure = Departures()[fit.departure];
    adequacy.causes.push_back(Cause{
        .code = departure.code,
        .delta_aicc = fit.delta_aicc,
        .explains = fit.explains,
        .term = std::string(fit.covariate ? std::string_view(data.covariates[*fit.covariate].name)
                                          : departure.group)});
  }
  return adequacy;
}

bool PastIsUndecided(double delta_aicc, const Thresholds& thresholds) {
  return std::abs(delta_aicc) < thresholds.rival_past;
}

bool RemembersTooLong(const FitResult& result, const Thresholds& thresholds) {
  const double size = ScaleOfMisfit(result);
  const bool is_small =
      result.outliers > 0 || !(size > 0) || !(result.residuals.rms > thresholds.poor_misfit * size);
  // The residuals correlate by 1 − DW/2 from one sample to the next, and so decay at this rate.
  const double forgotten = -std::log1p(-result.residuals.durbin_watson / 2);
  if (is_small || !std::isfinite(forgotten)) return false;
  const RecordFit& widest = result.WidestRecord();
  const auto samples = static_cast<double>(widest.residual.size());
  const auto strokes = static_cast<double>(widest.reversals.size() + 1);
  return strokes > thresholds.noise_memory * std::max(1.0, forgotten * samples);
}

bool IsInadequate(const FitResult& result, const Thresholds& thresholds) {
  if (result.FindFinding("loop_not_seen") != nullptr) return true;
  return result.adequacy.verdict == AdequacyVerdict::kDoubtful &&
         MissedForce(result) > thresholds.failing_misfit * ScaleOfMisfit(result);
}

}  // namespace mindahl::identification
