#include "mindahl/identification/law_selection.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "identification/inference/noise.h"
#include "identification/intervals.h"

namespace mindahl::identification {
namespace {

/// A mean square [N² or m²] below which the logarithm is not looked at.
constexpr double kLeastSquare = std::numeric_limits<double>::min();

struct CountedResiduals {
  std::size_t count = 0;
  /// Mean over the samples of the logarithm of each record's rms, so that each counts by its noise.
  double log_rms = 0.0;
};

CountedResiduals Counted(const FitResult& fit) {
  CountedResiduals all;
  for (const RecordFit& record : fit.records) {
    double sum = 0.0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < record.residual.size(); ++i) {
      if (record.counts[i] == 0) continue;
      sum += record.residual[i] * record.residual[i];
      ++count;
    }
    if (count == 0) continue;
    const auto samples = static_cast<double>(count);
    all.log_rms += samples * std::log(std::max(sum / samples, kLeastSquare)) / 2;
    all.count += count;
  }
  all.log_rms /= static_cast<double>(std::max<std::size_t>(all.count, 1));
  return all;
}

/// True if α, σ or Tc is at a bound, where the law turns into another one.
bool LawIsAtBound(const FitResult& fit) {
  return std::ranges::any_of(fit.parameters, [](const ParameterEstimate& estimate) {
    const bool is_of_law =
        estimate.name == "sigma" || estimate.name == "alpha" || estimate.name == "slip_force";
    return is_of_law && (estimate.status == ParameterStatus::kAtLowerBound ||
                         estimate.status == ParameterStatus::kAtUpperBound);
  });
}

}  // namespace

bool MayFollowOtherLaw(const FitResult& fit, const FitOptions& options) {
  const bool is_compared = !options.fixed.contains("sigma") &&
                           !options.fixed.contains("slip_force") &&
                           fit.Find("asymmetry") == nullptr &&
                           std::ranges::none_of(fit.records, &RecordFit::load_varies);
  if (!is_compared) return false;
  if (!fit.law_choice) return !fit.converged;
  const models::FrictionModel* preferred = fit.law_choice->preferred;
  if (preferred != nullptr) return preferred == fit.law_choice->alternative;
  return fit.adequacy.verdict != AdequacyVerdict::kAdequate;
}

bool IsBetterLaw(const FitResult& other, const FitResult& than, const Thresholds& thresholds) {
  if (!other.converged || LawIsAtBound(other)) return false;
  if (!than.converged) return true;
  const CountedResiduals before = Counted(than);
  const CountedResiduals after = Counted(other);
  if (before.count != after.count) return false;
  const auto samples = static_cast<double>(before.count);
  const FitResult& best = after.log_rms < before.log_rms ? other : than;
  const Evidence evidence(before.count, std::min(best.residuals.effective_samples, samples));
  const auto criterion = [&](const FitResult& fit, double log_rms) {
    const double least = std::min(before.log_rms, after.log_rms);
    return evidence.Aicc(samples * std::exp(2 * (log_rms - least)), CountFreeParameters(fit));
  };
  return criterion(than, before.log_rms) - criterion(other, after.log_rms) >= thresholds.rival_law;
}

}  // namespace mindahl::identification
