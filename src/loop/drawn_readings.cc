#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "core/draws.h"
#include "mindahl/loop/disturbances.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::loop {

namespace {

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
