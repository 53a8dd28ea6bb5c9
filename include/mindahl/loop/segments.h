#pragma once

#include <cstddef>
#include <string_view>

#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// Locates the test in a record: samples [first, last).
struct TestPart {
  std::size_t first = 0;
  std::size_t last = 0;
  /// Why the samples before and after it are left out: "load ramp", "travel" or "rest", the first
  /// that applies; empty where none are.
  std::string_view before{}, after{};
  /// True if motion before `first` was left out: the contact was cycled before the test.
  bool begins_cycled = false;
};

/// Finds the part of a record that is its test, from the record alone. From either end are left out
///  - a load ramp: where three fifths of the samples are under the median load, to 1 % or its white
///    noise, for four turning points or more, those before the second turning point under it, by
///    which what another load has left is an offset of the force, and those after it;
///  - a travel, as approach, parking or the fall of a broken specimen: where four strokes in
///    succession are of one range, to a tenth, strokes that end outside of all others by more than
///    a quarter of that range, up to one as wide as the next, to a tenth. Amplitude and mean of a
///    test may change slowly; more than three strokes that are also more than an eighth of
///    all are a part of the test;
///  - a rest: the displacement stays within 1 % of half its range, or within the noise that makes
///    no reversal, for longer than half a usual stroke. One sample of it stays.
/// @param record  finite, see Validate
/// @returns the whole record where nothing is left out
/// Cost: n log n at most, as ChooseReversalGate().
TestPart FindTestPart(const RecordView& record);

}  // namespace mindahl::loop
