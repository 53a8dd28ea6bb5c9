#pragma once

#include <cstdio>
#include <vector>

#include "study.h"

namespace mindahl::reliability {

struct HalfTally {
  Half half = Half::kDevelopment;
  Tally tally;
};

/// Totals of the halves that the cases are of.
std::vector<HalfTally> TallyHalves(const std::vector<Case>& cases,
                                   const std::vector<Result>& results);

/// The tables of docs/reliability.md, in Markdown: totals, then each half kind by kind.
void PrintTables(std::FILE* file, const std::vector<Case>& cases,
                 const std::vector<Result>& results);

/// Every fit that was silent, warned or failed or gave a false limit, and clean ones that alarmed
/// or missed: what was true, what was said, and how to have the loop as a file.
void PrintDetails(std::FILE* file, const std::vector<Case>& cases,
                  const std::vector<Result>& results);

}  // namespace mindahl::reliability
