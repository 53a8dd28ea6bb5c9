#include "mindahl/identification/backbone_estimate.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory_resource>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "core/draws.h"
#include "identification/backbone_prior.h"
#include "identification/dense.h"
#include "identification/inference/noise.h"
#include "identification/problem/moved_samples.h"
#include "identification/solve/linear_columns.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/adequacy.h"
#include "mindahl/identification/terms.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"

namespace mindahl::identification {
namespace {

constexpr std::size_t kBackboneBins = 44;  // of the slip displacement
constexpr double kNarrowest = 1e-3;        // end of the first, of the largest displacement
constexpr double kCost = 1.0;              // 2 ln Λ that smoothness may take
constexpr std::size_t kDraws = 400;        // of noise, for the band
constexpr double kFirstPart = 0.01;        // of the largest displacement, over which it is stiff
constexpr double kPlateau = 0.02;          // of the first stiffness

/// Elements with slip displacements spread evenly from one to another, of a stiffness of 1 N/m.
struct Bin {
  double from = 0.0;
  double to = 0.0;

  /// Their force [N] at a displacement on the virgin curve.
  [[nodiscard]] double ForceAt(double x) const {
    if (x <= from) return x;
    if (x >= to) return (from + to) / 2;
    return x - (x - from) * (x - from) / (2 * (to - from));
  }
};

/// Bins, and at the end what never slips.
struct Grid {
  std::vector<Bin> bins;

