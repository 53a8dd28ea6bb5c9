#include "identification/inference/noise.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <ranges>

#include "core/probability.h"

namespace mindahl::identification {
namespace {

constexpr std::size_t kHighestOrder = 12;
constexpr std::size_t kSamplesPerOrder = 10;
/// Fraction of its largest output below which a filter's memory is rounding.
constexpr double kForgotten = 1e-9;
constexpr std::size_t kLongestMemory = 100'000;  // samples that it is given to forget

using Lags = Eigen::Array<double, kHighestOrder + 1, 1>;

double CountedSamplesOf(const ScaledRecord& record) {
  return static_cast<double>(std::ranges::count(record.counts, 1));
}

/// Means of r_t·r_{t+k} over pairs that both count, k = 0 … order, each times the fraction of lags
/// that a series of this length has: without gaps that keeps the sequence positive definite.
Lags EstimateAutocovariances(std::span<const ScaledRecord> records,
                             std::span<const double> residual, std::size_t order) {
  Lags sums = Lags::Zero();
  Lags pairs = Lags::Zero();
  Lags counting = Lags::Zero();
  for (const ScaledRecord& record : records) {
    const std::span<const double> own = record.Of(residual);
    // Lags within, so that their sums do not wait for each other.
    for (std::size_t i = 0; i < record.size(); ++i) {
      for (std::size_t lag = 0; lag <= std::min(order, i); ++lag) {
        ++pairs[lag];
        if (record.counts[i] == 0 || record.counts[i - lag] == 0) continue;
        sums[lag] += own[i] * own[i - lag];
        ++counting[lag];
      }
    }
  }
  return sums / counting.max(1) * pairs / static_cast<double>(residual.size());
}

/// Returns ρ₀, ρ₁ … of all lags, until they have decayed.
std::vector<double> AllCorrelations(const Autocorrelation& process) {
  const auto order = std::ssize(process.coefficients);
  std::vector<double> all = process.correlations;
  // Beyond the order ρ obeys the recursion of r itself.
  const auto is_remembered = [](double correlation) { return std::abs(correlation) >= kForgotten; };
  while (std::any_of(all.rbegin(), all.rbegin() + order, is_remembered) &&
         all.size() < kLongestMemory) {
    all.push_back(
        std::inner_product(all.rbegin(), all.rbegin() + order, process.coefficients.begin(), 0.0));
  }
  return all;
}

using Parts = Eigen::ArrayXd;  // of a stroke's length

/// Means m of the residual in each part of the strokes of one direction.
struct Side {
  explicit Side(Eigen::Index parts)
      : last(Parts::Zero(parts)), strokes(last), sums(last), squares(last) {}

  Parts last;     // means of the last stroke, 0 where it has no samples
  Parts strokes;  // that have samples in a part
  Parts sums;     // of their means
  Parts squares;
};

/// Returns the mean square of what repeats in every stroke, 0 where the F test takes it for chance;
/// empty where no part has samples of two strokes, or all means are 0.
std::optional<double> RepeatingSquare(std::span<const Side> sides, const Thresholds& thresholds) {
  double between = 0.0;  // Σ n·m̄², of parts
  double within = 0.0;   // Σ (m − m̄)², of strokes within parts
  double parts = 0.0;
  double degrees_within = 0.0;
  double repeating = 0.0;  // Σ (m̄² − s²/n)
  for (const Side& side : sides) {
    const Parts is_used = (side.strokes > 1).cast<double>();
    const Parts n = side.strokes.max(2);
    const Parts mean = side.sums / n;
    const Parts scatter = is_used * (side.squares - n * mean.square()).max(0);
    between += (is_used * n * mean.square()).sum();
    within += scatter.sum();
    degrees_within += (is_used * (n - 1)).sum();
    repeating += (is_used * mean.square() - scatter / (n - 1) / n).sum();
    parts += is_used.sum();
  }
  if (parts == 0 || !(between > 0)) return std::nullopt;
  constexpr double kRounding = 1e-15;  // of what repeats to the last digit
  const double ratio = between / parts / (std::max(within, kRounding * between) / degrees_within);
  const double chance = PValueOfF(ratio, parts, degrees_within);
  return chance <= thresholds.rare_chance ? repeating / parts : 0.0;
}

/// Returns a sum of squares that is no less than rounding errors leave.
double Floored(double sum_of_squares, std::size_t samples) {
  return std::max(sum_of_squares, static_cast<double>(samples) * kRoundingRms * kRoundingRms);
}

}  // namespace

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
  const Eigen::Map<const Eigen::ArrayXd> values(measured.data(), std::ssize(measured));
  const double variation = (values - values.mean()).square().sum();
  statistics.rms = std::sqrt(sum_of_squares / count);
  statistics.r_squared = variation > 0 ? 1 - sum_of_squares / variation : 0.0;
  statistics.durbin_watson = sum_of_squares > 0 ? sum_of_steps / sum_of_squares : 2.0;
  return statistics;
}

