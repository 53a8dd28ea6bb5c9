#include "identification/diagnosis/residuals.h"

#include <Eigen/Core>
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
  constexpr int kParts = 20;
  using Parts = Eigen::Array<double, kParts, 1>;
  struct Side {
    Parts strokes = Parts::Zero();  // that have samples in a part
    Parts sums = Parts::Zero();     // of their means
    Parts squares = Parts::Zero();
  };
  const std::span<const double> excitation = record.excitation();
  ResidualStructure structure;
  std::array<Side, 2> sides;
  double squares = 0.0;
  double samples = 0.0;
  for (const Stroke& stroke : MainStrokes(record, thresholds)) {
    const double from = excitation[stroke.begin];
    const double way = excitation[stroke.end] - from;
    Parts sums = Parts::Zero();
    Parts counts = Parts::Zero();
    double own_squares = 0.0;
    for (std::size_t i = stroke.begin; i <= stroke.end; ++i) {
      if (record.counts[i] == 0) continue;
      const double progress = std::clamp((excitation[i] - from) / way, 0.0, 1.0);
      const int part = std::min(static_cast<int>(progress * kParts), kParts - 1);
      sums[part] += residual[i];
      counts[part] += 1;
      own_squares += residual[i] * residual[i];
    }
    if (counts.sum() < 2) continue;  // left out, but for a reversal that it shares
    const std::size_t side = stroke.direction > 0 ? 0 : 1;
    const Parts means = sums / counts.max(1);
    sides[side].strokes += (counts > 0).cast<double>();
    sides[side].sums += means;
    sides[side].squares += means.square();
    ++structure.strokes[side];
    squares += own_squares;
    samples += counts.sum();
  }
  double between = 0.0;  // Σ n·m̄², of parts
  double within = 0.0;   // Σ (m − m̄)², of strokes within parts
  double parts = 0.0;
  double degrees_within = 0.0;
  double systematic = 0.0;  // Σ (m̄² − s²/n)
  for (const Side& side : sides) {
    const Parts is_used = (side.strokes > 1).cast<double>();
    const Parts n = side.strokes.max(2);
    const Parts mean = side.sums / n;
    const Parts scatter = is_used * (side.squares - n * mean.square()).max(0);
    between += (is_used * n * mean.square()).sum();
    within += scatter.sum();
    degrees_within += (is_used * (n - 1)).sum();
    systematic += (is_used * mean.square() - scatter / (n - 1) / n).sum();
    parts += is_used.sum();
  }
  const double mean_square = squares / samples;
  if (parts == 0 || !(between > 0)) return structure;
  constexpr double kRounding = 1e-15;  // of what repeats to the last digit
  const double ratio = between / parts / (std::max(within, kRounding * between) / degrees_within);
  if (PValueOfF(ratio, parts, degrees_within) <= thresholds.rare_chance) {
    structure.repeatable_share = std::clamp(systematic / parts / mean_square, 0.0, 1.0);
  }
  return structure;
}

}  // namespace mindahl::identification
