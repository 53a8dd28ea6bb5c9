#pragma once

#include "identification/inference/estimates.h"
#include "identification/problem/problem.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

/// Intervals of a fit whose model misses something that comes back in every stroke: such an error
/// does not average out, however many samples there are, and its size is that of the record.
namespace mindahl::identification {

/// Returns the estimates with intervals that cover the model discrepancy. That of Tc is replaced
/// where the measured loop slides over most of its stroke or reaches slip: it becomes the union of
/// the fitted value, the measured half gap with its margin, and the interval so far, of noise and
/// of the terms that the model omits, as far as that lies between the least and the largest of half
/// gap, T* and the value, each with the margin. A loop that slides has carried its slip force: no
/// less than the gap in the middle of the stroke, no more than its largest force. The margin is the
/// scatter of the cycles' half gaps and the force that the model misses. Other intervals are left
/// as they are; those of a fit that is of use count as including what the model misses.
ParameterEstimates CoverDiscrepancy(const Estimates& fitted, const Thresholds& thresholds,
                                    const FitResult& result);

}  // namespace mindahl::identification
