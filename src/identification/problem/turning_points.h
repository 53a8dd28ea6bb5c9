#pragma once

#include <vector>

#include "identification/problem/scaled_records.h"
#include "mindahl/models/loading_path.h"

namespace mindahl::identification {

/// Returns where the motion of a record turns: at its outermost samples, or between samples where
/// the record is said to (ScaledRecord::turns_between) and five samples show a turn: of a smooth
/// motion at the extremum of the polynomial through them, of a sharp one where its lines meet.
std::vector<models::Turn> TurnsOf(const ScaledRecord& record);

/// Lets records turn between samples, but for those of an imposed force or of readings with noise.
/// @returns how far beyond a sample any turns [half range]
double TurnBetweenSamples(ScaledRecords& data);
void TurnAtSamples(ScaledRecords& data);

}  // namespace mindahl::identification
