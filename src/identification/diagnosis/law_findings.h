#pragma once

#include <optional>

#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/law_choice.h"

namespace mindahl::identification {

/// Puts the choice between Masing's law and Dahl's own into the result, with a finding where the
/// record does not make it, or makes it against the fitted law. Of a model that is inadequate only
/// the latter is said: the other law may be why.
void SayLaw(const std::optional<LawChoice>& choice, FitResult& result);

}  // namespace mindahl::identification
