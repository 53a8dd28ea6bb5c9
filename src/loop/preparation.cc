#include "mindahl/loop/preparation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>

#include "core/draws.h"
#include "core/extremes.h"
#include "mindahl/core/error.h"

namespace mindahl::loop {
namespace {

/// Leaves out glitches: their samples do not count, and the path goes straight over them.
void LeaveOutGlitches(PreparedRecord& prepared) {
  prepared.counts.assign(prepared.size(), 1);
  Interpolated interpolated = FindAndInterpolate(prepared.record);
  prepared.glitches.assign(interpolated.glitches.begin(), interpolated.glitches.end());
  for (const std::size_t i : prepared.glitches) prepared.counts[i] = 0;
  prepared.interpolated_displacement = std::move(interpolated.displacement);
  prepared.interpolated_force = std::move(interpolated.force);
}

/// Finds the turns of the excitation, and smooths a displacement that is noisy.
void ReadMotion(PreparedRecord& prepared, const PreparationOptions& options) {
  const RecordView readings = prepared.readings();
  const std::span<const double> displacement = readings.displacement;
  const bool is_force = options.excitation == Channel::kForce;
  const std::span<const double> excitation = is_force ? readings.force : displacement;
  // Normal noise of n samples reaches √(2 ln n) standard deviations to either side.
  const double deviations = std::sqrt(2 * std::log(static_cast<double>(prepared.size())));
  const double noise = is_force ? 0.0 : options.displacement_noise.value_or(0.0);
  if (!options.reversal_gate) prepared.gate = ChooseReversalGate(excitation);
  prepared.gate.gate =
      options.reversal_gate.value_or(std::max(prepared.gate.gate, 2 * deviations * noise));
  prepared.reversals = FindReversals(excitation, prepared.gate.gate);
  prepared.encoder_step = EncoderStep(displacement);
  if (is_force) return;
  // [of half the range] The rounding of a file, or of a fine encoder, is not worth it.
  constexpr double kCoarse = 2e-4;
  const bool is_coarse = prepared.encoder_step > kCoarse * ExtremesOf(displacement).half_range();
  if (options.displacement_noise) {
    prepared.displacement_noise = noise;
  } else if (prepared.gate.gate > 0 || is_coarse) {
    prepared.displacement_noise = EstimateDisplacementNoise(displacement);
  }
  if (!(prepared.displacement_noise > 0)) return;
  prepared.smoothing = SmoothingReaches(displacement, prepared.displacement_noise);
  prepared.smoothed = Smoothed(displacement, prepared.smoothing);
  prepared.reversals = MoveReversals(prepared.smoothed, prepared.reversals);
}

/// Returns the samples [first, last) of the cycles and samples that are asked for.
std::pair<std::size_t, std::size_t> ChosenSamples(const PreparedRecord& prepared,
                                                  std::size_t number,
                                                  const PreparationOptions& options) {
  const auto require = [&](const CountRange& range, std::string_view what, std::size_t has) {
    if (range.first <= has) return;
    throw InvalidArgument(
        fmt::format("{0} {1}:{2} contain nothing of record {3}, which has {4} of "
                    "them: --select {0}=1:{4} is all",
                    what, range.first, range.last, number + 1, has));
  };
  // Returns the first sample of a cycle, counted from 1; the record's size beyond the last.
  const auto start_of = [&](std::size_t cycle) {
    if (cycle == 1) return std::size_t{0};
    const std::size_t turn = 2 * cycle - 3;  // two reversals a cycle, the first ends the way in
    return turn < prepared.reversals.size() ? prepared.reversals[turn] : prepared.size();
  };
  std::size_t first = 0;
  std::size_t last = prepared.size();
  if (options.cycles) {
    // The way in and the way out are cycles too, which the number of complete ones need not hold.
    require(*options.cycles, "cycles", 1 + prepared.reversals.size() / 2);
    first = start_of(options.cycles->first);
    // One beyond the last is none: no number of cycles is so large.
    last = start_of(std::min(options.cycles->last, prepared.size()) + 1);
  }
  if (options.samples) {
    require(*options.samples, "samples", prepared.size());
    first = std::max(first, options.samples->first - 1);
    last = std::min(last, options.samples->last);
  }
  return {first, last};
}

void LeaveOut(PreparedRecord& prepared, std::size_t number, const PreparationOptions& options) {
  const RecordView& record = prepared.record;
  if (options.load_window && record.normal_load.empty()) {
    throw InvalidArgument(
        "--select load=LO:HI needs a normal load in every record: name its column with "
        "--normal-load-column");
  }
  const bool has_mask = !options.held_out.empty() && !options.held_out[number].empty();
  if (has_mask) {
    RequireSameSize("held-out mask", options.held_out[number].size(), "samples", record.size());
  }
  const auto [first, last] = ChosenSamples(prepared, number, options);
  for (std::size_t i = 0; i < record.size(); ++i) {
    const bool is_chosen =
        i >= first && i < last && !(has_mask && options.held_out[number][i]) &&
        !(options.load_window && (record.normal_load[i] < options.load_window->lower ||
                                  record.normal_load[i] > options.load_window->upper));
    if (!is_chosen) prepared.counts[i] = 0;
  }
  prepared.left_out = static_cast<std::size_t>(std::ranges::count(prepared.counts, 0));
  if (prepared.left_out == record.size()) {
    throw InvalidArgument(fmt::format(
        "nothing is left of record {}: {} samples lie outside what --select says, are glitches, or "
        "are held out",
        number + 1, prepared.left_out));
  }
}

/// A standard deviation from as many draws is good to 1/√(2·200) = 5 %; of long records fewer,
/// whose many strokes average.
constexpr std::size_t kMostDraws = 200;
constexpr std::size_t kLeastDraws = 20;
constexpr std::size_t kMostNumbers = 200'000;
constexpr std::uint64_t kSeed = 1;

std::vector<double> DrawReading(const PreparedRecord& record, Draws& draws) {
  const double step = record.encoder_step;
  // The rounding itself is q/√12; what an estimate says beyond q is noise that the encoder follows.
  const double noise = record.displacement_noise > step ? record.displacement_noise : 0.0;
  const double phase = draws.Uniform(0, 1);
  const std::span<const double> truth = record.displacement();
  std::vector<double> drawn(truth.begin(), truth.end());
  const std::span<const double> read = record.record.displacement;
  double error = 0.0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    // A reading that says what the one before said is one error.
    if (i == 0 || read[i] != read[i - 1]) error = noise * draws.Normal();
    drawn[i] += error;
    if (step > 0) drawn[i] = step * (std::round(drawn[i] / step + phase) - phase);
  }
  return drawn;
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

void Validate(const PreparationOptions& options) {
  if (options.force_sense && *options.force_sense != 1 && *options.force_sense != -1) {
    ThrowInvalid("force sign [-]", *options.force_sense, "must be +1 or -1");
  }
  for (const auto& [range, what] :
       {std::pair(options.cycles, "cycles"), std::pair(options.samples, "samples")}) {
    if (!range || (range->first >= 1 && range->first <= range->last)) continue;
    throw InvalidArgument(
        fmt::format("--select {}: '{}:{}' is empty: the first number must not be the larger", what,
                    range->first, range->last));
  }
  if (options.displacement_noise) {
    RequireNonNegative("displacement noise [m]", *options.displacement_noise);
  }
  if (options.reversal_gate) RequireNonNegative("reversal gate [m]", *options.reversal_gate);
}

PreparedRecords Prepare(std::span<const RecordView> records, const PreparationOptions& options) {
  if (records.empty()) throw InvalidArgument("there is no record: a fit needs at least one");
  Validate(options);
  if (!options.held_out.empty()) {
    RequireSameSize("held-out masks", options.held_out.size(), "records", records.size());
  }
  for (const RecordView& record : records) {
    Validate(record);
    if (record.size() == 0) throw InvalidArgument("the record is empty: must have samples");
  }
  PreparedRecords result;
  result.excitation = options.excitation;
  result.records.reserve(records.size());
  int votes = 0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    PreparedRecord& prepared = result.records.emplace_back();
    prepared.record = records[r];
    LeaveOutGlitches(prepared);
    ReadMotion(prepared, options);
    LeaveOut(prepared, r, options);
    RecordView followed = prepared.readings();
    followed.displacement = prepared.displacement();
    prepared.facts = MeasureFacts(followed, prepared.reversals, 1, prepared.counts);
    votes += ForceSense(prepared.readings(), prepared.facts);
  }
  result.force_sense = options.force_sense.value_or(votes < 0 ? -1 : 1);
  if (result.force_sense > 0) return result;
  for (PreparedRecord& prepared : result.records) TurnForce(prepared.facts);
  return result;
}

std::shared_ptr<const DrawnReadings> DrawReadings(const PreparedRecords& records) {
  const auto is_exact = [](const PreparedRecord& record) {
    return !(record.displacement_noise > 0);
  };
  if (std::ranges::all_of(records.records, is_exact)) return nullptr;
  auto readings = std::make_shared<DrawnReadings>(
      std::clamp(kMostNumbers / records.samples(), kLeastDraws, kMostDraws));
  Draws draws(kSeed);
  for (std::vector<DrawnReading>& draw : *readings) {
    for (const PreparedRecord& record : records.records) {
      DrawnReading& drawn = draw.emplace_back();
      if (is_exact(record)) continue;
      drawn.displacement = Smoothed(DrawReading(record, draws), record.smoothing);
      drawn.reversals = MoveReversals(drawn.displacement, record.reversals);
    }
  }
  return readings;
}

}  // namespace mindahl::loop