  [[nodiscard]] std::size_t size() const { return bins.size() + 1; }
  [[nodiscard]] double largest() const { return bins.back().to; }
  void ForcesAt(double x, std::span<double> forces) const {
    for (std::size_t k = 0; k < bins.size(); ++k) forces[k] = bins[k].ForceAt(x);
    forces.back() = x;
  }
};

Grid MakeGrid(double largest) {
  Grid grid;
  double from = 0.0;
  for (std::size_t k = 0; k < kBackboneBins; ++k) {
    const double share = static_cast<double>(k) / static_cast<double>(kBackboneBins - 1);
    const double to = largest * std::pow(kNarrowest, 1 - share);
    grid.bins.push_back({from, to});
    from = to;
  }
  return grid;
}

/// Holds a record and the path of its contact.
struct Followed {
  std::vector<double> displacement;  // [m]
  std::vector<double> force;         // [N] of the contact, with the displacement's sign
  std::vector<unsigned char> counts;
  std::vector<std::size_t> reversals;
  models::LoadingPath path;
  double half_range = 0.0;
};

double ScaleOf(const models::Branch& branch) { return models::IsVirgin(branch.start) ? 1.0 : 2.0; }

double ValueOf(const FitResult& fit, const std::string& name, std::size_t record) {
  const std::string numbered =
      fit.records.size() > 1 ? name + "_" + std::to_string(record + 1) : name;
  const ParameterEstimate* const estimate = fit.Find(numbered);
  return estimate != nullptr ? estimate->value : 0.0;
}

/// Returns the record less all terms besides the contact's force, but its offset.
Followed Follow(const loop::PreparedRecord& prepared, const FitResult& fit, std::size_t r) {
  Followed followed;
  followed.displacement.assign(prepared.displacement().begin(), prepared.displacement().end());
  followed.counts.assign(prepared.counts.begin(), prepared.counts.end());
  followed.reversals.assign(prepared.reversals.begin(), prepared.reversals.end());
  const auto [low, high] = std::ranges::minmax(followed.displacement);
  followed.half_range = (high - low) / 2;
  const models::InitialState state = fit.records[r].initial_state;
  const bool is_virgin = state == models::InitialState::kVirgin;
  const double unloaded = is_virgin ? ValueOf(fit, "displacement_offset", r) : 0.0;
  followed.path = models::MakeLoadingPath(followed.displacement, prepared.reversals,
                                          models::Memory::kReturnPoint,
                                          {.state = state, .unloaded_displacement = unloaded});
  std::vector<double> contact(followed.displacement.size());
  models::EvaluateForce(*fit.model, fit.law, followed.path, followed.displacement, contact,
                        fit.rig);
  const RecordFit& record = fit.records[r];
  for (std::size_t i = 0; i < contact.size(); ++i) {
    // Fitted − measured is the same of the whole force and of the contact's.
    followed.force.push_back(contact[i] - fit.force_sense * record.residual[i]);
  }
  return followed;
}

double LargestDisplacement(const Followed& record) {
  double largest = 0.0;
  for (const models::BranchRun& run : record.path.runs) {
    const models::Branch& branch = record.path.branches[static_cast<std::size_t>(run.branch)];
    for (std::size_t i = run.begin; i < run.end; ++i) {
      largest =
          std::max(largest, std::abs(record.displacement[i] - branch.origin) / ScaleOf(branch));
    }
  }
  return largest;
}

/// Returns a row per sample that counts: the force of each bin along the record's branches.
Eigen::MatrixXd ColumnsOf(const Followed& record, const Grid& grid) {
  const auto count = static_cast<Eigen::Index>(grid.size());
  std::vector<double> forces(grid.size());
  const Eigen::Map<const Eigen::VectorXd> at(forces.data(), count);
  const auto add = [&](const models::Branch& branch, double displacement,
                       Eigen::Ref<Eigen::VectorXd> to) {
    const double way = displacement - branch.origin;
    const double scale = ScaleOf(branch);
    const double direction = models::IsVirgin(branch.start) ? std::copysign(1.0, way)
                                                            : static_cast<double>(branch.direction);
    grid.ForcesAt(std::abs(way) / scale, forces);
    to += direction * scale * at;
  };
  const auto& branches = record.path.branches;
  Eigen::MatrixXd starts = Eigen::MatrixXd::Zero(count, static_cast<Eigen::Index>(branches.size()));
  for (std::size_t b = 0; b < branches.size(); ++b) {
    auto start = starts.col(static_cast<Eigen::Index>(b));
    if (branches[b].start == models::BranchStart::kSteadyExtreme) {
      grid.ForcesAt(record.half_range, forces);
      start = -static_cast<double>(branches[b].direction) * at;
    } else if (branches[b].parent >= 0) {
      const auto parent = static_cast<std::size_t>(branches[b].parent);
      start = starts.col(static_cast<Eigen::Index>(parent));
      add(branches[parent], branches[b].origin, start);
    }
  }
  Eigen::MatrixXd columns(count, static_cast<Eigen::Index>(record.displacement.size()));
  for (const models::BranchRun& run : record.path.runs) {
    const auto b = static_cast<std::size_t>(run.branch);
    for (std::size_t i = run.begin; i < run.end; ++i) {
      auto column = columns.col(static_cast<Eigen::Index>(i));
      column = starts.col(static_cast<Eigen::Index>(b));
      add(branches[b], record.displacement[i], column);
      if (record.counts[i] == 0) column.setZero();
    }
  }
  return columns.transpose();
}

/// Takes off a column its mean over what counts.
void Center(const std::vector<unsigned char>& counts, Eigen::Ref<Eigen::VectorXd> column) {
  double sum = 0.0;
  double count = 0.0;
  for (Eigen::Index i = 0; i < column.size(); ++i) {
    if (counts[static_cast<std::size_t>(i)] == 0) continue;
    sum += column[i];
    ++count;
  }
  for (Eigen::Index i = 0; i < column.size(); ++i) {
    column[i] = counts[static_cast<std::size_t>(i)] == 0 ? 0.0 : column[i] - sum / count;
  }
}

/// Least squares in the stiffness of every bin, in units of the data.
struct BackboneSeries {
  std::vector<Eigen::MatrixXd> columns;  // of each record
  std::vector<Eigen::VectorXd> force;
  Eigen::MatrixXd product;  // AᵀA
  Eigen::VectorXd right;    // Aᵀy
  double samples = 0.0;

