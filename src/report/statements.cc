#include "report/statements.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "mindahl/core/error.h"

namespace mindahl::report {

using identification::Identifiability;
using identification::ParameterEstimate;
using identification::ParameterStatus;

std::string NameOf(std::span<const std::string> files) {
  if (files.empty()) return "";
  std::string name = std::filesystem::path(files.front()).filename().string();
  if (files.size() > 1) name += fmt::format(" and {} more", files.size() - 1);
  return name;
}

bool IsJudged(const Report& report) { return !report.failed() && report.fit.adequacy.tried > 0; }

std::string_view VerdictWord(const Report& report) {
  if (report.failed()) return "failed";
  if (!report.fit.converged) return "not converged";
  return IsJudged(report) ? Name(report.fit.adequacy.verdict) : "not judged";
}

Judgement JudgementOf(std::string_view verdict) {
  if (verdict == "adequate") return Judgement::kGood;
  return verdict == "doubtful" || verdict == "not judged" ? Judgement::kPoor : Judgement::kBad;
}

Judgement JudgementOf(const ParameterEstimate& estimate) {
  if (WhatIsShown(estimate) == Shown::kHeld) return Judgement::kNone;
  if (WhatIsShown(estimate) == Shown::kNothing) return Judgement::kBad;
  return estimate.identifiability == Identifiability::kIdentifiable ? Judgement::kGood
                                                                    : Judgement::kPoor;
}

Shown WhatIsShown(const ParameterEstimate& estimate) {
  if (estimate.status == ParameterStatus::kFixed) return Shown::kHeld;
  const bool is_bounded = estimate.identifiability == Identifiability::kBoundedBelow;
  if (is_bounded) return estimate.lower95 ? Shown::kLowerLimit : Shown::kNothing;
  if (!estimate.is_known()) return Shown::kNothing;
  if (estimate.status == ParameterStatus::kAtLowerBound) {
    return estimate.upper95 ? Shown::kUpperLimit : Shown::kNothing;
  }
  if (estimate.status == ParameterStatus::kAtUpperBound) {
    return estimate.lower95 ? Shown::kLowerLimit : Shown::kNothing;
  }
  return Shown::kValue;
}

std::string ValueText(const ParameterEstimate& estimate) {
  constexpr int kDigits = 4;
  switch (WhatIsShown(estimate)) {
    case Shown::kValue:
      return QuantityWithInterval(estimate.value, estimate.lower95, estimate.upper95,
                                  estimate.unit);
    case Shown::kHeld:
      return fmt::format("{} (held)", Quantity(estimate.value, estimate.unit));
    case Shown::kLowerLimit:
      return fmt::format("> {}", Quantity(*estimate.lower95, estimate.unit, kDigits));
    case Shown::kUpperLimit:
      return fmt::format("< {}", Quantity(*estimate.upper95, estimate.unit, kDigits));
    case Shown::kNothing:
      break;
  }
  return "not determined";
}

std::string ParameterText(std::string_view symbol, const ParameterEstimate& estimate) {
  return fmt::format("{} {}", symbol, ValueText(estimate));
}

std::string PercentText(double share) {
  constexpr double kLeast = 1e-4;
  if (share > 0 && share < kLeast) return "< 0.01 %";
  return fmt::format("{} %", Quantity(100 * share, "-", 2));
}

namespace {

/// Says what a misfit is compared with.
struct MisfitScale {
  std::string_view name;
  double over_half_gap = 1.0;
};

MisfitScale ScaleOf(const Report& report) {
  const std::optional<double> half_gap = report.fit.MeasuredHalfGap();
  const double scale = report.fit.MisfitScale();
  if (!half_gap || scale == *half_gap) return {"half gap"};
  return {"peak force", scale / *half_gap};
}

}  // namespace

std::string MisfitShare(const Report& report, double over_half_gap) {
  const MisfitScale scale = ScaleOf(report);
  const double share = over_half_gap / scale.over_half_gap;
  if (share >= 1) return fmt::format("more than the {}", scale.name);
  return fmt::format("{} of the {}", PercentText(share), scale.name);
}

std::string NextStatement(const Report& report, const NextStep& next) {
  const double scale = ScaleOf(report).over_half_gap;
  return fmt::format("{}{}misfit {} → {} (tried)", next.text, next.text.empty() ? "" : ", ",
                     PercentText(next.misfit_before / scale),
                     MisfitShare(report, next.misfit_after));
}

std::string ChanceText(double p_value, int digits) {
  constexpr double kLeast = 1e-12;
  if (p_value < kLeast) return "p < 1e-12";
  return fmt::format("p = {:.{}g}", p_value, digits);
}

void RequireFitted(const Report& report, std::string_view what) {
  if (!report.failed()) return;
  throw InvalidArgument(fmt::format("a fit that failed has no curve and no residual for {}: {}",
                                    what, report.fit.solver.message));
}

}  // namespace mindahl::report
