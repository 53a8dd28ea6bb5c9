#include "identification/verdicts.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <string_view>
#include <utility>
#include <vector>

namespace mindahl::identification {
namespace {

ParameterEstimate& Mutable(FitResult& result, std::string_view name) {
  return *std::ranges::find(result.parameters, name, &ParameterEstimate::name);
}

/// Widens an interval to a likelihood range; its standard error follows where it was too small.
void Widen(ParameterEstimate& estimate, const ScaledParameter& parameter, const Range& range,
           double quantile) {
  if (!estimate.lower95 || !estimate.upper95) return;
  estimate.lower95 = std::min(*estimate.lower95, parameter.ToValue(range.lower));
  estimate.upper95 = std::max(*estimate.upper95, parameter.ToValue(range.upper));
  if (estimate.standard_error) {
    const double half_width = (*estimate.upper95 - *estimate.lower95) / 2;
    estimate.standard_error = std::max(*estimate.standard_error, half_width / quantile);
  }
}

void OpenAbove(ParameterEstimate& estimate) {
  estimate.identifiability = Identifiability::kBoundedBelow;
  estimate.upper95.reset();
  estimate.standard_error.reset();
}

}  // namespace

void Warn(FitResult& result, std::string code, std::string message) {
  result.warnings.push_back({std::move(code), std::move(message)});
}

void JudgeProfile(FitResult& result, const ParameterLayout& layout, const SlipForceProfile& profile,
                  double quantile) {
  ParameterEstimate& sigma = Mutable(result, "sigma");
  ParameterEstimate& alpha = Mutable(result, "alpha");
  ParameterEstimate& slip_force = Mutable(result, "slip_force");
  Widen(sigma, layout.parameters()[kLogStiffness], profile.stiffness, quantile);
  Widen(alpha, layout.parameters()[kShapeExponent], profile.shape_exponent, quantile);
  Widen(slip_force, layout.parameters()[kLogSlipForce], profile.slip_force, quantile);
  if (!profile.open_above) return;

  const loop::LoopMeasures& measures = result.WidestRecord().measures;
  OpenAbove(slip_force);
  // A contact that carried T* has at least that slip force, unless the fit is too poor to say.
  slip_force.lower95 =
      std::min(slip_force.value, std::max(slip_force.lower95.value_or(0.0), measures.peak_force));
  Warn(result, "slip_force_bounded_below",
       fmt::format("slip_force: the loop (T* = {:.4g} N at X = {:.4g} m) does not approach gross "
                   "slip and fits any larger slip force as well; raise the amplitude until the "
                   "force levels off",
                   measures.peak_force, measures.amplitude));
  if (alpha.status == ParameterStatus::kFixed) return;
  alpha.identifiability = Identifiability::kNotIdentifiable;
  alpha.upper95.reset();
  alpha.standard_error.reset();
  Warn(result, "alpha_not_identifiable",
       "alpha: known only together with slip_force (the ratio alpha/slip_force enters the loop); "
       "raise the amplitude until the force levels off, or fix one of them");
}

void JudgeStiffness(FitResult& result, bool open_above) {
  if (!open_above) return;
  OpenAbove(Mutable(result, "sigma"));
  Warn(result, "sigma_bounded_below",
       "sigma: a rigid contact (sigma without limit) fits as well; sample more densely after the "
       "reversals, or lower the amplitude");
}

void JudgeIntervals(FitResult& result) {
  // An interval wider than this factor either way, or than ±1/2 in α, is no determination.
  constexpr double kWidestRatio = 3.0;
  constexpr double kWidestShape = 1.0;
  for (const std::string_view name : {"sigma", "alpha", "slip_force"}) {
    ParameterEstimate& estimate = Mutable(result, name);
    if (estimate.identifiability != Identifiability::kIdentifiable || !estimate.lower95 ||
        !estimate.upper95) {
      continue;
    }
    const bool wide =
        name == "alpha"
            ? *estimate.upper95 - *estimate.lower95 > kWidestShape * std::max(1.0, estimate.value)
            : *estimate.upper95 > kWidestRatio * kWidestRatio * *estimate.lower95;
    if (!wide) continue;
    estimate.identifiability = Identifiability::kNotIdentifiable;
    Warn(result, fmt::format("{}_not_identifiable", name),
         fmt::format("{}: the 95 % interval {:.3g} … {:.3g} is too wide to call it known; record "
                     "more samples, less noise or a larger amplitude",
                     name, *estimate.lower95, *estimate.upper95));
  }
}

void JudgeNullDirections(FitResult& result, const Candidate& candidate,
                         const LocalUncertainty& local) {
  if (local.null.empty()) return;
  std::vector<std::string> names;
  for (std::size_t k = 0; k < local.columns.size(); ++k) {
    if (!local.determined[k]) names.push_back(candidate.layout.parameters()[local.columns[k]].name);
  }
  const std::string list = fmt::format("{}", fmt::join(names, ", "));
  if (local.null.size() >= names.size()) {  // each of them is a direction of its own
    Warn(result, "undetermined_parameter",
         fmt::format("{}: the record does not depend on {}; fix {}, or record another amplitude",
                     list, names.size() == 1 ? "it" : "any of them",
                     names.size() == 1 ? "it" : "them"));
    return;
  }
  Warn(result, "undetermined_combination",
       fmt::format("the record determines only a combination of {}: fix one of them, or record a "
                   "larger amplitude",
                   list));
}

}  // namespace mindahl::identification
