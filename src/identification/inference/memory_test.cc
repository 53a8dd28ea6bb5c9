#include "identification/inference/memory_test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "identification/dense.h"
#include "identification/inference/branch_places.h"
#include "identification/inference/column_test.h"
#include "identification/solve/turning_points.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

namespace {

constexpr std::size_t kMostShapes = 10;
constexpr std::size_t kMostWaves = 4;
constexpr std::size_t kFewestShapes = 3;
/// Reversals whose forces lie closer [of the largest] are as good as at one force.
constexpr double kOneForce = 0.05;
/// Least length of a branch after an inner loop, as a fraction of the widest stroke.
constexpr double kShortWay = 0.05;
/// Least length of the virgin branch, as a fraction of the widest one.
constexpr double kSeenWay = 0.25;
/// Length over which the slope after a reversal is measured, of the widest stroke.
constexpr double kEarly = 0.1;

/// A sample on its branch, or the origin of a branch on the one before (OnBranch).
struct BranchPlace {
  double displacement = 0.0;
  double response = 0.0;
  double slope = 0.0;
  double gain = 1.0;
  double direction = 1.0;
  bool sets_out = false;
  bool virgin = false;
  double reach = 1.0;
  double origin = 0.0;
  double origin_response = 0.0;
  // Cosines of half turns, of which waves are Chebyshev polynomials: along the branch, and of what
  // the law's shape depends on, here and where the branch starts.
  double along = 1.0;
  double here = 1.0;
  double before = 1.0;
};

/// Holds the scales of displacement and force over all records.
struct Extent {
  double stroke = 0.0;  // the widest way between reversals
  double force = 0.0;   // the largest response
};

double Way(const BranchPlace& at) { return std::abs(at.displacement - at.origin); }

/// Travel on the branch over that of the widest, whose virgin branch has half a stroke's travel.
double ShareOfStroke(const BranchPlace& at, const Extent& extent) {
  return Way(at) * (at.virgin ? 2 : 1) / extent.stroke;
}

/// Returns the scale of a branch of Masing's law against the virgin one.
double MasingScaleOf(const BranchPlace& at) { return at.virgin ? 1.0 : 2.0; }

/// Force at its start against the direction of the branch, over Tc: T*/Tc of a steady loop.
double HeightOf(const BranchPlace& at) {
  return at.virgin ? 0.0 : -at.direction * at.origin_response;
}

double CosineOfHalfTurns(double share) {
  return std::cos(std::numbers::pi * std::clamp(share, 0.0, 1.0));
}

/// Sets the cosines of a place that is put on its branch.
void SetCosines(models::Memory memory, const Extent& extent, BranchPlace& at) {
  const double share = ShareOfStroke(at, extent);
  at.along = CosineOfHalfTurns(share);
  if (memory == models::Memory::kReturnPoint) {
    // Densest where branches begin.
    at.here = CosineOfHalfTurns(std::sqrt(share));
    return;
  }
  const auto cosine = [&](double response) {
    return CosineOfHalfTurns((1 + at.direction * response / extent.force) / 2);
  };
  at.here = cosine(at.response);
  at.before = cosine(at.origin_response);
}

/// cos(number·φ) of cos φ: Chebyshev's polynomial.
double Wave(std::size_t number, double cosine) {
  double before = 1.0;
  double wave = number == 0 ? 1.0 : cosine;
  for (std::size_t k = 1; k < number; ++k) {
    before = std::exchange(wave, 2 * cosine * wave - before);
  }
  return wave;
}

/// A change of the backbone, F + εB, added up along branches: s·m·B(way/m), m = 1 or 2. B is a
/// cosine of the root of the way.
double ChangeOfBackbone(std::size_t number, const BranchPlace& at) {
  return at.direction * MasingScaleOf(at) * (Wave(number, at.here) - 1.0);
}

/// A change of the curve dT/dδ = g(sT) by B(sT), of which a branch has what lies between its
/// start and here; what it was at the start is carried on by the gain.
double ChangeOfCurve(std::size_t number, const BranchPlace& at) {
  return at.direction * (Wave(number, at.here) - at.gain * Wave(number, at.before));
}

std::vector<BranchPlace> BranchPlacesOf(const ScaledRecord& record,
                                        std::span<const double> response,
                                        const models::OriginSensitivity& sensitivity) {
  std::vector<BranchPlace> places(record.size());
  for (std::size_t i = 0; i < record.size(); ++i) {
    places[i].displacement = record.displacement[i];
    places[i].response = response[i];
    places[i].slope = sensitivity.sample_slope[i];
    places[i].gain = sensitivity.sample_gain[i];
  }
  return places;
}

/// Way since an inner loop was closed, of the samples that go on as before it; −1 of all others.
std::vector<double> WaySinceReturn(const ScaledRecord& record, models::InitialState state,
                                   double stroke) {
  std::vector<double> way(record.size(), -1.0);
  const models::LoadingPath path = models::MakeLoadingPath(
      record.displacement, record.reversals, models::Memory::kReturnPoint,
      {.state = state, .unloaded_displacement = record.displacement.front()});
  for (std::size_t k = 1; k < path.runs.size(); ++k) {
    const models::BranchRun& run = path.runs[k];
    if (run.branch >= path.runs[k - 1].branch) continue;
    const double from = record.displacement[run.begin];
    if (std::abs(record.displacement[run.end - 1] - from) < kShortWay * stroke) continue;
    for (std::size_t i = run.begin; i < run.end; ++i) {
      way[i] = std::abs(record.displacement[i] - from);
    }
  }
  return way;
}

/// All samples of all records on the branches of a law.
struct Samples {
  std::vector<BranchPlace> places;
  std::vector<double> way_since_return;
  Extent extent;
};

/// Mean and range of what some places have.
struct Spread {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
  double sum = 0.0;
  double count = 0.0;

