#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// Successive samples [first, last) under one normal load.
struct ConstantLoad {
  std::size_t first = 0;
  std::size_t last = 0;
  double normal_load = 0.0;  ///< [N], the median
};

/// Finds the pieces of a record whose normal load goes in steps from one constant value to another.
///
/// A load is constant while it stays within 1 % to either side, or within its white noise, for four
/// turning points of the motion or more, and by less than a tenth of the step next to it;
/// neighbours differ by more than 5 %; and three fifths of the samples are under constant loads. So
/// a load that drifts, follows the motion or swings slowly has no steps.
///
/// A piece begins at the second turning point under its load, the first one with the record where
/// the load is constant from there on. Where the load has grown the contact has a part that was
/// unloaded at the step; by the second turning point the motion between ±X has reached either side
/// of it as far as it goes, and what is left of the other load is an offset of the force. A piece
/// ends before the load leaves its value.
/// @param record  finite, see Validate; with a normal load
/// @returns two pieces or more in order of time; empty where the load has no steps
/// Cost: n log n at most (ChooseReversalGate).
std::vector<ConstantLoad> FindLoadSteps(const RecordView& record);

/// Finds the piece of a record whose load ramps up at its start, or down at its end, that is under
/// one constant load: constant, and begun, as a piece of FindLoadSteps(), with three fifths of the
/// samples.
/// @param record  likewise
/// @returns empty where the record has no load, or none that is constant for so long, or is under
///   one from its first sample to its last
/// Cost: likewise.
std::optional<ConstantLoad> FindSettledLoad(const RecordView& record);

}  // namespace mindahl::loop
