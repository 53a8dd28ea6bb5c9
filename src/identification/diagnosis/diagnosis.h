#pragma once

#include <algorithm>
#include <iterator>
#include <optional>
#include <span>
#include <vector>

#include "identification/inference/estimates.h"
#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

namespace mindahl::identification {

/// Derives the findings on a fit, as data: pure functions of the results of earlier stages. None of
/// them decides on a verdict.

inline void Append(std::vector<Finding>& findings, std::vector<Finding> more) {
  std::ranges::move(more, std::back_inserter(findings));
}

/// Reversals that are not certain, and that no cycle is closed. Records count from 1.
std::vector<Finding> FindInRecords(std::span<const RecordFit> records);

/// `rows_missing` where time jumps by a quarter of a cycle or more, and the displacement with it:
/// turns in it are not seen. Numbers: gap and from [s], and record of several.
std::vector<Finding> FindMissingRows(std::span<const loop::PreparedRecord> records);

/// `load_varies`, within a record, which the law follows or does not know. Numbers: variation, the
/// amplitude of a sine of the load's standard deviation over its mean, and record of several.
std::vector<Finding> FindVaryingLoads(const ScaledRecords& data);

/// Parameters on which, alone or combined, the records do not depend.
std::vector<Finding> FindUndetermined(const Estimates& fitted);

/// A slip force, and α with it, that the loop leaves open above.
std::vector<Finding> FindOpenSlipForce(const FitResult& result);

/// Closed intervals too wide to call a parameter known, where no other finding calls it unknown.
std::vector<Finding> FindWideIntervals(const FitResult& result, const Thresholds& thresholds);

/// `search_limit`: a parameter that stopped at a bound of the program's own beyond which the model
/// would go on to change. With it none of the law's is to be believed. Nothing of σ, α, Tc and a
/// rig, which are a rigid contact, a straight line, a rigid rig there: their intervals are open.
std::vector<Finding> FindSearchLimit(const Problem& problem, const Solution& solution);

/// Finds what else leaves a parameter open, or contradicts it: an unknown past, few places of the
/// loop, a force at its sensor's limit, an asymmetry below slip, a prior, FindOpenSlipForce().
std::vector<Finding> FindOnParameters(const Estimates& fitted, const loop::PreparedRecords& records,
                                      const FitResult& result);

/// Finds the other law, of a choice that is reported, where it fits better or as well.
std::vector<Finding> FindOtherLaw(const std::optional<LawChoice>& choice);

}  // namespace mindahl::identification