  void Add(double value) {
    lowest = std::min(lowest, value);
    highest = std::max(highest, value);
    sum += value;
    ++count;
  }
  [[nodiscard]] double mean() const { return count > 0 ? sum / count : 0.0; }
  [[nodiscard]] double range() const { return count > 0 ? highest - lowest : 0.0; }
};

/// @param rate  σ/Tc in units of the data
void AddDifferences(const Samples& samples, std::size_t waves, double rate, MemoryColumns& result) {
  const Extent& extent = samples.extent;
  Spread virgin;
  Spread after_reversal;
  Spread directions;
  for (const BranchPlace& at : samples.places) {
    if (at.virgin) virgin.Add(ShareOfStroke(at, extent));
    directions.Add(at.direction);
    if (!at.virgin) after_reversal.Add(HeightOf(at));
  }
  const bool has_virgin = virgin.range() > kSeenWay;
  const bool has_heights = after_reversal.range() > kOneForce * extent.force;
  std::vector<double> values;
  const auto add = [&](std::string_view code, const auto& value) {
    for (std::size_t i = 0; i < samples.places.size(); ++i) {
      values.push_back(value(samples.places[i], samples.way_since_return[i]));
    }
    result.of.push_back(code);
    if (result.compared.empty() || result.compared.back() != code) result.compared.push_back(code);
  };
  const auto add_waves = [&](std::string_view code, const auto& size) {
    for (std::size_t k = 0; k < waves; ++k) {
      add(code, [&](const BranchPlace& at, double) { return size(at) * Wave(k, at.along); });
    }
  };
  if (has_virgin) {
    add_waves(kVirginBranch, [](const BranchPlace& at) { return at.virgin ? at.direction : 0.0; });
  }
  if (directions.range() > 0) {
    add_waves(kDirections, [](const BranchPlace&) { return 1.0; });
  }
  if (has_heights) {
    add_waves(kAmplitudes, [&](const BranchPlace& at) {
      return at.virgin ? 0.0 : at.direction * (HeightOf(at) - after_reversal.mean());
    });
  }
  const auto early = [&](double way) { return std::exp(-way / (kEarly * extent.stroke)); };
  if (has_virgin || has_heights) {
    add(kSlopeAtReversal, [&](const BranchPlace& at, double) {
      return at.direction * HeightOf(at) * rate * Way(at) * early(Way(at));
    });
  }
  if (std::ranges::any_of(samples.way_since_return, [](double way) { return way >= 0; })) {
    add(kReturnPoint,
        [](const BranchPlace& at, double way) { return way >= 0 ? at.direction : 0.0; });
    add(kReturnPoint, [&](const BranchPlace& at, double way) {
      return way >= 0 ? at.direction * early(way) : 0.0;
    });
  }
  result.differences = Eigen::Map<const Eigen::MatrixXd>(values.data(), std::ssize(samples.places),
                                                         std::ssize(result.of));
}

double WidestStroke(const ScaledRecords& data) {
  double widest = 0.0;
  for (const ScaledRecord& record : data.records) {
    const auto [lowest, highest] = std::ranges::minmax(record.displacement);
    widest = std::max(widest, highest - lowest);
  }
  return widest;
}

}  // namespace

std::vector<std::string_view> MemoryComparisonCodes() {
  return {kVirginBranch, kDirections, kAmplitudes, kSlopeAtReversal, kReturnPoint, kOtherLaw};
}

