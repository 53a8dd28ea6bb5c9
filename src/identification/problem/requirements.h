#pragma once

#include "identification/problem/problem.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/loop/preparation.h"

/// Checks what options and records must satisfy to be fitted. Each throws InvalidArgument naming
/// the parameter, its value and the rule.
namespace mindahl::identification {

/// Refuses initial states that are neither none nor one a record, loads that differ or vary in a
/// fit of the displacement, which is that of one load, and noise of which squares overflow.
void RequireRecords(const FitOptions& options, const ScaledRecords& data);

/// Refuses fewer samples that count than free parameters, and says what was left out.
void RequireEnoughSamples(const Problem& problem, const loop::PreparedRecords& prepared);

/// Refuses to fit an asymmetry after slip, where it is confounded with the force's offset.
void RequireToldAsymmetry(const Problem& problem);

/// Refuses a rig that is given and softer than the loop itself from end to end, T*/X: in series
/// with it no contact, however stiff, makes the record.
void RequireRigStifferThanLoop(const FitOptions& options, const loop::PreparedRecords& records);

}  // namespace mindahl::identification
