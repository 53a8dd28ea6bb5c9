#pragma once

#include <optional>

#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// Returns what is reported of the choice between Masing's law and Dahl's own: of a model that is
/// inadequate only a choice against it, as the other law may be why.
std::optional<LawChoice> ReportedLaw(const std::optional<LawChoice>& choice,
                                     AdequacyVerdict verdict);

/// Finds the other law, of a choice that is reported, where it fits better or as well.
std::optional<Finding> FindOtherLaw(const std::optional<LawChoice>& choice);

/// `memory_contradicts_law` where branches, compared with each other, are of one law's memory alone
/// and the other law fits better all the same.
std::optional<Finding> FindContradictedLaw(const MemoryTest& memory,
                                           const std::optional<LawChoice>& choice,
                                           const models::FrictionModel& fitted);

}  // namespace mindahl::identification
