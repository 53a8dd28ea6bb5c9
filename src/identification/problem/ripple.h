#pragma once

#include "identification/problem/scaled_records.h"

namespace mindahl::identification {

/// Returns the period, in units of the displacement, with which the forces of both directions vary
/// most over the position: that of the largest peak of their spectra together, one phase for each
/// direction and all strokes, of periods that fit twice into a stroke or oftener. Of each stroke
/// the first half is left out, in which the contact may stick, and a cubic is taken off. Cost:
/// 0.8 million sines at most.
double StartingPeriod(const ScaledRecords& data);

}  // namespace mindahl::identification
