#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "mindahl/loop/disturbances.h"
#include "mindahl/loop/facts.h"
#include "mindahl/loop/record.h"
#include "mindahl/loop/reversals.h"

namespace mindahl::loop {

/// A closed range of values.
struct Interval {
  double lower = 0.0;
  double upper = 0.0;
};

/// The first to the last of what is counted from 1, both included.
struct CountRange {
  std::size_t first = 1;
  std::size_t last = 1;
};

/// A displacement [m] that was read with an error of its noise or its encoder's phase, smoothed and
/// with its reversals settled as the record's were; empty where the record's is exact.
struct DrawnReading {
  std::vector<double> displacement;
  std::vector<std::size_t> reversals;
};
using DrawnReadings = std::vector<std::vector<DrawnReading>>;  // of all records each

/// How records are read before any model is asked.
struct PreparationOptions {
  /// The channel that is imposed, and taken as exact: its turns are the reversals. Of a force that
  /// is imposed the displacement is neither smoothed nor given a gate.
  Channel excitation = Channel::kDisplacement;

  /// Excursions up to this [unit of the excitation] are noise and make no reversal. Empty:
  /// ChooseReversalGate, at least 2√(2 ln n) standard deviations of a known displacement noise.
  std::optional<double> reversal_gate{};

  /// +1: force and displacement have the same sign, −1: opposite (a load cell on the other body).
  /// Empty: decided by the sign of the loop's energy.
  std::optional<int> force_sense{};

  /// Known standard deviation of the displacement noise [m], white. Empty: estimated where the
  /// record shows it by its gate or by an encoder's steps of 2e-4 of its half range, else 0. A
  /// noisy displacement is smoothed (SmoothingReaches), since noise in the argument of a curved law
  /// is a bias; under an imposed force it is not.
  std::optional<double> displacement_noise{};

  /// The first sample of each record is a turning point, as of a cycle that was cut out.
  bool begins_at_turn = false;

  /// Samples under another load [N] do not count; such samples, and those below, make history.
  std::optional<Interval> load_window{};

  /// Samples of other cycles do not count. The first cycle lasts from the record's start to its
  /// second reversal, each other one two reversals longer, the last to the record's end.
  std::optional<CountRange> cycles{};

  /// Other samples do not count.
  std::optional<CountRange> samples{};

  /// Samples that do not count, one vector a record, each empty or one entry a sample.
  std::vector<std::vector<bool>> held_out{};

  /// DrawReadings() of the same records, for one of many fits of them; null: a fit draws its own.
  std::shared_ptr<const DrawnReadings> drawn{};
};

/// Describes how a record was read.
struct RecordReading {
  ReversalGate gate;                   ///< [unit of the excitation]; `certain` where it was given
  std::vector<std::size_t> glitches;   ///< samples left out as glitches
  std::vector<std::size_t> reversals;  ///< samples; of a noisy record after smoothing
  LoopFacts facts;                     ///< without its glitches, smoothed where it is noisy
  double displacement_noise = 0.0;     ///< [m]; 0 where readings are exact, and not smoothed
  double encoder_step = 0.0;           ///< [m]; 0 where the displacement is no encoder's
  std::vector<unsigned char> counts;   ///< one per sample: 1 where it counts, else 0
  std::size_t left_out = 0;            ///< samples that do not count
};

/// One record as every later stage sees it.
struct PreparedRecord : RecordReading {
  RecordView record;                              ///< measured record; must outlive this
  std::vector<double> interpolated_displacement;  ///< [m]; empty if the channel has no glitch
  std::vector<double> interpolated_force;         ///< [N]; empty if the channel has no glitch
  std::vector<double> smoothed;                   ///< [m]; empty where readings count as exact
  /// Windows of the smoothing, for readings that are drawn again; empty likewise.
  std::vector<std::size_t> smoothing;

  /// Returns the displacement [m] that the contact is taken to have followed.
  [[nodiscard]] std::span<const double> displacement() const {
    return smoothed.empty() ? readings().displacement : std::span<const double>(smoothed);
  }
  /// Returns the force [N] as measured, with lines over glitches.
  [[nodiscard]] std::span<const double> force() const { return readings().force; }
  /// Returns the record with lines over glitches.
  [[nodiscard]] RecordView readings() const {
    RecordView interpolated = record;
    if (!interpolated_displacement.empty()) interpolated.displacement = interpolated_displacement;
    if (!interpolated_force.empty()) interpolated.force = interpolated_force;
    return interpolated;
  }
  [[nodiscard]] std::size_t size() const { return record.size(); }
};

struct PreparedRecords {
  std::vector<PreparedRecord> records;
  Channel excitation = Channel::kDisplacement;
  int force_sense = 1;  ///< ±1, of all records

  [[nodiscard]] std::size_t samples() const;
  /// Returns the number of samples that count.
  [[nodiscard]] std::size_t counted() const;
};

/// Generates 20 to 200 synthetic realisations of the displacement readings (noise, encoder phase):
/// the error of a turning point goes along with the whole branch that starts there, which no
/// variance of a sample represents.
/// @returns the same every time; null where all displacements are exact
std::shared_ptr<const DrawnReadings> DrawReadings(const PreparedRecords& records);

/// Refuses options that break a rule whatever the records are.
/// @throws InvalidArgument naming the option, its value and the rule
void Validate(const PreparationOptions& options);

/// Finds what depends on no model.
/// @param records  not empty; their memory must outlive the result
/// @throws InvalidArgument as Validate(), for records that break a rule, where a record has no load
///   for a window, has no cycle or sample of those asked for, or nothing is left of one
PreparedRecords Prepare(std::span<const RecordView> records, const PreparationOptions& options);

}  // namespace mindahl::loop
