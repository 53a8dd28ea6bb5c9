#pragma once

#include <string>

#include "mindahl/identification/finding.h"
#include "mindahl/identification/fit.h"
#include "mindahl/report/units.h"

namespace mindahl::report {

/// Describes a finding in words, without an end of line: what was found, what it means and, where
/// something can be done, what to do.
/// @param finding  with the numbers and parameters that its code has (docs/contract.md)
/// @param fit      the fit that found it: the model's name and why the solver stopped are its own
/// @param units    of the record
/// @throws std::logic_error for a kind without a sentence, and for a number that is missing
std::string Sentence(const identification::Finding& finding, const identification::FitResult& fit,
                     const Units& units = kUnitsOfForce);

}  // namespace mindahl::report
