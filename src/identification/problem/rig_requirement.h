#pragma once

#include "mindahl/identification/fit_options.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {

/// Refuses a rig that is given and softer than the loop itself: in series with it no contact,
/// however stiff, makes the record. The loop's stiffness [N/m] is the steepest of the chords from a
/// reversal to a tenth, two tenths, … of the main strokes' way, each the mean over the strokes;
/// that to their end is T*/X.
/// @throws InvalidArgument naming the rig's stiffness and the loop's
void RequireRigStifferThanLoop(const FitOptions& options, const loop::PreparedRecords& records);

}  // namespace mindahl::identification
