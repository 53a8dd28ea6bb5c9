#include "identification/judge/judge.h"

#include <algorithm>
#include <utility>

#include "identification/intervals.h"

namespace mindahl::identification {
FitResult WithoutInadequate(FitResult result) {
  result.adequacy.verdict = AdequacyVerdict::kInadequate;
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
    for (const Finding& finding : findings) {
      const auto& named = finding.parameters;
      if (std::ranges::find(named, estimate.name) != named.end()) {
        worsen(finding.code.row().verdict);
      }
    }
  }
}

}  // namespace mindahl::identification