  [[nodiscard]] Eigen::VectorXd Residual(std::size_t r, const Eigen::VectorXd& w) const {
    return force[r] - columns[r] * w;
  }
  [[nodiscard]] double SumOfSquares(const Eigen::VectorXd& w) const {
    double sum = 0.0;
    for (std::size_t r = 0; r < columns.size(); ++r) sum += Residual(r, w).squaredNorm();
    return sum;
  }
};

/// Second differences of the slip force over the logarithm of the slip
/// displacement; there is none below the first bin.
Eigen::MatrixXd SecondDifferences(const Grid& grid) {
  const auto bins = static_cast<Eigen::Index>(grid.bins.size());
  const auto count = static_cast<Eigen::Index>(grid.size());
  Eigen::MatrixXd differences = Eigen::MatrixXd::Zero(bins, count);
  constexpr std::array<double, 3> kSecond = {1.0, -2.0, 1.0};
  for (Eigen::Index k = 0; k < bins; ++k) {
    for (Eigen::Index j = 0; j < 3; ++j) {
      const Eigen::Index at = k - 2 + j;
      if (at < 0) continue;
      const Bin& bin = grid.bins[static_cast<std::size_t>(at)];
      differences(k, at) +=
          kSecond[static_cast<std::size_t>(j)] * (bin.from + bin.to) / 2 / grid.largest();
    }
  }
  return differences;
}

Autocorrelation BackboneAutocorrelation(const BackboneSeries& series,
                                        std::span<const Followed> records,
                                        const Eigen::VectorXd& w) {
  std::vector<Eigen::VectorXd> residuals;
  residuals.reserve(records.size());
  std::vector<std::span<const double>> spans;
  std::vector<std::span<const unsigned char>> counts;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Eigen::VectorXd& residual = residuals.emplace_back(series.Residual(r, w));
    spans.emplace_back(residual.data(), records[r].counts.size());
    counts.emplace_back(records[r].counts);
  }
  return EstimateAutocorrelation(spans, counts);
}

/// Returns the variance inflation by the residuals that repeat in every stroke.
double Widening(const BackboneSeries& series, std::span<const Followed> records,
                const Eigen::VectorXd& w, const Thresholds& thresholds) {
  double widening = 1.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const Eigen::VectorXd residual = series.Residual(r, w);
    const ResidualStructure structure =
        DescribeStructure(records[r].displacement, records[r].reversals,
                          {residual.data(), records[r].displacement.size()}, records[r].counts,
                          {thresholds.main_stroke, thresholds.repeat_chance});
    widening = std::max(widening, structure.Widening());
  }
  return widening;
}

/// Columns and forces over the offset of each record, where it has one.
BackboneSeries Assemble(std::span<const Followed> records, const Grid& grid, double force_unit,
                        bool offsets) {
  const auto count = static_cast<Eigen::Index>(grid.size());
  BackboneSeries series;
  series.product = Eigen::MatrixXd::Zero(count, count);
  series.right = Eigen::VectorXd::Zero(count);
  for (const Followed& record : records) {
    Eigen::MatrixXd columns = ColumnsOf(record, grid) / grid.largest();
    Eigen::VectorXd force(static_cast<Eigen::Index>(record.force.size()));
    for (Eigen::Index i = 0; i < force.size(); ++i) {
      const auto sample = static_cast<std::size_t>(i);
      force[i] = record.counts[sample] == 0 ? 0.0 : record.force[sample] / force_unit;
    }
    if (offsets) {
      for (Eigen::Index c = 0; c < count; ++c) Center(record.counts, columns.col(c));
      Center(record.counts, force);
    }
    series.product += TransposedProduct(columns, columns);
    series.right += columns.transpose() * force;
    series.samples += static_cast<double>(std::ranges::count(record.counts, 1));
    series.columns.push_back(std::move(columns));
    series.force.push_back(std::move(force));
  }
  return series;
}

/// The smoothest stiffnesses that the record allows.
struct Smoothest {
  double smoothing = 0.0;
  double weight = 0.0;     // of the roughness
  Eigen::MatrixXd system;  // AᵀA + weight·DᵀD
  Eigen::VectorXd w;
};

