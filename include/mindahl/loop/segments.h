#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "mindahl/loop/preparation.h"
#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// Successive samples [first, last) at an end of a record in which the displacement rests.
struct TrimmedPart {
  std::size_t first = 0;
  std::size_t last = 0;
  bool at_start = false;  ///< true at the beginning of the record, false at its end

  [[nodiscard]] std::size_t samples() const { return last - first; }
};

/// Locates the samples at the ends of a record that are not part of its test.
struct Trim {
  std::size_t samples = 0;         ///< number in the record
  std::vector<TrimmedPart> parts;  ///< at the beginning, then at the end
};

/// Finds the rests at the ends of a record: the displacement stays within 1 % of half its range, or
/// within the reversal gate, for longer than half a usual stroke, before the motion begins or after
/// it has ended.
/// @param options  as the record will be prepared; windows, held-out samples and what counts are
///   not looked at
/// @throws InvalidArgument as Prepare()
/// Cost: as Prepare().
Trim FindTrim(const RecordView& record, const PreparationOptions& options = {});

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
