#pragma once

#include <optional>
#include <span>
#include <vector>

#include "identification/problem/scaled_records.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/loop/record.h"

/// Derives the findings on the records themselves, as data: pure functions of a result.
namespace mindahl::identification {

/// Reversals that are not certain, glitches that are left out, a way that is longer than the
/// strokes of a motion that is imposed, and that no cycle is closed: whatever is fitted. Numbers of
/// a record count from 1.
std::vector<Finding> FindInRecords(std::span<const RecordFit> records, const Thresholds& thresholds,
                                   loop::Channel excitation = loop::Channel::kDisplacement);

/// `load_followed` where the normal load varies within a record and the law knows it,
/// `load_not_followed` where it does not. Numbers: variation, the amplitude of a sine of the load's
/// standard deviation over its mean, and record of several.
std::vector<Finding> FindVaryingLoads(const ScaledRecords& data);

}  // namespace mindahl::identification
