#include "identification/inference/memory_test.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string_view>
#include <vector>

#include "identification/inference/column_test.h"
#include "identification/inference/memory_columns.h"

namespace mindahl::identification {
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
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factors(columns);
  factors.setThreshold(kOwn);
  return factors.householderQ() * Eigen::MatrixXd::Identity(columns.rows(), factors.rank());
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
                                 other != nullptr ? Eigen::VectorXd(other->residual - law.residual)
                                                  : Eigen::VectorXd())),
        basis_(BasisOf(law.jacobian, columns_.shape)),
        test_(Test(nullptr)) {}

  /// Tests with its own noise, or with that of the other law where that is less.
  [[nodiscard]] Answer Ask(const MemoryTrial* other) const {
    return other != nullptr && other->test_.variance() < test_.variance()
               ? AskOf(Test(&other->test_))
               : AskOf(test_);
  }

 private:
  [[nodiscard]] ColumnTest Test(const ColumnTest* quieter) const {
    return {*law_.problem,        noise_,        displacement_, basis_,
            columns_.differences, law_.residual, quieter};
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
    // Rounding errors are what they like: a law that leaves no more has the record.
    const bool only_rounding =
        law_.residual.norm() < 10 * kRoundingRms * std::sqrt(static_cast<double>(data.counted));
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
