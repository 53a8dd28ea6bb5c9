#include <algorithm>
#include <utility>

#include "kind.h"
#include "simulation.h"

/// Faults of what writes the readings down.
namespace mindahl::reliability {
namespace {

using loop::Record;

std::size_t CountOf(const Record& record, double share) {
  return std::max<std::size_t>(
      1, static_cast<std::size_t>(share * static_cast<double>(record.size())));
}

void AddForceSpikes(Record& record, std::size_t spikes, const Truth& truth, Draws& draws) {
  for (std::size_t k = 0; k < spikes; ++k) {
    record.force[draws.Index(record.size())] +=
        draws.Uniform(2.0, 6.0) * truth.law.slip_force * (draws.Index(2) == 0 ? 1 : -1);
  }
}

void AddDisplacementSpikes(Record& record, std::size_t spikes, const Truth& truth, Draws& draws) {
  for (std::size_t k = 0; k < spikes; ++k) {
    record.displacement[draws.Index(record.size())] +=
        draws.Uniform(0.5, 4.0) * Amplitude(truth) * (draws.Index(2) == 0 ? 1 : -1);
  }
}

/// In the file both channels read 0.
void DropOut(Record& record, std::size_t rows, const Truth& truth, Draws& draws) {
  for (std::size_t k = 0; k < rows; ++k) {
    const std::size_t row = draws.Index(record.size());
    record.force[row] = -truth.force_sense * truth.force_offset;
    record.displacement[row] = -truth.displacement_offset;
  }
}

/// Only the force reads 0 in the file.
Loop ZerosInTheForce(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  for (std::size_t k = CountOf(record, At(level, {0.002, 0.01, 0.05})); k > 0; --k) {
    record.force[draws.Index(record.size())] = -truth.force_sense * truth.force_offset;
  }
  return {record, AllOf(truth.law)};
}

Truth Lengthy(const Truth& truth) {
  Truth lengthy = truth;
  lengthy.cycles = 50;
  lengthy.samples_per_cycle = 200;
  return lengthy;
}

Loop ForceSpikes(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  AddForceSpikes(record, static_cast<std::size_t>(At(level, {1, 5, 20})), truth, draws);
  return {record, AllOf(truth.law)};
}

Loop DisplacementSpikes(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  AddDisplacementSpikes(record, static_cast<std::size_t>(At(level, {1, 5, 20})), truth, draws);
  return {record, AllOf(truth.law)};
}

Loop DropOuts(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  DropOut(record, CountOf(record, At(level, {0.002, 0.01, 0.05})), truth, draws);
  return {record, AllOf(truth.law)};
}

/// Runs of a tenth of a stroke in which a channel keeps its last reading.
void Hold(std::vector<double>& values, std::size_t first, std::size_t rows) {
  for (std::size_t i = first + 1; i < std::min(first + rows, values.size()); ++i) {
    values[i] = values[first];
  }
}

Loop HeldRows(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const std::size_t run = truth.samples_per_cycle / 20;
  const std::size_t rows = CountOf(record, At(level, {0.02, 0.06, 0.20}));
  for (std::size_t k = 0; k < rows; k += run) {
    const std::size_t first = draws.Index(record.size());
    Hold(record.displacement, first, run);
    Hold(record.force, first, run);
  }
  return {record, AllOf(truth.law)};
}

Loop HeldForce(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const std::size_t run = truth.samples_per_cycle / 20;
  const std::size_t rows = CountOf(record, At(level, {0.02, 0.06, 0.20}));
  for (std::size_t k = 0; k < rows; k += run) Hold(record.force, draws.Index(record.size()), run);
  return {record, AllOf(truth.law)};
}

/// A slow converter: the displacement is read anew with every few readings of the force.
Loop SampledAndHeld(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const auto every = static_cast<std::size_t>(At(level, {2, 4, 8}));
  for (std::size_t i = 0; i < record.size(); i += every) Hold(record.displacement, i, every);
  return {record, AllOf(truth.law)};
}

Loop SwappedRows(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(truth, draws);
  const std::size_t swaps = CountOf(record, At(level, {0.005, 0.02, 0.05}));
  for (std::size_t k = 0; k < swaps; ++k) {
    const std::size_t row = draws.Index(record.size() - 1);
    std::swap(record.displacement[row], record.displacement[row + 1]);
    std::swap(record.force[row], record.force[row + 1]);
  }
  return {record, AllOf(truth.law)};
}

Loop MissingRows(const Truth& truth, std::size_t level, Draws& draws) {
  const Record record = Measured(truth, draws);
  const std::size_t missing = CountOf(record, At(level, {0.03, 0.10, 0.30}));
  const std::size_t run = truth.samples_per_cycle / 10;
  std::vector<bool> is_missing(record.size(), false);
  for (std::size_t k = 0; k < missing; k += run) {
    const std::size_t first = draws.Index(record.size());
    for (std::size_t i = first; i < std::min(first + run, record.size()); ++i) {
      is_missing[i] = true;
    }
  }
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (!is_missing[i]) rows.push_back(i);
  }
  return {Rows(record, rows), AllOf(truth.law)};
}

Loop LongWithSpikes(const Truth& truth, std::size_t level, Draws& draws) {
  return DisplacementSpikes(Lengthy(truth), level, draws);
}

Loop LongWithDropOuts(const Truth& truth, std::size_t level, Draws& draws) {
  return DropOuts(Lengthy(truth), level, draws);
}

Loop LongWithNoise(const Truth& truth, std::size_t level, Draws& draws) {
  Record record = Measured(Lengthy(truth), draws);
  for (double& displacement : record.displacement) {
    displacement += At(level, {0.003, 0.01, 0.03}) * Amplitude(truth) * draws.Normal();
  }
  return {record, AllOf(truth.law)};
}

}  // namespace

std::vector<Kind> LoggerKinds() {
  return {
      {"spikes of the force", Half::kDevelopment, ForceSpikes, "1, 5, 20 samples off by 2 to 6 Tc"},
      {"spikes of the displacement", Half::kHeldOut, DisplacementSpikes,
       "1, 5, 20 samples off by 0.5 to 4 X", false},
      {"drop-outs", Half::kDevelopment, DropOuts, "0.2, 1, 5 % of the rows read 0, 0", false},
      {"zeros in the force", Half::kHeldOut, ZerosInTheForce, "0.2, 1, 5 % of the rows", false},
      {"held rows", Half::kHeldOut, HeldRows, "2, 6, 20 % of the rows, a tenth of a stroke each"},
      {"held force", Half::kDevelopment, HeldForce,
       "2, 6, 20 % of the rows, a tenth of a stroke each"},
      {"swapped rows", Half::kHeldOut, SwappedRows, "0.5, 2, 5 % of the rows with the next"},
      {"missing rows", Half::kDevelopment, MissingRows,
       "3, 10, 30 % of the rows, a fifth of a stroke each"},
      {"10,000 rows with spikes of the displacement", Half::kHeldOut, LongWithSpikes,
       "50 cycles of 200 samples; 1, 5, 20 off by 0.5 to 4 X", false},
      {"10,000 rows with drop-outs", Half::kDevelopment, LongWithDropOuts,
       "50 cycles of 200 samples; 0.2, 1, 5 % read 0, 0", false},
      {"10,000 rows of noisy displacement", Half::kHeldOut, LongWithNoise,
       "50 cycles of 200 samples; 0.3, 1, 3 % of X, white", false},
      {"displacement sampled and held", Half::kDevelopment, SampledAndHeld,
       "read anew with every 2nd, 4th, 8th reading of the force"},
  };
}

}  // namespace mindahl::reliability
