#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mindahl/identification/fit_options.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/record.h"
#include "mindahl/loop/reversals.h"

/// Records of many cycles, each fitted on its own when it is complete.
namespace mindahl::campaign {

/// One cycle or several in a row, from a turning point to the next but one, with both samples.
struct Cycle {
  std::size_t number = 1;      ///< number of the first of them, counted from 1
  std::size_t cycles = 1;      ///< how many they are
  std::size_t first_line = 0;  ///< line of the file, counted from 1
  loop::Record record;
};

/// Cuts samples that arrive piece by piece into cycles, from the first turning point to every
/// second one after it; samples outside belong to no cycle. Memory: the samples since the cycle's
/// first.
class CycleSplitter {
 public:
  /// @param gate      [m]: excursions up to this are noise, as FindReversals() takes it
  /// @param together  cycles to a piece, >= 1; the last of a file may have fewer
  /// @throws InvalidArgument for a gate or a number beyond these
  explicit CycleSplitter(double gate, std::size_t together = 1);

  /// @param samples  the next, [m, N, s, N]; time and normal load may be empty, always or never
  /// @param lines    of the file, one a sample
  /// @param cycles   those that are complete now are appended
  /// @throws InvalidArgument where a cycle has more than kMostSamples
  void Add(const loop::RecordView& samples, std::span<const std::size_t> lines,
           std::vector<Cycle>& cycles);

  /// Begins anew, as at the start of another file; cycles are numbered on.
  /// @param cycles  whole ones that do not fill a piece are appended, as a shorter one
  /// @returns samples that were part of no whole cycle, since the last one or in all
  std::size_t Restart(std::vector<Cycle>& cycles);

  /// Returns the number of complete cycles so far.
  [[nodiscard]] std::size_t cycles() const { return cycles_; }

  /// Largest cycle: beyond it the record has no turning points, or the gate hides them.
  static constexpr std::size_t kMostSamples = 20'000'000;

 private:
  /// Returns where the piece begins in the samples that are kept.
  [[nodiscard]] std::size_t Begin() const { return turns_.empty() ? 0 : turns_.front() - dropped_; }
  /// Appends the whole cycles of the piece.
  void TakeOff(std::vector<Cycle>& cycles);

  double gate_;
  std::size_t together_;
  loop::ReversalFinder finder_;
  io::Samples kept_;                // from the cycle's first sample on
  std::size_t dropped_ = 0;         // samples before them
  std::vector<std::size_t> turns_;  // samples of the turning points from the piece's first on
  std::size_t cycles_ = 0;
};

/// Reads the samples that determine how the record is read: some cycles, or the first million.
io::Samples ReadHead(io::RecordStream& stream);

/// Chooses the reversal gate and the force's sign, one for all cycles, from the head of a record.
/// @param fit  written: both
/// @returns the gate, which is certain where it was given
/// @throws InputError where the head shows no turning points
loop::ReversalGate ChooseGate(const loop::RecordView& head, identification::FitOptions& fit);

}  // namespace mindahl::campaign