Smoothest FindSmoothest(const BackboneSeries& series, std::span<const Followed> records,
                        const Eigen::MatrixXd& differences) {
  constexpr double kFree = 1e-12;  // as free as rounding allows
  constexpr double kStiff = 1e6;
  constexpr int kHalvings = 30;               // to 4e-8 of the logarithm
  constexpr double kRoundingSquares = 1e-24;  // a sample, of a record without noise
  const Eigen::MatrixXd roughness = TransposedProduct(differences, differences);
  const double unit = series.product.trace() / roughness.trace();
  const auto solve = [&](double smoothing) {
    Smoothest at{.smoothing = smoothing,
                 .weight = smoothing * unit,
                 .system = series.product + smoothing * unit * roughness,
                 .w = {}};
    at.w = SolveNonnegative(at.system, series.right);
    return at;
  };
  const Smoothest free = solve(kFree);
  const double least = std::max(series.SumOfSquares(free.w), series.samples * kRoundingSquares);
  const double effective =
      series.samples / BackboneAutocorrelation(series, records, free.w).SquaredCorrelations();
  double low = std::log(kFree);
  double high = std::log(kStiff);
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (low + high) / 2;
    const double squares = series.SumOfSquares(solve(std::exp(middle)).w);
    (effective * std::log(squares / least) <= kCost ? low : high) = middle;
  }
  return solve(std::exp(low));
}

/// The noise as the columns see it: Aᵀe has the covariance variance·AᵀRA = root·rootᵀ.
struct SeenNoise {
  double variance = 0.0;
  double effective_samples = 0.0;
  Eigen::MatrixXd root;
};

SeenNoise NoiseAboutBackbone(const BackboneSeries& series, std::span<const Followed> records,
                             const Smoothest& smoothest, std::optional<double> known,
                             const Thresholds& thresholds) {
  const Autocorrelation autocorrelation = BackboneAutocorrelation(series, records, smoothest.w);
  const auto count = smoothest.w.size();
  Eigen::MatrixXd correlated = Eigen::MatrixXd::Zero(count, count);
  for (const Eigen::MatrixXd& columns : series.columns) {
    correlated += autocorrelation.Quadratic(columns);
  }
  const double absorbed =
      std::min(SolveSymmetric(smoothest.system, correlated).trace(), series.samples / 2);
  SeenNoise noise;
  noise.effective_samples = series.samples / autocorrelation.SquaredCorrelations();
  noise.variance =
      known ? *known * *known : series.SumOfSquares(smoothest.w) / (series.samples - absorbed);
  const double widened = noise.variance * Widening(series, records, smoothest.w, thresholds);
  const Eigenpairs axes = SymmetricEigenpairs(correlated);
  noise.root = axes.vectors * (widened * axes.values.array().max(0.0)).sqrt().matrix().asDiagonal();
  return noise;
}

/// Returns how far drawn stiffnesses are from the found ones, a column a draw. The smoothness is a
/// prior of second differences whose variance is that of the noise over its weight.
Eigen::MatrixXd Draw(const BackboneSeries& series, const Smoothest& smoothest,
                     const SeenNoise& noise, const Eigen::MatrixXd& differences) {
  const double prior =
      DeviationOfPrior(noise.variance, series.samples, noise.effective_samples, smoothest.weight);
  Eigen::MatrixXd off(smoothest.w.size(), static_cast<Eigen::Index>(kDraws));
  Draws draws(1);
  const auto draw = [&](Eigen::Index size) {
    Eigen::VectorXd numbers(size);
    for (double& number : numbers) number = draws.Normal();
    return numbers;
  };
  const Eigen::VectorXd expected = smoothest.system * smoothest.w;
  for (Eigen::Index d = 0; d < off.cols(); ++d) {
    const Eigen::VectorXd right = expected + noise.root * draw(noise.root.cols()) +
                                  prior * (differences.transpose() * draw(differences.rows()));
    off.col(d) = SolveNonnegative(smoothest.system, right, smoothest.w) - smoothest.w;
  }
  return off;
}

/// Draws are cut where weights would turn negative, on either side: the wider one holds for both.
/// @param off  of a quantity, from its value
BandValue BandOf(double value, Eigen::VectorXd off, double unit, double confidence) {
  std::ranges::sort(off);
  const auto at = [&](double share) {
    return std::abs(
        off[static_cast<Eigen::Index>(std::lround(share * static_cast<double>(off.size() - 1)))]);
  };
  const double half = std::max(at((1 - confidence) / 2), at((1 + confidence) / 2));
  return {unit * value, unit * std::max(0.0, value - half), unit * (value + half)};
}

}  // namespace

