#include "identification/judge/judge.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace mindahl::identification {
namespace {

/// What a finding means for the parameters that it names.
struct VerdictRow {
  std::string_view code;
  Identifiability verdict;
  bool holds_without_model = false;  // also where the model is inadequate
};

constexpr std::array kVerdicts = {
    VerdictRow{"no_model_fits", Identifiability::kNotIdentifiable, true},
    VerdictRow{"energy_contradiction", Identifiability::kNotIdentifiable, true},
    VerdictRow{"model_inadequate", Identifiability::kNotIdentifiable, true},
    VerdictRow{"undetermined_parameter", Identifiability::kNotIdentifiable},
    VerdictRow{"undetermined_combination", Identifiability::kNotIdentifiable},
    VerdictRow{"sigma_not_identifiable", Identifiability::kNotIdentifiable},
    VerdictRow{"alpha_not_identifiable", Identifiability::kNotIdentifiable},
    VerdictRow{"slip_force_not_identifiable", Identifiability::kNotIdentifiable},
    VerdictRow{"shape_or_rig", Identifiability::kNotIdentifiable},
    VerdictRow{"unknown_past", Identifiability::kNotIdentifiable},
    VerdictRow{"few_places", Identifiability::kNotIdentifiable},
    VerdictRow{"loop_not_seen", Identifiability::kNotIdentifiable, true},
    VerdictRow{"rig_not_tried", Identifiability::kNotIdentifiable},
    VerdictRow{"asymmetry_not_identifiable", Identifiability::kNotIdentifiable},
    VerdictRow{"slip_force_bounded_below", Identifiability::kBoundedBelow},
    VerdictRow{"sigma_bounded_below", Identifiability::kBoundedBelow},
    VerdictRow{"alpha_limited_by_load", Identifiability::kBoundedBelow},
    VerdictRow{"slip_force_extrapolated", Identifiability::kExtrapolated},
    VerdictRow{"initial_state_undecided", Identifiability::kIdentifiable, true},
    VerdictRow{"systematic_residual", Identifiability::kIdentifiable, true},
    VerdictRow{"turning_points_between_samples", Identifiability::kIdentifiable, true},
    // Of its own law a parameter is as well known as before.
    VerdictRow{"law_undecided", Identifiability::kIdentifiable},
    VerdictRow{"other_law_fits_better", Identifiability::kIdentifiable, true},
};

const VerdictRow& RowOf(const Finding& finding) {
  const auto row = std::ranges::find(kVerdicts, finding.code, &VerdictRow::code);
  if (row == kVerdicts.end()) {
    throw std::logic_error("the finding has no verdict: " + std::string(finding.code));
  }
  return *row;
}

}  // namespace

Identifiability VerdictOf(const Finding& finding) { return RowOf(finding).verdict; }

void WithdrawInadequate(FitResult& result) {
  result.adequacy.verdict = AdequacyVerdict::kInadequate;
  result.mindlin_test.reset();
  result.branch_shapes.clear();
  // Departures are taken to first order, here of a curve that is none of the record's.
  if (result.FindFinding("loop_not_seen") != nullptr) result.adequacy.causes.clear();
  std::erase_if(result.findings, [](const Finding& finding) {
    // Another account of a curve that is not there: also where it is but a note.
    const bool is_of_the_curve = finding.code == "shape_or_rig";
    return is_of_the_curve || (!finding.parameters.empty() && !RowOf(finding).holds_without_model);
  });
  Finding finding{.code = "model_inadequate"};
  for (ParameterEstimate& estimate : result.parameters) {
    if (estimate.status == ParameterStatus::kFixed || estimate.includes_discrepancy) continue;
    estimate.standard_error.reset();
    estimate.lower95.reset();
    estimate.upper95.reset();
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
      if (std::ranges::find(finding.parameters, estimate.name) != finding.parameters.end()) {
        worsen(VerdictOf(finding));
      }
    }
  }
}

}  // namespace mindahl::identification
