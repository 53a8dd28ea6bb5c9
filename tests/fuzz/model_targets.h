#pragma once

#include "fuzz/target.h"

namespace mindahl::fuzz {

/// Finds reversals under any gate, in one pass and sample by sample, and chooses a gate.
void FindTurns(Input input);
/// Evaluates every model of any parameters along any path.
void EvaluateModels(Input input);
/// Moves a contact step by step, as EvaluateForce has it.
void MoveContacts(Input input);

}  // namespace mindahl::fuzz