MemoryResolution ResolutionOf(const Problem& problem) {
  const std::size_t free = problem.parameters.free().size();
  const std::size_t counted = problem.data->counted;
  const std::size_t most = counted > free ? (counted - free) / kSamplesAColumn : 0;
  for (const std::size_t waves : {kMostWaves, kMostWaves / 2}) {
    // Three comparisons along a branch, one of slopes, two columns after inner loops.
    const std::size_t differences = 3 * waves + 3;
    if (most < differences + kFewestShapes) continue;
    return {.shapes = std::min(most - differences, kMostShapes), .waves = waves};
  }
  return {};
}

MemoryColumns ColumnsOfMemory(const Problem& problem, std::span<const double> theta,
                              Response& response, const MemoryResolution& resolution,
                              const Eigen::VectorXd& other) {
  const LawPoint point = PointAt(problem, theta);
  const std::pmr::vector<ScaledRecord>& records = problem.data->records;
  const auto rows = static_cast<Eigen::Index>(problem.size());
  std::vector<double> force(problem.size());
  response.Bind(problem);
  response.Evaluate(point, force);
  Samples samples;
  samples.extent.stroke = WidestStroke(*problem.data);
  for (const double value : force) {
    samples.extent.force = std::max(samples.extent.force, std::abs(value));
  }
  const Extent& extent = samples.extent;

  MemoryColumns result;
  result.shape.resize(rows, static_cast<Eigen::Index>(resolution.shapes));
  const models::Memory memory = problem.model->memory;
  const auto change = memory == models::Memory::kReturnPoint ? ChangeOfBackbone : ChangeOfCurve;
  std::size_t begin = 0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const ScaledRecord& record = records[r];
    models::OriginSensitivity sensitivity;
    response.DifferentiateByOrigins(point, r, sensitivity);
    std::vector<BranchPlace> places =
        BranchPlacesOf(record, std::span(force).subspan(begin, record.size()), sensitivity);
    const models::LoadingPath& path = response.PathOf(r, theta);
    BranchPlace extreme;
    if (problem.state.Of(r) == models::InitialState::kSteady) {
      extreme = SteadyExtreme<BranchPlace>(problem, point, record);
    }
    std::vector<BranchPlace> origins =
        FollowBranches(*problem.model, path, sensitivity, std::span(places));
    SetCosines(memory, extent, extreme);
    for (BranchPlace& origin : origins) SetCosines(memory, extent, origin);
    for (BranchPlace& place : places) SetCosines(memory, extent, place);
    for (std::size_t j = 0; j < resolution.shapes; ++j) {
      const auto value = [&](const BranchPlace& at) { return change(j + 1, at); };
      FillAlongBranches(
          value, path, extreme, std::span<const BranchPlace>(places),
          std::span<const BranchPlace>(origins),
          {result.shape.col(static_cast<Eigen::Index>(j)).data() + begin, record.size()});
    }
    const std::vector<double> since = WaySinceReturn(record, problem.state.Of(r), extent.stroke);
    samples.places.insert(samples.places.end(), places.begin(), places.end());
    samples.way_since_return.insert(samples.way_since_return.end(), since.begin(), since.end());
    begin += record.size();
  }
  AddDifferences(samples, resolution.waves, std::exp(point.log_rate), result);

  Eigen::VectorXd weight(rows);
  Eigen::Index row = 0;
  for (const ScaledRecord& record : records) {
    for (const double root : record.root_weight) weight[row++] = root;
  }
  result.shape = weight.asDiagonal() * result.shape;
  result.differences = weight.asDiagonal() * result.differences;
  if (other.size() > 0) {
    result.differences.conservativeResize(Eigen::NoChange, result.differences.cols() + 1);
    result.differences.rightCols(1) = other;
    result.of.push_back(kOtherLaw);
    result.compared.push_back(kOtherLaw);
  }
  if (problem.data->turns_are_fitted) {
    const TurningPointColumns turning(problem, theta, response);
    for (Eigen::MatrixXd* columns : {&result.shape, &result.differences}) {
      for (Eigen::Index c = 0; c < columns->cols(); ++c) turning.ProjectOut(columns->col(c));
    }
  }
  return result;
}

namespace {

/// An orthonormal basis of the law's columns and of its other shapes; these are nearly those of the
/// law, and products of what they have in common would be of rounding errors.
Eigen::MatrixXd BasisOf(const Eigen::MatrixXd& law, const Eigen::MatrixXd& shape) {
  constexpr double kOwn = 1e-6;  // of a column, orthogonal to those before it
  Eigen::MatrixXd columns(law.rows(), law.cols() + shape.cols());
  columns << law, shape;
  for (auto column : columns.colwise()) {
    const double norm = column.norm();
    if (!(norm > 0) || !std::isfinite(norm)) {
      column.setZero();
    } else {
      column /= norm;
    }
  }
  return OrthonormalBasis(columns, kOwn);
}

/// Holds the comparisons under one memory.
struct Answer {
  double p_value = 1.0;
  std::vector<MemoryComparison> comparisons;
};

/// A law's memory, its shape let free, before the comparisons.
class MemoryTrial {
 public:
  /// @param other  null where the two laws are one curve
  MemoryTrial(const FittedLaw& law, const FittedLaw* other, const MemoryResolution& resolution,
              const Noise& noise, const DisplacementEffect& displacement, Response& response)
      : law_(law),
        noise_(noise),
        displacement_(displacement),
        columns_(ColumnsOfMemory(*law.problem, law.solution->theta, response, resolution,
                                 other != nullptr
                                     ? Eigen::VectorXd(other->at.residual - law.at.residual)
                                     : Eigen::VectorXd())),
        basis_(BasisOf(law.at.jacobian, columns_.shape)),
        test_(Test(nullptr)) {}

