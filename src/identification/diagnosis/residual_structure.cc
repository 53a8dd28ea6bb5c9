#include "identification/diagnosis/residual_structure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/probability.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/adequacy.h"

namespace mindahl::identification {

std::vector<MainStroke> MainStrokes(std::span<const double> displacement,
                                    std::span<const std::size_t> reversals, double main_stroke) {
  std::vector<MainStroke> strokes;
  strokes.reserve(reversals.size() + 1);
  const auto add = [&](std::size_t begin, std::size_t end) {
    strokes.push_back({begin, end, displacement[end] > displacement[begin]});
  };
  std::size_t begin = 0;
  for (const std::size_t reversal : reversals) {
    add(begin, reversal);
    begin = reversal;
  }
  add(begin, displacement.size() - 1);
  const auto length = [&](const MainStroke& stroke) {
    return std::abs(displacement[stroke.end] - displacement[stroke.begin]);
  };
  double longest = 0.0;
  for (const MainStroke& stroke : strokes) longest = std::max(longest, length(stroke));
  std::erase_if(strokes, [&](const MainStroke& stroke) {
    return !(length(stroke) > 0) || length(stroke) < main_stroke * longest;
  });
  return strokes;
}

bool AnyComesBack(std::span<const MainStroke> strokes) {
  const auto rising = std::ranges::count_if(strokes, &MainStroke::rises);
  return rising > 1 || std::ssize(strokes) - rising > 1;
}

namespace {

constexpr std::size_t kStrokeBins = 20;

/// Means of one stroke's residuals over its parts; NaN where a part has none.
std::array<double, kStrokeBins> BinMeans(const MainStroke& stroke,
                                         std::span<const double> displacement,
                                         std::span<const double> residual,
                                         std::span<const unsigned char> counts) {
  std::array<double, kStrokeBins> sum{};
  std::array<std::size_t, kStrokeBins> count{};
  const double from = displacement[stroke.begin];
  const double way = displacement[stroke.end] - from;
  for (std::size_t i = stroke.begin; i <= stroke.end; ++i) {
    if (counts[i] == 0) continue;
    const double share = std::clamp((displacement[i] - from) / way, 0.0, 1.0);
    const auto bin = std::min(static_cast<std::size_t>(share * kStrokeBins), kStrokeBins - 1);
    sum[bin] += residual[i];
    ++count[bin];
  }
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t bin = 0; bin < kStrokeBins; ++bin) {
    sum[bin] = count[bin] > 0 ? sum[bin] / static_cast<double>(count[bin]) : kNone;
  }
  return sum;
}

/// Sums of the analysis of variance.
struct Variance {
  double between = 0.0;  // Σ n·m̄², of parts
  double within = 0.0;   // Σ (m − m̄)², of strokes within parts
  double parts = 0.0;
  double degrees_within = 0.0;
  double systematic = 0.0;  // Σ (m̄² − s²/n)
};

}  // namespace

ResidualStructure DescribeStructure(std::span<const double> displacement,
                                    std::span<const std::size_t> reversals,
                                    std::span<const double> residual,
                                    std::span<const unsigned char> counts,
                                    const ResidualStructureOptions& options) {
  RequireSameSize("displacement", displacement.size(), "residual", residual.size());
  RequireSameSize("displacement", displacement.size(), "mask", counts.size());
  ResidualStructure structure;
  structure.directions[0].direction = 1;
  structure.directions[1].direction = -1;
  if (displacement.empty()) return structure;

  std::array<std::vector<std::array<double, kStrokeBins>>, 2> means;
  std::array<double, 2> samples{};
  double squares = 0.0;
  for (const MainStroke& stroke : MainStrokes(displacement, reversals, options.main_stroke)) {
    const std::size_t side = stroke.rises ? 0 : 1;
    StrokeResiduals& direction = structure.directions[side];
    double sum = 0.0;
    double sum_of_squares = 0.0;
    double count = 0.0;
    for (std::size_t i = stroke.begin; i <= stroke.end; ++i) {
      if (counts[i] == 0) continue;
      sum += residual[i];
      sum_of_squares += residual[i] * residual[i];
      ++count;
    }
    if (count < 2) continue;  // left out, but for a reversal that it shares
    means[side].push_back(BinMeans(stroke, displacement, residual, counts));
    ++direction.strokes;
    direction.mean += sum;
    direction.rms += sum_of_squares;
    samples[side] += count;
  }

  Variance variance;
  for (std::size_t side = 0; side < 2; ++side) {
    StrokeResiduals& direction = structure.directions[side];
    if (direction.strokes == 0) continue;
    squares += direction.rms;
    direction.mean /= samples[side];
    direction.rms = std::sqrt(direction.rms / samples[side]);
    structure.strokes = std::max(structure.strokes, direction.strokes);
    for (std::size_t bin = 0; bin < kStrokeBins; ++bin) {
      double sum = 0.0;
      double count = 0.0;
      for (const auto& stroke : means[side]) {
        if (std::isnan(stroke[bin])) continue;
        sum += stroke[bin];
        ++count;
      }
      if (count == 0) continue;
      const double mean = sum / count;
      double scatter = 0.0;
      for (const auto& stroke : means[side]) {
        if (!std::isnan(stroke[bin])) scatter += (stroke[bin] - mean) * (stroke[bin] - mean);
      }
      const double spread = count > 1 ? scatter / (count - 1) : 0.0;
      direction.bins.push_back(
          {(static_cast<double>(bin) + 0.5) / kStrokeBins, mean, std::sqrt(spread / count)});
      if (count < 2) continue;
      variance.between += count * mean * mean;
      variance.within += scatter;
      variance.degrees_within += count - 1;
      variance.systematic += mean * mean - spread / count;
      ++variance.parts;
    }
  }
  if (variance.parts == 0 || !(variance.within > 0) || !(squares > 0)) return structure;
  const double ratio =
      variance.between / variance.parts / (variance.within / variance.degrees_within);
  if (ratio < FQuantile(variance.parts, variance.degrees_within, options.repeat_chance)) {
    return structure;
  }
  structure.repeatable_share = std::clamp(
      variance.systematic / variance.parts / (squares / (samples[0] + samples[1])), 0.0, 1.0);
  return structure;
}

}  // namespace mindahl::identification
