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
struct Row {
  std::string_view code;
  Identifiability verdict;
  bool holds_without_model = false;  // also where the model is inadequate
};

constexpr std::array kVerdicts = {
    Row{"no_model_fits", Identifiability::kNotIdentifiable, true},
    Row{"energy_contradiction", Identifiability::kNotIdentifiable, true},
    Row{"model_inadequate", Identifiability::kNotIdentifiable, true},
    Row{"undetermined_parameter", Identifiability::kNotIdentifiable},
    Row{"undetermined_combination", Identifiability::kNotIdentifiable},
    Row{"sigma_not_identifiable", Identifiability::kNotIdentifiable},
    Row{"alpha_not_identifiable", Identifiability::kNotIdentifiable},
    Row{"slip_force_not_identifiable", Identifiability::kNotIdentifiable},
    Row{"shape_or_rig", Identifiability::kNotIdentifiable},
    Row{"unknown_past", Identifiability::kNotIdentifiable},
    Row{"few_places", Identifiability::kNotIdentifiable},
    Row{"loop_not_seen", Identifiability::kNotIdentifiable, true},
    Row{"rig_not_tried", Identifiability::kNotIdentifiable},
    Row{"asymmetry_not_identifiable", Identifiability::kNotIdentifiable},
    Row{"slip_force_bounded_below", Identifiability::kBoundedBelow},
    Row{"sigma_bounded_below", Identifiability::kBoundedBelow},
    Row{"alpha_limited_by_load", Identifiability::kBoundedBelow},
    Row{"slip_force_extrapolated", Identifiability::kExtrapolated},
    Row{"initial_state_undecided", Identifiability::kIdentifiable, true},
    Row{"systematic_residual", Identifiability::kIdentifiable, true},
    Row{"turning_points_between_samples", Identifiability::kIdentifiable, true},
    // Of its own law a parameter is as well known as before.
    Row{"law_undecided", Identifiability::kIdentifiable},
    Row{"other_law_fits_better", Identifiability::kIdentifiable, true},
};

const Row& RowOf(const Finding& finding) {
  const auto row = std::ranges::find(kVerdicts, finding.code, &Row::code);
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
    if (estimate.status == ParameterStatus::kFixed) continue;
    estimate.standard_error.reset();
    estimate.lower95.reset();
    estimate.upper95.reset();
    finding.parameters.push_back(estimate.name);
  }
  result.findings.insert(result.findings.begin(), std::move(finding));
}

void Judge(std::span<ParameterEstimate> estimates, std::span<const Finding> findings) {
  for (ParameterEstimate& estimate : estimates) {
    estimate.identifiability = Identifiability::kIdentifiable;
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
