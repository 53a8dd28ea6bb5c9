#include "identification/diagnosis/residuals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/probability.h"

namespace mindahl::identification {

std::vector<Stroke> MainStrokes(const ScaledRecord& record, const Thresholds& thresholds) {
  const std::span<const double> excitation = record.excitation();
  std::vector<Stroke> strokes = StrokesOf(excitation, record.reversals);
  const auto length = [&](const Stroke& stroke) {
    return std::abs(excitation[stroke.end] - excitation[stroke.begin]);
  };
  double longest = 0.0;
  for (const Stroke& stroke : strokes) longest = std::max(longest, length(stroke));
  std::erase_if(strokes, [&](const Stroke& stroke) {
    return !(length(stroke) > 0) || length(stroke) < thresholds.main_stroke * longest;
  });
  return strokes;
}

ResidualStatistics DescribeResiduals(std::span<const RecordFit> records,
                                     std::span<const std::span<const double>> measured) {
  ResidualStatistics statistics;
  double sum_of_squares = 0.0;
  double sum_of_steps = 0.0;
  double sum = 0.0;
  const auto for_each_counted = [&](const auto& visit) {
    for (std::size_t r = 0; r < records.size(); ++r) {
      for (std::size_t i = 0; i < records[r].residual.size(); ++i) {
        if (records[r].counts[i] != 0) visit(r, records[r].residual[i], measured[r][i]);
      }
    }
  };
  std::optional<std::size_t> last_record;
  double last = 0.0;
  for_each_counted([&](std::size_t record, double residual, double value) {
    ++statistics.samples;
    sum_of_squares += residual * residual;
    if (last_record == record) sum_of_steps += (residual - last) * (residual - last);
    statistics.max_abs = std::max(statistics.max_abs, std::abs(residual));
    sum += value;
    last_record = record;
    last = residual;
  });
  const auto count = static_cast<double>(statistics.samples);
  double variation = 0.0;
  for_each_counted([&](std::size_t /*record*/, double /*residual*/, double value) {
    variation += (value - sum / count) * (value - sum / count);
  });
  statistics.rms = std::sqrt(sum_of_squares / count);
  statistics.r_squared = variation > 0 ? 1 - sum_of_squares / variation : 0.0;
  statistics.durbin_watson = sum_of_squares > 0 ? sum_of_steps / sum_of_squares : 2.0;
  return statistics;
}

namespace {

constexpr std::size_t kStrokeBins = 20;
using BinMeans = std::array<double, kStrokeBins>;

/// Means of one stroke's residuals over its parts; NaN where a part has none.
BinMeans MeansOf(const Stroke& stroke, const ScaledRecord& record,
                 std::span<const double> residual) {
  BinMeans sum{};
  std::array<std::size_t, kStrokeBins> count{};
  const std::span<const double> excitation = record.excitation();
  const double from = excitation[stroke.begin];
  const double way = excitation[stroke.end] - from;
  for (std::size_t i = stroke.begin; i <= stroke.end; ++i) {
    if (record.counts[i] == 0) continue;
    const double share = std::clamp((excitation[i] - from) / way, 0.0, 1.0);
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

}  // namespace

ResidualStructure DescribeStructure(const ScaledRecord& record, std::span<const double> residual,
                                    const Thresholds& thresholds) {
  ResidualStructure structure;
  std::array<std::vector<BinMeans>, 2> means;
  std::vector<double> mean_squares;  // of strokes
  double squares = 0.0;
  double samples = 0.0;
  for (const Stroke& stroke : MainStrokes(record, thresholds)) {
    const std::size_t side = stroke.direction > 0 ? 0 : 1;
    double own_squares = 0.0;
    double count = 0.0;
    for (std::size_t i = stroke.begin; i <= stroke.end; ++i) {
      if (record.counts[i] == 0) continue;
      own_squares += residual[i] * residual[i];
      ++count;
    }
    if (count < 2) continue;  // left out, but for a reversal that it shares
    means[side].push_back(MeansOf(stroke, record, residual));
    ++structure.strokes[side];
    mean_squares.push_back(own_squares / count);
    squares += own_squares;
    samples += count;
  }
  double between = 0.0;  // Σ n·m̄², of parts
  double within = 0.0;   // Σ (m − m̄)², of strokes within parts
  double parts = 0.0;
  double degrees_within = 0.0;
  double systematic = 0.0;  // Σ (m̄² − s²/n)
  for (const std::vector<BinMeans>& of_side : means) {
    for (std::size_t bin = 0; bin < kStrokeBins; ++bin) {
      double sum = 0.0;
      double count = 0.0;
      for (const BinMeans& stroke : of_side) {
        if (std::isnan(stroke[bin])) continue;
        sum += stroke[bin];
        ++count;
      }
      if (count < 2) continue;
      const double mean = sum / count;
      double scatter = 0.0;
      for (const BinMeans& stroke : of_side) {
        if (!std::isnan(stroke[bin])) scatter += (stroke[bin] - mean) * (stroke[bin] - mean);
      }
      between += count * mean * mean;
      within += scatter;
      degrees_within += count - 1;
      systematic += mean * mean - scatter / (count - 1) / count;
      ++parts;
    }
  }
  const double mean_square = squares / samples;
  if (mean_square > 0) {
    structure.typical_share = std::min(loop::Median(mean_squares) / mean_square, 1.0);
  }
  if (parts == 0 || !(within > 0) || !(mean_square > 0)) return structure;
  const double ratio = between / parts / (within / degrees_within);
  if (ratio >= FQuantile(parts, degrees_within, thresholds.rare_chance)) {
    structure.repeatable_share = std::clamp(systematic / parts / mean_square, 0.0, 1.0);
  }
  return structure;
}

}  // namespace mindahl::identification
