#include <algorithm>
#include <cmath>

#include "kind.h"
#include "simulation.h"

/// Records that are too few rows, too short, or taken at an unlucky pace. Nothing else is wrong.
namespace mindahl::reliability {
namespace {

using loop::Record;

/// Rows of a dense record, whose motion the contact has felt between them too.
Loop Sparse(const Truth& truth, double cycles, double rows_per_cycle, double first, Draws& draws) {
  constexpr std::size_t kDense = 1000;
  Truth dense = truth;
  dense.samples_per_cycle = kDense;
  dense.cycles = static_cast<std::size_t>(std::ceil(cycles)) + 1;
  Record record = Ideal(dense, draws);
  std::vector<std::size_t> rows;
  for (double phase = first; phase < cycles; phase += 1 / rows_per_cycle) {
    rows.push_back(static_cast<std::size_t>(phase * kDense));
  }
  record = Rows(record, rows);
  AddNoise(record, truth, draws);
  return {record, AllOf(truth.law)};
}

Loop SampledInStep(const Truth& truth, std::size_t level, Draws& draws) {
  const double rows = At(level, {10, 8, 5});
  return Sparse(truth, 20, rows, draws.Uniform(0.0, 1 / rows), draws);
}

Loop TenSamplesACycle(const Truth& truth, std::size_t level, Draws& draws) {
  const double rows = 10 + draws.Uniform(-0.5, 0.5);  // not in step
  return Sparse(truth, At(level, {10, 30, 100}), rows, 0.0, draws);
}

Loop FewRows(const Truth& truth, std::size_t level, Draws& draws) {
  constexpr double kCycles = 1.5;
  return Sparse(truth, kCycles, At(level, {60, 30, 12}) / kCycles, 0.0, draws);
}

/// From `begin` to `end`, in cycles of a sine that the contact has followed from rest.
Loop Stretch(const Truth& truth, double begin, double end, Draws& draws) {
  Truth virgin = truth;
  virgin.virgin = true;
  virgin.cycles = static_cast<std::size_t>(std::ceil(end)) + 1;
  const Record record = Measured(virgin, draws);
  const auto row = [&](double cycles) {
    return static_cast<std::size_t>(cycles * static_cast<double>(truth.samples_per_cycle));
  };
  return {Part(record, row(begin), std::max(row(end), row(begin) + 6)), AllOf(truth.law)};
}

Loop OneStroke(const Truth& truth, std::size_t level, Draws& draws) {
  if (level == 0) return Stretch(truth, 0.0, 0.25, draws);
  if (level == 1) return Stretch(truth, 1.25, 1.75, draws);
  return Stretch(truth, 1.3, 1.7, draws);
}

Loop HalfCycle(const Truth& truth, std::size_t level, Draws& draws) {
  const double begin = truth.virgin ? 0.0 : 1 + draws.Uniform(0.0, 1.0);
  return Stretch(truth, begin, begin + At(level, {0.75, 0.5, 0.4}), draws);
}

Loop EndsAfterTurn(const Truth& truth, std::size_t level, Draws& draws) {
  return Stretch(truth, 0.0, 0.25 + At(level, {0.20, 0.08, 0.03}), draws);
}

Loop StartsAnywhere(const Truth& truth, std::size_t level, Draws& draws) {
  const double begin = 1 + draws.Uniform(0.0, 1.0);
  return Stretch(truth, begin, begin + At(level, {2.3, 1.4, 0.9}), draws);
}

Loop Uneven(const Truth& truth, std::size_t level, Draws& draws) {
  Truth dense = truth;
  dense.samples_per_cycle = 2000;
  const Record record = Ideal(dense, draws);
  const std::size_t mean = dense.samples_per_cycle / truth.samples_per_cycle;
  const auto spread = At(level, {0.5, 1.0, 3.0}) * static_cast<double>(mean);
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < record.size();
       row += 1 + static_cast<std::size_t>(
                      std::abs(static_cast<double>(mean) + spread * draws.Normal()))) {
    rows.push_back(row);
  }
  Record kept = Rows(record, rows);
  AddNoise(kept, truth, draws);
  return {kept, AllOf(truth.law)};
}

Loop RepeatedRows(const Truth& truth, std::size_t level, Draws& draws) {
  const Record record = Measured(truth, draws);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < record.size(); ++i) {
    rows.push_back(i);
    while (draws.Uniform(0.0, 1.0) < At(level, {0.05, 0.20, 0.60})) rows.push_back(i);
  }
  return {Rows(record, rows), AllOf(truth.law)};
}

Loop ThinnedAtTurns(const Truth& truth, std::size_t level, Draws& draws) {
  const Record ideal = Ideal(truth, draws);
  const double limit = (1 - 2 * At(level, {0.01, 0.05, 0.20})) * Amplitude(truth);
  std::vector<std::size_t> rows;
  for (std::size_t i = 0; i < ideal.size(); ++i) {
    if (std::abs(ideal.displacement[i]) < limit) rows.push_back(i);
  }
  Record record = Rows(ideal, rows);
  AddNoise(record, truth, draws);
  return {record, AllOf(truth.law)};
}

}  // namespace

std::vector<Kind> SamplingKinds() {
  return {
      {"sampled in step with the motion", Half::kDevelopment, SampledInStep,
       "10, 8, 5 samples a cycle, 20 cycles"},
      {"ten samples a cycle", Half::kHeldOut, TenSamplesACycle, "10, 30, 100 cycles", false},
      {"few samples", Half::kDevelopment, FewRows, "60, 30, 12 over one and a half cycles"},
      {"one stroke", Half::kHeldOut, OneStroke, "from rest; from turn to turn; without its ends"},
      {"part of a cycle", Half::kDevelopment, HalfCycle, "0.75, 0.5, 0.4 cycles"},
      {"ends after the first turn", Half::kHeldOut, EndsAfterTurn, "by 20, 8, 3 % of a cycle"},
      {"starts anywhere", Half::kDevelopment, StartsAnywhere,
       "2.3, 1.4, 0.9 cycles of a steady loop"},
      {"uneven sampling", Half::kHeldOut, Uneven, "intervals scatter by 0.5, 1, 3 of their mean"},
      {"repeated rows", Half::kDevelopment, RepeatedRows, "5, 20, 60 % of the rows once or more"},
      {"no samples at the turns", Half::kHeldOut, ThinnedAtTurns,
       "none in the outer 1, 5, 20 % of the stroke on either side"},
  };
}

}  // namespace mindahl::reliability
