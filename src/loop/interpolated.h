#pragma once

#include <vector>

#include "loop/rules.h"
#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// A record without its glitches: lines over the samples that are left out. All empty where there
/// is no glitch; a channel is also empty where there is none in it.
struct Interpolated {
  std::vector<bool> glitches;        // one a sample
  std::vector<double> displacement;  // [m]
  std::vector<double> force;         // [N]
};

/// Finds the samples that no contact and no drive has made.
///
/// - A spike of 1 to 3 samples leaves its neighbours and comes back: it lies beyond both by more
///   than three times the steps about it (the third largest of 24) and of the record (of ten steps
///   nine are smaller). So corners, turning points of few samples a cycle, and square pulses that
///   come again are none.
/// - A dropout reads exactly 0 and 0, outside its neighbours' range by more than two such steps in
///   either channel; where one does, all inside the record that read so. At an end of the record,
///   which may begin at rest, it is off by more than four such steps of the displacement. So is one
///   channel alone that reads one value five times or more while the other moves, whatever it is:
///   it jumps there and back by more than three times the steps about it and of the record.
/// - A value is held where five or more samples of one channel are the same while the other moves,
///   and it then jumps, alone, by more than three times the steps about it. So rest, an encoder's
///   steps, and the plateau of a law that slips at a constant force are none.
/// A kind that makes up more than a quarter of a channel is no glitch of it. In the first and last
/// two samples no spike is found.
///
/// @param record  valid
/// Cost: linear in the samples.
Interpolated FindAndInterpolate(const RecordView& record, const GlitchRules& rules);

}  // namespace mindahl::loop
