#pragma once

#include <string>
#include <vector>

#include "mindahl/report/report.h"
#include "report/statements.h"

// The answer as lines, which the text prints and the page shows.
namespace mindahl::report {

struct Line {
  std::string label;  ///< "friction"
  std::string text;
  Judgement judgement = Judgement::kNone;  ///< kGood of what may be quoted
};

/// Returns the lines in their order: what to check, columns, assumptions of the reader, friction,
/// stiffness, shape, load, terms, law, misfit, measured, left out, next, and what else a person
/// should act on. A number stands in one line only, with its interval and no other uncertainty; a
/// parameter that is not determined has a reason in place of a number; of an inadequate model only
/// what is still known has a line.
/// @param report  of a fit that did not fail
std::vector<Line> AnswerLines(const Report& report);

/// Returns what the answer leaves out.
std::vector<Line> DetailLines(const Report& report);

/// Says how far the model is from the record and what that means, as the line "misfit" does.
std::string MisfitStatement(const Report& report);

}  // namespace mindahl::report