double WhiteVariance(const FitResult& result) {
  constexpr double kOfWhiteNoise = 1.5;  // mean square of (r₋₁ + r₊₁)/2 − r₀ over its variance
  double squares = 0.0;
  double count = 0.0;
  for (const RecordFit& record : result.records) {
    for (std::size_t i = 1; i + 1 < record.residual.size(); ++i) {
      if (record.counts[i - 1] == 0 || record.counts[i] == 0 || record.counts[i + 1] == 0) continue;
      const double off = (record.residual[i - 1] + record.residual[i + 1]) / 2 - record.residual[i];
      squares += off * off;
      ++count;
    }
  }
  return count > 0 ? squares / (kOfWhiteNoise * count) : 0.0;
}

ResidualStructure DescribeStructure(const ScaledRecord& record, std::span<const double> residual,
                                    const Thresholds& thresholds) {
  const std::span<const double> excitation = record.excitation();
  ResidualStructure structure;
  // Each part has about one sample, so that a ripple with a period of a few samples is resolved.
  constexpr Eigen::Index kFewestParts = 20;
  constexpr Eigen::Index kMostParts = 200;
  const Eigen::Index parts = std::clamp(
      std::ssize(record.force) / (std::ssize(record.reversals) + 1), kFewestParts, kMostParts);
  std::array sides = {Side(parts), Side(parts)};
  double squares = 0.0;
  double samples = 0.0;
  double carried = 0.0;  // Σ m·m of neighbouring strokes
  double steady = 0.0;   // and what it is if nothing changes
  for (const Stroke& stroke : MainStrokes(record, thresholds)) {
    const double from = excitation[stroke.begin];
    const double way = excitation[stroke.end] - from;
    Parts sums = Parts::Zero(parts);
    Parts counts = Parts::Zero(parts);
    double own_squares = 0.0;
    for (std::size_t i = stroke.begin; i <= stroke.end; ++i) {
      if (record.counts[i] == 0) continue;
      const double progress = std::clamp((excitation[i] - from) / way, 0.0, 1.0);
      const auto part =
          std::min(static_cast<Eigen::Index>(progress * static_cast<double>(parts)), parts - 1);
      sums[part] += residual[i];
      counts[part] += 1;
      own_squares += residual[i] * residual[i];
    }
    if (counts.sum() < 2) continue;  // left out, but for a reversal that it shares
    const std::size_t direction = stroke.direction > 0 ? 0 : 1;
    Side& side = sides[direction];
    const Parts means = sums / counts.max(1);
    side.strokes += (counts > 0).cast<double>();
    side.sums += means;
    side.squares += means.square();
    if (structure.strokes[direction]++ > 0) {
      carried += (means * side.last).sum();
      steady += (means.square() + side.last.square()).sum() / 2;
    }
    side.last = means;
    squares += own_squares;
    samples += counts.sum();
  }
  if (std::ranges::min(structure.strokes) > 2 && steady > 0) {
    structure.carried_over = carried / steady;
  }
  const std::optional<double> repeating = RepeatingSquare(sides, thresholds);
  if (!repeating) return structure;
  const double mean_square = squares / samples;
  structure.repeatable_share = std::clamp(*repeating / mean_square, 0.0, 1.0);
  double all_squares = 0.0;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (record.counts[i] != 0) all_squares += residual[i] * residual[i];
  }
  structure.noise_share =
      (1 - structure.repeatable_share) * mean_square * CountedSamplesOf(record) / all_squares;
  return structure;
}

Autocorrelation EstimateAutocorrelation(std::span<const ScaledRecord> records,
                                        std::span<const double> residual) {
  double samples = 0.0;
  for (const ScaledRecord& record : records) samples += CountedSamplesOf(record);
  const auto highest =
      std::min(kHighestOrder, static_cast<std::size_t>(samples) / kSamplesPerOrder);
  const Lags covariance = EstimateAutocovariances(records, residual, highest);
  Autocorrelation best;
  if (!(covariance[0] > 0)) return best;
  // The Levinson–Durbin recursion computes the coefficients of each order from the previous ones.
  std::vector<double> coefficients;
  double variance = covariance[0];
  double best_criterion = 0.0;  // of order 0, by how much others are better
  for (std::size_t order = 1; order <= highest; ++order) {
    double numerator = covariance[order];
    for (std::size_t k = 1; k < order; ++k) {
      numerator -= coefficients[k - 1] * covariance[order - k];
    }
    const double reflection = numerator / variance;
    const std::vector<double> last = coefficients;
    std::ranges::transform(
        last, last | std::views::reverse, coefficients.begin(),
        [&](double coefficient, double mirrored) { return coefficient - reflection * mirrored; });
    coefficients.push_back(reflection);
    variance *= 1 - reflection * reflection;
    if (!(variance > 0)) break;
    const double criterion = samples * std::log(variance / covariance[0]) +
                             static_cast<double>(order) * std::log(samples);
    if (!(criterion < best_criterion)) continue;
    best_criterion = criterion;
    best.coefficients = coefficients;
    best.innovation_share = variance / covariance[0];
  }
  // Yule and Walker's process has the correlations that it was made from, to its order.
  for (std::size_t lag = 1; lag <= best.coefficients.size(); ++lag) {
    best.correlations.push_back(covariance[lag] / covariance[0]);
  }
  return best;
}

