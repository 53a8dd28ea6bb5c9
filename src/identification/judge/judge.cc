#include "identification/judge/judge.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <utility>

#include "identification/intervals.h"

namespace mindahl::identification {
namespace {

/// Returns the worst verdict on a parameter of the findings that name it, but for one of them.
Identifiability VerdictOn(std::string_view parameter, std::span<const Finding> findings,
                          const Finding* but = nullptr) {
  Identifiability worst = Identifiability::kIdentifiable;
  for (const Finding& finding : findings) {
    const bool is_named =
        std::ranges::find(finding.parameters, parameter) != finding.parameters.end();
    if (&finding != but && is_named) worst = std::max(worst, finding.code.row().verdict);
  }
  return worst;
}

bool IsOfLaw(const ParameterEstimate& estimate) {
  return estimate.name == "sigma" || estimate.name == "alpha" || estimate.name == "slip_force";
}

/// Counts a residual that repeats in every stroke as model discrepancy, where no omitted term
/// explains it and it makes the model inadequate.
Adequacy WithWhatRepeats(const FitResult& result, const Thresholds& thresholds) {
  Adequacy adequacy = result.adequacy;
  if (adequacy.p_value < thresholds.doubt) return adequacy;
  for (const RecordFit& record : result.records) {
    const double fraction = record.structure.repeatable_share;
    if (!(fraction > 0 && fraction < 1)) continue;
    adequacy.p_value = std::min(adequacy.p_value, thresholds.repeat_chance);
    adequacy.misfit = std::max(adequacy.misfit, result.rms * std::sqrt(fraction));
    adequacy.misfit_over_noise =
        std::max(adequacy.misfit_over_noise, std::sqrt(fraction / (1 - fraction)));
  }
  return adequacy;
}

}  // namespace

std::vector<Finding> WithoutNeedless(std::span<const ParameterEstimate> estimates,
                                     std::vector<Finding> findings) {
  const bool is_covered = std::ranges::any_of(estimates, [](const ParameterEstimate& estimate) {
    return estimate.name == "slip_force" && estimate.includes_discrepancy;
  });
  std::erase_if(findings, [&](const Finding& finding) {
    return is_covered && finding.code == "slip_force_bounded_below";
  });
  const auto is_needless = [&](const Finding& finding) {
    if (finding.kind == "wide") {
      return VerdictOn(finding.parameters.front(), findings, &finding) ==
             Identifiability::kNotIdentifiable;
    }
    if (finding.code != "energy_contradiction") return false;
    return std::ranges::none_of(estimates, [&](const ParameterEstimate& estimate) {
      return IsOfLaw(estimate) && estimate.status != ParameterStatus::kFixed && estimate.lower95 &&
             estimate.upper95 &&
             VerdictOn(estimate.name, findings, &finding) == Identifiability::kIdentifiable;
    });
  };
  // All are asked before any goes: what is needless does not depend on their order.
  std::vector<bool> needless;
  needless.reserve(findings.size());
  for (const Finding& finding : findings) needless.push_back(is_needless(finding));
  std::size_t k = 0;
  std::erase_if(findings, [&](const Finding&) { return needless[k++]; });
  return findings;
}

FitResult WithoutInadequate(FitResult result, const Thresholds& thresholds) {
  result.adequacy = WithWhatRepeats(result, thresholds);
  result.adequacy.verdict = AdequacyVerdict::kInadequate;
  result.mindlin_test.reset();
  // Omitted terms are taken to first order, here of a curve that is none of the record's.
  if (result.FindFinding("loop_not_seen") != nullptr) result.adequacy.causes.clear();
  std::erase_if(result.findings, [](const Finding& finding) {
    // Another account of a curve that is not there: also where it is but a note.
    const bool is_of_the_curve = finding.code == "shape_or_rig";
    return is_of_the_curve ||
           (!finding.parameters.empty() && !finding.code.row().holds_without_model);
  });
  Finding finding{.code = "model_inadequate"};
  for (ParameterEstimate& estimate : result.parameters) {
    if (estimate.status == ParameterStatus::kFixed || estimate.includes_discrepancy) continue;
    WithdrawInterval(estimate);
    finding.parameters.push_back(estimate.name);
  }
  result.findings.insert(result.findings.begin(), std::move(finding));
  return result;
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
    worsen(VerdictOn(estimate.name, findings));
  }
}

}  // namespace mindahl::identification
