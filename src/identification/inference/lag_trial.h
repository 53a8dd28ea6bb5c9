#pragma once

#include "identification/inference/adequacy_test.h"
#include "identification/problem/problem.h"
#include "identification/solve/search.h"

namespace mindahl::identification {

/// Fits a lag to a doubted record, together with everything else, from its solution, and puts what
/// it explains in the place of what its first order does. That order ends where a sample comes to
/// lie on the stroke before its own, which a lag of a few samples does just where it shows.
/// @param test  of the same solution; unchanged where the lag is a term, is not identifiable, or
///              explains no more
void TryLag(const Problem& problem, const Solution& solution, const SolverOptions& options,
            SearchBuffers& buffers, AdequacyTest& test);

/// Takes a lag from what was tried that lasts longer than the stick after a reversal, by the model:
/// a contact that is read so late would keep its old force for as long. What moves a knee by more
/// than its own width is a force of the speed.
void DenyLagBeyondKnee(const Problem& problem, const Solution& solution, Response& response,
                       AdequacyTest& test);

}  // namespace mindahl::identification