bool HasBackbone(const FitResult& fit) {
  const bool is_of_one_load =
      !fit.is_load_series() &&
      std::ranges::none_of(fit.records, [](const RecordFit& record) { return record.load_varies; });
  const bool is_of_one_curve =
      std::ranges::none_of(fit.parameters, [](const ParameterEstimate& estimate) {
        const Term* const term = FindTerm(TermNameOf(estimate.name));
        return ContactMotionOf(*term) != ContactMotion::kMeasured || term->name == "asymmetry";
      });
  return !fit.parameters.empty() && is_of_one_load && is_of_one_curve &&
         fit.model->memory == models::Memory::kReturnPoint && fit.response == loop::Channel::kForce;
}

BackboneEstimate EstimateBackbone(std::span<const loop::RecordView> records,
                                  const FitOptions& options, const FitResult& fit) {
  if (!HasBackbone(fit)) {
    throw InvalidArgument(
        "the backbone needs a Masing law, fitted to the force of records under one load, without a "
        "lag or an asymmetry");
  }
  std::pmr::monotonic_buffer_resource memory;
  const loop::PreparedRecords prepared = loop::Prepare(records, options.preparation, &memory);
  std::vector<Followed> followed;
  double largest = 0.0;
  double force_unit = 0.0;
  for (std::size_t r = 0; r < prepared.records.size(); ++r) {
    followed.push_back(Follow(prepared.records[r], fit, r));
    largest = std::max(largest, LargestDisplacement(followed.back()));
    const auto [low, high] = std::ranges::minmax(followed.back().force);
    force_unit = std::max(force_unit, (high - low) / 2);
  }
  const Grid grid = MakeGrid(largest);
  const double stiffness_unit = force_unit / largest;
  const BackboneSeries series = Assemble(followed, grid, force_unit, options.offsets);
  const Eigen::MatrixXd differences = SecondDifferences(grid);
  const Smoothest smoothest = FindSmoothest(series, followed, differences);
  std::optional<double> known;
  if (options.force_noise) known = *options.force_noise / force_unit;
  const SeenNoise noise =
      NoiseAboutBackbone(series, followed, smoothest, known, options.thresholds);
  const Eigen::MatrixXd drawn = Draw(series, smoothest, noise, differences);

  BackboneEstimate estimate;
  estimate.smoothing = smoothest.smoothing;
  estimate.effective_samples = noise.effective_samples;
  estimate.rms = force_unit * std::sqrt(series.SumOfSquares(smoothest.w) / series.samples);
  const auto band = [&](const Eigen::VectorXd& of_stiffnesses, double unit) {
    return BandOf(of_stiffnesses.dot(smoothest.w), drawn.transpose() * of_stiffnesses, unit,
                  options.confidence);
  };
  Eigen::VectorXd forces(smoothest.w.size());
  const auto force_at = [&](double displacement) -> Eigen::VectorXd {
    grid.ForcesAt(displacement, {forces.data(), grid.size()});
    return forces / largest;
  };
  std::vector<double> displacements = {0.0};
  for (const Bin& bin : grid.bins) displacements.push_back(bin.to);
  std::vector<double> law(displacements.size());
  const models::LoadingPath virgin =
      models::MakeLoadingPath(displacements, {}, models::Memory::kReturnPoint, {});
  models::EvaluateForce(*fit.model, fit.law, virgin, displacements, law, fit.rig);
  for (std::size_t i = 0; i < displacements.size(); ++i) {
    estimate.points.push_back({.displacement = displacements[i],
                               .force = band(force_at(displacements[i]), force_unit),
                               .law = law[i]});
  }
  for (std::size_t k = 0; k < grid.bins.size(); ++k) {
    estimate.elements.push_back({grid.bins[k].from, grid.bins[k].to,
                                 stiffness_unit * smoothest.w[static_cast<Eigen::Index>(k)]});
  }
  estimate.first_stiffness = band(force_at(kFirstPart * largest) / kFirstPart, stiffness_unit);
  estimate.elastic =
      band(Eigen::VectorXd::Unit(smoothest.w.size(), smoothest.w.size() - 1), stiffness_unit);
  estimate.reaches_plateau = estimate.elastic.upper95 < kPlateau * estimate.first_stiffness.value;
  return estimate;
}

}  // namespace mindahl::identification
