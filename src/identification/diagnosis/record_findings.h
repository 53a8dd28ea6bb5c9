#pragma once

#include <optional>
#include <span>
#include <vector>

#include "identification/problem/scaled_records.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/loop/preparation.h"

/// Derives the findings on the records themselves, and on a model that they contradict, as data:
/// pure functions of a result.
namespace mindahl::identification {

/// Reversals that are not certain, glitches that are left out, a way that is longer than the
/// strokes of a motion that is imposed, and that no cycle is closed: whatever is fitted. Numbers of
/// a record count from 1.
std::vector<Finding> FindInRecords(std::span<const RecordFit> records, const Thresholds& thresholds,
                                   loop::Channel excitation = loop::Channel::kDisplacement);

/// True if the noise is in the displacement, by the channels' noise over X and over T*.
bool NoiseIsInDisplacement(double share_of_displacement, double share_of_force,
                           const Thresholds& thresholds);

/// A fit of the force to a record whose noise is in the displacement, by the white noise of both
/// channels, and whose contact stays below slip, by the loop's energy ratio: the displacement is
/// what could be fitted. Nothing of an encoder's readings, whose errors are no noise.
std::optional<Finding> FindNoisierDisplacement(const loop::PreparedRecords& records,
                                               const FitResult& result,
                                               const Thresholds& thresholds);

/// Energy of the widest steady cycles that count against that of the fitted law at their amplitude,
/// where no viscous force takes part of it.
std::optional<Finding> FindEnergyContradiction(const FitResult& result,
                                               const Thresholds& thresholds);

/// `load_followed` where the normal load varies within a record and the law knows it,
/// `load_not_followed` where it does not. Numbers: variation, the amplitude of a sine of the load's
/// standard deviation over its mean, and record of several.
std::vector<Finding> FindVaryingLoads(const ScaledRecords& data);

}  // namespace mindahl::identification
