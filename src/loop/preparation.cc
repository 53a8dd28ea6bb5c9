#include "mindahl/loop/preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "loop/scratch.h"
#include "mindahl/core/error.h"

namespace mindahl::loop {
namespace {

void RequireOptions(std::size_t records, const PreparationOptions& options) {
  if (records == 0) throw InvalidArgument("there is no record: a fit needs at least one");
  if (options.force_sense && *options.force_sense != 1 && *options.force_sense != -1) {
    ThrowInvalid("force sense [-]", *options.force_sense, "must be +1 or -1");
  }
  if (options.displacement_noise) {
    RequireNonNegative("displacement noise [m]", *options.displacement_noise);
  }
  if (options.reversal_gate) RequireNonNegative("reversal gate [m]", *options.reversal_gate);
  if (!options.held_out.empty()) {
    RequireSameSize("held-out masks", options.held_out.size(), "records", records);
  }
}

/// How far noise that is known spreads [m]: normal noise of n samples reaches √(2 ln n) standard
/// deviations to either side, and must not make a reversal.
double ReachOfNoise(const RecordView& record, const PreparationOptions& options) {
  const double deviations = std::sqrt(2 * std::log(static_cast<double>(record.size())));
  return 2 * deviations * options.displacement_noise.value_or(0.0);
}

/// Standard deviation [m] of a displacement's noise where the record has to be treated as noisy.
double DisplacementNoise(const PreparedRecord& prepared, const PreparationOptions& options,
                         std::pmr::memory_resource* memory) {
  // The rounding of a file, or of a fine encoder, is not worth it.
  constexpr double kCoarse = 1e-3;  // of half the range
  if (options.displacement_noise) return *options.displacement_noise;
  const std::span<const double> displacement = prepared.record.displacement;
  const auto [lowest, highest] = std::ranges::minmax(displacement);
  const bool is_coarse = prepared.encoder_step > kCoarse * (highest / 2 - lowest / 2);
  return prepared.reversal_gate > 0 || is_coarse ? EstimateDisplacementNoise(displacement, memory)
                                                 : 0.0;
}

void Smooth(PreparedRecord& prepared) {
  if (!(prepared.displacement_noise > 0)) return;
  prepared.smoother.emplace(prepared.record.displacement, prepared.displacement_noise);
  const std::vector<double> smoothed = prepared.smoother->Smooth(prepared.record.displacement);
  prepared.smoothed.assign(smoothed.begin(), smoothed.end());
  const std::vector<std::size_t> moved = MoveReversals(prepared.smoothed, prepared.reversals);
  prepared.reversals.assign(moved.begin(), moved.end());
}

void LeaveOut(PreparedRecord& prepared, std::size_t number, const PreparationOptions& options) {
  const RecordView& record = prepared.record;
  prepared.counts.assign(record.size(), 1);
  if (options.load_window) {
    if (record.normal_load.empty()) {
      throw InvalidArgument("the load window needs a normal load in every record");
    }
    for (std::size_t i = 0; i < record.size(); ++i) {
      const double load = record.normal_load[i];
      if (load < options.load_window->lower || load > options.load_window->upper) {
        prepared.counts[i] = 0;
      }
    }
  }
  if (options.skip_cycles > 0) {
    // Two reversals a cycle; the first of them ends the way in.
    const std::size_t turns = 2 * options.skip_cycles;
    const std::size_t first =
        turns <= prepared.reversals.size() ? prepared.reversals[turns - 1] : record.size();
    std::fill_n(prepared.counts.begin(), std::min(first, record.size()), 0);
  }
  if (!options.held_out.empty() && !options.held_out[number].empty()) {
    const std::vector<bool>& held_out = options.held_out[number];
    RequireSameSize("held-out mask", held_out.size(), "samples", record.size());
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (held_out[i]) prepared.counts[i] = 0;
    }
  }
  prepared.left_out = static_cast<std::size_t>(std::ranges::count(prepared.counts, 0));
  if (prepared.left_out == record.size()) {
    throw InvalidArgument(fmt::format(
        "nothing is left of record {}: {} samples lie outside the load window, in the cycles "
        "that are skipped, or are held out",
        number + 1, prepared.left_out));
  }
}

}  // namespace

std::size_t PreparedRecords::samples() const {
  std::size_t count = 0;
  for (const PreparedRecord& record : records) count += record.size();
  return count;
}

std::size_t PreparedRecords::counted() const {
  std::size_t count = samples();
  for (const PreparedRecord& record : records) count -= record.left_out;
  return count;
}

PreparedRecords Prepare(std::span<const RecordView> records, const PreparationOptions& options,
                        std::pmr::memory_resource* memory) {
  RequireOptions(records.size(), options);
  for (const RecordView& record : records) Validate(record);
  PreparedRecords result(memory);
  result.records.reserve(records.size());
  int votes = 0;
  for (const RecordView& record : records) {
    PreparedRecord& prepared = result.records.emplace_back(record, memory);
    prepared.reversal_gate = options.reversal_gate.value_or(
        std::max(ChooseReversalGate(record.displacement, {}, memory).gate,
                 ReachOfNoise(record, options)));
    FindReversals(record.displacement, prepared.reversal_gate, prepared.reversals);
    votes += ForceSense(record, prepared.reversals, memory);
  }
  result.force_sense = options.force_sense.value_or(votes < 0 ? -1 : 1);
  for (std::size_t r = 0; r < records.size(); ++r) {
    PreparedRecord& prepared = result.records[r];
    prepared.measures =
        InSense(MeasureLoop(prepared.record, prepared.reversals, memory), result.force_sense);
    prepared.encoder_step = EncoderStep(prepared.record.displacement);
    prepared.displacement_noise = DisplacementNoise(prepared, options, memory);
    Smooth(prepared);
    LeaveOut(prepared, r, options);
  }
  return result;
}

}  // namespace mindahl::loop
