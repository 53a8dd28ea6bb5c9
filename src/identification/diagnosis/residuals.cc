#include "identification/diagnosis/residuals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

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

ResidualStatistics DescribeResiduals(std::span<const RecordFit> records) {
  ResidualStatistics statistics;
  double sum_of_squares = 0.0;
  double sum_of_steps = 0.0;
  std::vector<double> measured;  // of samples that count
  for (const RecordFit& record : records) {
    const std::vector<double>& fitted =
        record.fitted_displacement.empty() ? record.fitted_force : record.fitted_displacement;
    std::optional<double> last;
    for (std::size_t i = 0; i < record.residual.size(); ++i) {
      if (record.counts[i] == 0) continue;
      const double residual = record.residual[i];
      measured.push_back(fitted[i] - residual);
      sum_of_squares += residual * residual;
      if (last) sum_of_steps += (residual - *last) * (residual - *last);
      statistics.max_abs = std::max(statistics.max_abs, std::abs(residual));
      last = residual;
    }
  }
  statistics.samples = measured.size();
  const auto count = static_cast<double>(measured.size());
  const double mean = std::accumulate(measured.begin(), measured.end(), 0.0) / count;
  double variation = 0.0;
  for (const double value : measured) variation += (value - mean) * (value - mean);
  statistics.rms = std::sqrt(sum_of_squares / count);
  statistics.r_squared = variation > 0 ? 1 - sum_of_squares / variation : 0.0;
  statistics.durbin_watson = sum_of_squares > 0 ? sum_of_steps / sum_of_squares : 2.0;
  return statistics;
}

ResidualStructure DescribeStructure(const ScaledRecord& record, std::span<const double> residual,
                                    const Thresholds& thresholds) {
  constexpr std::size_t kParts = 20;
  const std::span<const double> excitation = record.excitation();
  ResidualStructure structure;
  struct Parts {
    std::array<double, kParts> sums{};
    std::array<double, kParts> counts{};
  };
  std::array<std::vector<Parts>, 2> strokes;
  double squares = 0.0;
  double samples = 0.0;
  for (const Stroke& stroke : MainStrokes(record, thresholds)) {
    const std::size_t side = stroke.direction > 0 ? 0 : 1;
    const double from = excitation[stroke.begin];
    const double way = excitation[stroke.end] - from;
    double own_squares = 0.0;
    Parts of_stroke;
    for (std::size_t i = stroke.begin; i <= stroke.end; ++i) {
      if (record.counts[i] == 0) continue;
      const double share = std::clamp((excitation[i] - from) / way, 0.0, 1.0);
      const auto part = std::min(static_cast<std::size_t>(share * kParts), kParts - 1);
      of_stroke.sums[part] += residual[i];
      ++of_stroke.counts[part];
      own_squares += residual[i] * residual[i];
    }
    const double count = std::accumulate(of_stroke.counts.begin(), of_stroke.counts.end(), 0.0);
    if (count < 2) continue;  // left out, but for a reversal that it shares
    strokes[side].push_back(of_stroke);
    ++structure.strokes[side];
    squares += own_squares;
    samples += count;
  }
  double between = 0.0;  // Σ n·m̄², of parts
  double within = 0.0;   // Σ (m − m̄)², of strokes within parts
  double parts = 0.0;
  double degrees_within = 0.0;
  double systematic = 0.0;      // Σ (m̄² − s²/n)
  std::vector<double> of_part;  // means of strokes
  for (std::size_t k = 0; k < 2 * kParts; ++k) {
    of_part.clear();
    for (const auto& [sums, counts] : strokes[k / kParts]) {
      if (const double n = counts[k % kParts]; n > 0) of_part.push_back(sums[k % kParts] / n);
    }
    const auto count = static_cast<double>(of_part.size());
    if (count < 2) continue;
    const double mean = std::accumulate(of_part.begin(), of_part.end(), 0.0) / count;
    double scatter = 0.0;
    for (const double stroke : of_part) scatter += (stroke - mean) * (stroke - mean);
    between += count * mean * mean;
    within += scatter;
    degrees_within += count - 1;
    systematic += mean * mean - scatter / (count - 1) / count;
    ++parts;
  }
  const double mean_square = squares / samples;
  if (parts == 0 || !(within > 0) || !(mean_square > 0)) return structure;
  const double ratio = between / parts / (within / degrees_within);
  if (PValueOfF(ratio, parts, degrees_within) <= thresholds.rare_chance) {
    structure.repeatable_share = std::clamp(systematic / parts / mean_square, 0.0, 1.0);
  }
  return structure;
}

}  // namespace mindahl::identification