  /// Tests with its own noise, or with that of the other law where that is less.
  [[nodiscard]] Answer Ask(const MemoryTrial* other) const {
    return other != nullptr && other->test_.variance() < test_.variance()
               ? AskOf(Test(&other->test_))
               : AskOf(test_);
  }

 private:
  [[nodiscard]] ColumnTest Test(const ColumnTest* quieter) const {
    return {*law_.problem,        noise_,           displacement_, basis_,
            columns_.differences, law_.at.residual, quieter};
  }

  [[nodiscard]] std::vector<Eigen::Index> PlacesOf(std::string_view code) const {
    std::vector<Eigen::Index> places;
    for (std::size_t c = 0; c < columns_.of.size(); ++c) {
      if (columns_.of[c] == code) places.push_back(static_cast<Eigen::Index>(c));
    }
    return places;
  }

  [[nodiscard]] Answer AskOf(const ColumnTest& test) const {
    Answer answer;
    if (!test.can_tell()) return answer;
    const ScaledRecords& data = *law_.problem->data;
    // A law that leaves nothing but rounding errors describes the record, whatever their form.
    const bool only_rounding =
        law_.at.residual.norm() < kOnlyRounding * std::sqrt(static_cast<double>(data.counted));
    if (!only_rounding) answer.p_value = test.p_value();
    for (const std::string_view code : columns_.compared) {
      const std::vector<Eigen::Index> places = PlacesOf(code);
      const ColumnTest::Part part = test.Ask(places);
      if (part.columns == 0) continue;
      answer.comparisons.push_back({.code = code,
                                    .p_value = only_rounding ? 1.0 : part.p_value,
                                    .size = only_rounding ? 0.0 : part.rms * data.force});
    }
    return answer;
  }

  const FittedLaw& law_;
  const Noise& noise_;
  const DisplacementEffect& displacement_;
  MemoryColumns columns_;
  Eigen::MatrixXd basis_;
  ColumnTest test_;
};

}  // namespace

bool CanCompareBranches(const Problem& problem) {
  return !problem.data->is_forced() && !problem.data->load_varies &&
         !problem.parameters.moves_contact() && !problem.parameters.is_load_series();
}

MemoryVerdict VerdictOf(double p_value, double dahl_p_value, const Thresholds& thresholds) {
  const bool is_not_masing = p_value < thresholds.memory_chance;
  const bool is_not_dahl = dahl_p_value < thresholds.memory_chance;
  if (is_not_masing) return is_not_dahl ? MemoryVerdict::kNeither : MemoryVerdict::kDahl;
  return is_not_dahl ? MemoryVerdict::kMasing : MemoryVerdict::kUndecided;
}

MemoryTest TestMemory(const FittedLaw& masing, const FittedLaw* dahl, const Noise& noise,
                      const DisplacementEffect& displacement, const Thresholds& thresholds,
                      Response& response) {
  MemoryTest test;
  const MemoryResolution resolution = ResolutionOf(*masing.problem);
  if (resolution.waves == 0) return test;
  const MemoryTrial of_masing(masing, dahl, resolution, noise, displacement, response);
  std::optional<MemoryTrial> of_dahl;
  if (dahl != nullptr) of_dahl.emplace(*dahl, &masing, resolution, noise, displacement, response);
  const Answer by_masing = of_masing.Ask(of_dahl ? &*of_dahl : nullptr);
  const Answer by_dahl = of_dahl ? of_dahl->Ask(&of_masing) : by_masing;
  test.p_value = by_masing.p_value;
  test.dahl_p_value = by_dahl.p_value;
  test.comparisons = by_masing.comparisons;
  for (MemoryComparison& comparison : test.comparisons) {
    const auto same =
        std::ranges::find(by_dahl.comparisons, comparison.code, &MemoryComparison::code);
    comparison.dahl_p_value = same == by_dahl.comparisons.end() ? 1.0 : same->p_value;
  }
  test.verdict = VerdictOf(test.p_value, test.dahl_p_value, thresholds);
  return test;
}

}  // namespace mindahl::identification
