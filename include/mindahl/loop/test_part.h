#pragma once

#include <cstddef>
#include <string_view>
#include <vector>

#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// Names why samples at an end of a record are not part of its test.
enum class LeftOutReason {
  kLoadRamp,  ///< the normal load has not reached its constant value, or has left it
  kTravel,    ///< the displacement leaves the range of the strokes that others repeat
  kRest,      ///< the displacement rests
};

/// Returns "load ramp", "travel" or "rest".
std::string_view NameOf(LeftOutReason reason);

/// Successive samples [first, last) at an end of a record that are not part of its test.
struct LeftOut {
  LeftOutReason reason = LeftOutReason::kRest;
  std::size_t first = 0;
  std::size_t last = 0;
};

/// Locates the test in a record: samples [first, last).
struct TestPart {
  std::size_t first = 0;
  std::size_t last = 0;
  std::vector<LeftOut> left_out;  ///< in order of time
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
