#pragma once

#include <optional>

#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/law_choice.h"

namespace mindahl::identification {

/// Puts the choice between Masing's law and Dahl's own into the result, with a finding where the
/// record does not make it, or makes it against the fitted law. Of a model that is inadequate only
/// the latter is said: the other law may be why.
void SayLaw(const std::optional<LawChoice>& choice, FitResult& result);

/// `memory_contradicts_law` where branches, compared with each other, are of one law's memory alone
/// and the other law fits better all the same.
std::optional<Finding> FindContradictedLaw(const MemoryTest& memory,
                                           const std::optional<LawChoice>& choice,
                                           const models::FrictionModel& fitted);

}  // namespace mindahl::identification
