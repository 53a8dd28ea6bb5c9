#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
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

/// Successive samples [first, last) at an end of a record that are not part of its test.
struct LeftOut {
  std::string_view reason;  ///< "load ramp", "travel" or "rest"
  std::size_t first = 0;
  std::size_t last = 0;
};

/// Locates the test in a record: samples [first, last).
struct TestPart {
  std::size_t first = 0;
  std::size_t last = 0;
  std::vector<LeftOut> left_out{};  ///< in order of time
  /// True if motion before `first` was left out: the contact was cycled before the test.
  bool begins_cycled = false;
};

/// Finds the part of a record that is its test, from the record alone:
///
///  - load ramp: of a record whose load is constant for three fifths of its samples, those before
///    and after (FindSettledLoad);
///  - travel: approach, parking, the fall of a broken specimen. The widest strokes that others
///    repeat - four or more of one range, to a tenth, that fill their time and that no jump between
///    two samples makes - are the test's. From them outwards amplitude and mean may change slowly;
///    what leaves all positions so far by more than a quarter of a stroke at once is travel, unless
///    it has four strokes itself that are as wide or wider, as a random motion has;
///  - rest: the displacement stays within 1 % of half its range, or within the noise that makes no
///    reversal, for longer than half a usual stroke. One sample of it stays.
///
/// @param record  finite, see Validate
/// @returns the whole record where nothing is left out
/// Cost: n log n at most, as ChooseReversalGate().
TestPart FindTestPart(const RecordView& record);

}  // namespace mindahl::loop
