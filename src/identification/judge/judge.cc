#include "identification/judge/judge.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace mindahl::identification {
namespace {

constexpr std::array<std::pair<std::string_view, Identifiability>, 17> kVerdicts = {{
    {"no_model_fits", Identifiability::kNotIdentifiable},
    {"energy_contradiction", Identifiability::kNotIdentifiable},
    {"undetermined_parameter", Identifiability::kNotIdentifiable},
    {"undetermined_combination", Identifiability::kNotIdentifiable},
    {"sigma_not_identifiable", Identifiability::kNotIdentifiable},
    {"alpha_not_identifiable", Identifiability::kNotIdentifiable},
    {"slip_force_not_identifiable", Identifiability::kNotIdentifiable},
    {"shape_or_rig", Identifiability::kNotIdentifiable},
    {"slip_force_bounded_below", Identifiability::kBoundedBelow},
    {"sigma_bounded_below", Identifiability::kBoundedBelow},
    {"model_inadequate", Identifiability::kNotIdentifiable},
    {"slip_force_extrapolated", Identifiability::kExtrapolated},
    {"unknown_past", Identifiability::kNotIdentifiable},
    {"few_places", Identifiability::kNotIdentifiable},
    {"initial_state_undecided", Identifiability::kIdentifiable},
    {"systematic_residual", Identifiability::kIdentifiable},
    {"turning_points_between_samples", Identifiability::kIdentifiable},
}};

}  // namespace

Identifiability VerdictOf(const Finding& finding) {
  const auto row = std::ranges::find(kVerdicts, finding.code,
                                     &std::pair<std::string_view, Identifiability>::first);
  if (row == kVerdicts.end()) {
    throw std::logic_error("the finding has no verdict: " + std::string(finding.code));
  }
  return row->second;
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
