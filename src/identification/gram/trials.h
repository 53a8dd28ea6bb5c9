#pragma once

#include <optional>
#include <span>

#include "identification/gram/omitted_terms.h"
#include "identification/problem/problem.h"
#include "identification/solve/search.h"
#include "mindahl/loop/facts.h"

namespace mindahl::identification {

/// Makes a gap that was measured (LoopFacts::backlash) a cause that is named first, and takes a
/// force that saturates, whose columns only stand for it, from what was tried. Fits the contact
/// behind a gap of that width, all parameters searched again; where that explains anything, it is
/// put in the place of what the first order of a gap does.
/// @param gaps  of each record, empty where none was measured; nothing is done unless all have one
/// @param test  of the same solution
void TryBacklash(const Problem& problem, const Solution& solution,
                 std::span<const std::optional<loop::Backlash>> gaps, const SolverOptions& options,
                 SearchBuffers& buffers, AdequacyTest& test);

/// Fits a lag to a doubted record, together with everything else, from its solution, and puts what
/// it explains in the place of what its first order does. That order ends where a sample comes to
/// lie on the stroke before its own, which a lag of a few samples does just where it shows.
/// @param test  of the same solution; unchanged where the lag is a term, is not identifiable, or
///              explains no more
void TryLag(const Problem& problem, const Solution& solution, const SolverOptions& options,
            SearchBuffers& buffers, AdequacyTest& test);

}  // namespace mindahl::identification
