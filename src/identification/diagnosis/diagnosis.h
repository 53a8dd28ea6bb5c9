#pragma once

#include <optional>
#include <span>
#include <vector>

#include "identification/inference/estimates.h"
#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// Derives the findings on a fit, as data: pure functions of the results of earlier stages. None of
/// them decides on a verdict.

/// Reversals that are not certain, and that no cycle is closed: whatever is fitted. Numbers of a
/// record count from 1.
std::vector<Finding> FindInRecords(std::span<const RecordFit> records);

/// `rows_missing` where time jumps by a quarter of a cycle or more, and the displacement with it:
/// turns in it are not seen.
/// Numbers: gap and from, in seconds, and record of several.
std::vector<Finding> FindMissingRows(std::span<const loop::PreparedRecord> records);

/// `load_varies`, within a record, which the law follows or does not know. Numbers: variation, the
/// amplitude of a sine of the load's standard deviation over its mean, and record of several.
std::vector<Finding> FindVaryingLoads(const ScaledRecords& data);

/// Parameters on which, alone or combined, the records do not depend.
std::optional<Finding> FindUndetermined(const Estimates& fitted);

/// A slip force, and α with it, that the loop leaves open above.
std::vector<Finding> FindOpenSlipForce(const FitResult& result);

/// `prior_contradicted`: parameters whose prior lies far from what the records say without it;
/// where these leave a parameter open, from what they say with it.
std::optional<Finding> FindContradictedPrior(const Estimates& fitted, const Thresholds& thresholds);

/// Closed intervals too wide to call a parameter known, of those that no other finding calls
/// unknown.
std::vector<Finding> FindWideIntervals(const FitResult& result, const Thresholds& thresholds);

/// Records that turn less than twice and do not start where the contact is unloaded: the branch
/// that they start on began before them, and how far it has come is not known.
std::optional<Finding> FindUnknownPast(const Problem& problem, const Solution& solution,
                                       const Thresholds& thresholds);

/// An asymmetry of a contact that had been cycled before the records, and does not slip as a whole
/// in every one of those whose force has a known zero.
std::optional<Finding> FindUntoldAsymmetry(const FitResult& result, const Thresholds& thresholds);

/// `force_at_limit`: a force that stands at its largest or least reading, to the last digit, in a
/// twentieth of the samples, though it has noise and no other reading repeats. That is the sensor's
/// limit and not the contact's.
std::optional<Finding> FindForceAtLimit(const loop::PreparedRecords& records);

/// Samples that come back to the same few places of the loop in every cycle, however many they are:
/// what lies between them, the turning points too, no cycle shows.
std::optional<Finding> FindFewPlaces(const Problem& problem, const Thresholds& thresholds);

/// `search_limit`: a parameter that stopped at a bound of the program's own beyond which the model
/// would go on to change. With it none of the law's is to be believed. Nothing of σ, α, Tc and a
/// rig, which are a rigid contact, a straight line, a rigid rig there: their intervals are open.
std::optional<Finding> FindSearchLimit(const Problem& problem, const Solution& solution,
                                       const Thresholds& thresholds);

/// Finds the other law, of a choice that is reported, where it fits better or as well.
std::optional<Finding> FindOtherLaw(const std::optional<LawChoice>& choice);

}  // namespace mindahl::identification
