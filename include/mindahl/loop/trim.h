#pragma once

#include <cstddef>
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

}  // namespace mindahl::loop
