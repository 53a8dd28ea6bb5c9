#pragma once

#include <span>
#include <vector>

#include "identification/problem/scaled_records.h"
#include "mindahl/identification/adequacy.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

namespace mindahl::identification {

/// Returns the strokes that are no shorter than `main_stroke` of the longest.
std::vector<Stroke> MainStrokes(const ScaledRecord& record, const Thresholds& thresholds);

/// Describes the residuals that count; differences are taken within a record. Effective samples,
/// which need the noise, are left at 0.
ResidualStatistics DescribeResiduals(std::span<const RecordFit> records);

/// Makes a one-way analysis of variance of a record's residuals over 20 parts of each main stroke.
/// @param residual  of the record's samples, in any unit
ResidualStructure DescribeStructure(const ScaledRecord& record, std::span<const double> residual,
                                    const Thresholds& thresholds);

}  // namespace mindahl::identification
