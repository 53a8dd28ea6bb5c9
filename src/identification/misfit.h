#pragma once

#include "mindahl/identification/fit.h"

namespace mindahl::identification {

/// Says so where no choice of parameters follows the record: the residuals come back at the same
/// place of every stroke, and are more than noise could explain. Adds a warning that names where
/// they are, and what kind of friction or rig leaves such a trace.
void JudgeMisfit(FitResult& result);

}  // namespace mindahl::identification
