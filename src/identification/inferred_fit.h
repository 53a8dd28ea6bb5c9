#pragma once

#include <algorithm>
#include <iterator>
#include <optional>
#include <utility>
#include <vector>

#include "identification/solved_fit.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

/// Adds to what a solution says by itself its noise, errors, intervals and residuals and, by the
/// depth, adequacy, profiles and tests: each depth does what the one before does, and more.
/// @param result  values, residuals and what the records show without a model, as assembled
FitResult Infer(const Attempt& attempt, SolvedFit solved, FitResult result);

inline void Append(std::vector<Finding>& findings, std::optional<Finding> finding) {
  if (finding) findings.push_back(std::move(*finding));
}

inline void Append(std::vector<Finding>& findings, std::vector<Finding> more) {
  std::ranges::move(more, std::back_inserter(findings));
}

}  // namespace mindahl::identification
