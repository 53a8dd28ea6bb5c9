#pragma once

#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "mindahl/loop/preparation.h"
#include "mindahl/loop/record.h"

namespace mindahl::loop {

/// Why samples at an end of a record are not of its test.
enum class TrimReason {
  kRest,       ///< the displacement rests
  kRamp,       ///< cycles whose amplitude grows to that of the test, or falls from it
  kRunningIn,  ///< cycles of the test's amplitude whose facts have not settled
};

/// Returns "rest", "ramp" or "running_in".
std::string_view NameOf(TrimReason reason);

/// Successive samples [first, last) at an end of a record.
struct TrimmedPart {
  TrimReason reason = TrimReason::kRest;
  std::size_t first = 0;
  std::size_t last = 0;
  std::size_t cycles = 0;  ///< closed ones within it
  bool at_start = false;   ///< true at the beginning of the record, false at its end
  /// The first loading is in it, from where the motion begins to its first turn, which alone is of
  /// a contact that may be unloaded. A record that begins at a turn has none.
  bool has_first_loading = false;

  [[nodiscard]] std::size_t samples() const { return last - first; }
};

/// Whether a record's cycles say that it has run in.
enum class Settling {
  kSettled,    ///< they do, at once or after those that are left out
  kFewCycles,  ///< there are too few of one amplitude to say
  kUnsettled,  ///< half gap or energy still change in the last half of them, or for longer
};

/// Locates the samples at the ends of a record that are not part of its test.
struct Trim {
  std::size_t samples = 0;         ///< number in the record
  std::vector<TrimmedPart> parts;  ///< at the beginning, then at the end, in order of time
  Settling settling = Settling::kFewCycles;

  /// True if motion at the beginning was left out, so that the contact was cycled before.
  [[nodiscard]] bool begins_later() const;
  [[nodiscard]] bool has_first_loading() const;
};

/// Parts at the ends of a record that are not of its test, by its model-free facts, cycle by cycle
/// (MeasureFacts), before any model:
///
///  - rest: the displacement stays within 1 % of half its range, or within the reversal gate, for
///    longer than half a usual stroke, before the motion begins or after it has ended;
///  - ramps: cycles narrower than 0.95 of the widest, at either end, whose amplitude grows to it or
///    falls from it by no step back of more than 5 %, where all others are that wide and at least
///    three fifths of all. Nested loops, a growing sine, amplitudes in turn are no ramps;
///  - running in: of eight cycles of the widest amplitude or more the first whose half gap or
///    energy is farther than 1 % from its mean over their last half, and farther than the scatter
///    there makes once in a thousand cycles (Student's t), all to one side, up to half of them.
///    Where a slope of the last half changes it by more than 1 %, p < 0.01, or more cycles are off,
///    the record has not settled, and none is left out.
///
/// The first loading is left out where a ramp or a running-in is, never by itself.
/// @param options  as the record will be prepared; windows, held-out samples and what counts are
///   not looked at
/// @throws InvalidArgument as Prepare()
/// Cost: as Prepare() and MeasureFacts().
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