double Autocorrelation::SquaredCorrelations() const {
  const std::vector<double> all = AllCorrelations(*this);
  return 2 * std::inner_product(all.begin(), all.end(), all.begin(), 0.0) - 1;
}

Eigen::MatrixXd Autocorrelation::Quadratic(const Eigen::Ref<const Eigen::MatrixXd>& columns) const {
  if (coefficients.empty() || columns.cols() == 0) return columns.transpose() * columns;
  // The columns filtered backwards by 1/φ until they have decayed: a column a sample, latest first.
  const Eigen::Index memory = std::ssize(AllCorrelations(*this));
  Eigen::MatrixXd filtered = Eigen::MatrixXd::Zero(columns.cols(), columns.rows() + memory);
  filtered.leftCols(columns.rows()) = columns.transpose().rowwise().reverse();
  for (Eigen::Index i = 1; i < filtered.cols(); ++i) {
    for (Eigen::Index k = 0; k < std::min(std::ssize(coefficients), i); ++k) {
      filtered.col(i) += coefficients[static_cast<std::size_t>(k)] * filtered.col(i - 1 - k);
    }
  }
  // Symmetric to the last bit.
  Eigen::MatrixXd square = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  square.selfadjointView<Eigen::Lower>().rankUpdate(filtered);
  square.triangularView<Eigen::StrictlyUpper>() = square.transpose();
  return innovation_share * square;
}

double Noise::effective_samples() const {
  const double independent = autocorrelation.SquaredCorrelations() * repeating;
  return std::max(static_cast<double>(samples) / independent, 1.0);
}

double Noise::degrees_of_freedom(std::size_t parameters) const {
  if (is_known) return 1e6;
  return std::max(effective_samples() - static_cast<double>(parameters), 1.0);
}

Eigen::MatrixXd Noise::Product(std::span<const ScaledRecord> records,
                               const Autocorrelation& process,
                               const Eigen::MatrixXd& jacobian) const {
  Eigen::MatrixXd product = Eigen::MatrixXd::Zero(jacobian.cols(), jacobian.cols());
  Eigen::MatrixXd of_force = jacobian;
  if (drawn.size() > 0) {
    const Eigen::MatrixXd moved = jacobian.transpose() * drawn;
    product =
        moved * moved.transpose() / (static_cast<double>(drawn.cols()) * (variance * repeating));
    of_force = force_share.asDiagonal() * jacobian;
  }
  for (std::size_t r = 0; r < records.size(); ++r) {
    const auto first = static_cast<Eigen::Index>(records[r].first);
    const double own = of_records.empty() ? 1.0 : of_records[r];
    product += own * process.Quadratic(of_force.middleRows(first, std::ssize(records[r].force)));
  }
  return product;
}

double EffectiveSamples(const ScaledRecords& data, std::span<const double> residual) {
  return static_cast<double>(data.counted) /
         EstimateAutocorrelation(data.records, residual).SquaredCorrelations();
}

double Evidence::LikelihoodRatio(double held, double free) const {
  return effective * std::log(Floored(held, samples) / Floored(free, samples));
}

double Evidence::Aicc(double sum_of_squares, std::size_t parameters) const {
  const auto n = static_cast<double>(samples);
  const auto k = static_cast<double>(parameters + 1);  // and the variance
  return effective * std::log(Floored(sum_of_squares, samples) / n) + 2 * k +
         2 * k * (k + 1) / std::max(n - k - 1, 1.0);
}

Evidence EvidenceOf(const Problem& problem, std::span<const double> theta) {
  Eigen::VectorXd residual = Response(problem).LinearizeAt(theta, {}).residual;
  const auto least = static_cast<double>(problem.parameters.free().size() + 1);
  return {problem.data->counted,
          std::max(EffectiveSamples(*problem.data, SpanOf(residual)), least)};
}

std::vector<double> VariancesOfRecords(const ScaledRecords& data,
                                       std::span<const double> residual) {
  std::vector<double> variances;
  double all = 0.0;
  for (const ScaledRecord& record : data.records) {
    const std::span<const double> own = record.Of(residual);
    const double squares =
        Eigen::Map<const Eigen::VectorXd>(own.data(), std::ssize(own)).squaredNorm();
    all += squares;
    variances.push_back(squares / CountedSamplesOf(record));
  }
  for (double& variance : variances) variance *= static_cast<double>(data.counted) / all;
  return variances;
}

}  // namespace mindahl::identification
