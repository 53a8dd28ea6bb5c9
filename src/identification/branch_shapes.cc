#include "identification/branch_shapes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

namespace mindahl::identification {

using models::BranchStart;

namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

constexpr std::array kNames = {"virgin", "unloading", "reloading"};
constexpr std::size_t kFewest = 10;

/// Kind of the branch of each sample, an index of kNames. A contact unloads on its way back from
/// its first push; of a steady one that is not known, and taken to have been to positive
/// displacements.
std::vector<std::size_t> Kinds(const Candidate& candidate, const ScaledRecords& data) {
  std::vector<std::size_t> kinds;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const models::LoadingPath path = candidate.residual.PathOf(r, candidate.solution.theta);
    const models::Branch& first = path.branches.front();
    const bool first_up = first.start != BranchStart::kUnloaded || first.direction > 0;
    std::size_t kind = 2;
    for (const models::BranchRun& run : path.runs) {
      const models::Branch& branch = path.branches[static_cast<std::size_t>(run.branch)];
      const bool back = (branch.direction > 0) != first_up;
      // A steady loop's virgin curve is not in the record: a sample on it is an extreme that came
      // back to the last bit, and ends the stroke before.
      if (branch.start != BranchStart::kSteadyCentre) {
        kind = branch.start == BranchStart::kUnloaded ? 0 : back ? 1 : 2;
      }
      kinds.insert(kinds.end(), run.end - run.begin, kind);
    }
  }
  return kinds;
}

}  // namespace

std::vector<BranchShape> FitBranchShapes(const Candidate& candidate, const ScaledRecords& data,
                                         const NoiseModel& noise,
                                         std::span<const std::size_t> record_rows,
                                         double variance) {
  constexpr double kAtBound = 1e-9;
  const ScaledParameter& shape = candidate.layout.parameters()[kShapeExponent];
  const double alpha = candidate.solution.theta[kShapeExponent];
  if (shape.fixed || alpha <= shape.lower + kAtBound || alpha >= shape.upper - kAtBound) return {};

  std::array<std::size_t, kNames.size()> samples{};
  const std::vector<std::size_t> kinds = Kinds(candidate, data);
  std::vector<double> weights;
  for (const ScaledRecord& record : data.records) {
    weights.insert(weights.end(), record.root_weight.begin(), record.root_weight.end());
  }
  for (std::size_t i = 0; i < kinds.size(); ++i) {
    if (weights[i] > 0) ++samples[kinds[i]];
  }
  std::vector<std::size_t> present;
  for (std::size_t kind = 0; kind < kNames.size(); ++kind) {
    if (samples[kind] >= kFewest) present.push_back(kind);
  }
  if (present.size() < 2) return {};

  const std::vector<std::size_t>& free = candidate.layout.free();
  const auto rows = static_cast<Eigen::Index>(candidate.residual.size());
  const auto columns = static_cast<Eigen::Index>(free.size());
  std::vector<double> residual(candidate.residual.size());
  RowMajorMatrix jacobian(rows, columns);
  candidate.residual.Differentiate(candidate.solution.theta, free, residual,
                                   {jacobian.data(), static_cast<std::size_t>(jacobian.size())});
  const auto shape_column =
      static_cast<Eigen::Index>(std::ranges::find(free, kShapeExponent) - free.begin());

  // α's column in parts, the first in its place, the others at the end.
  const auto kinds_present = static_cast<Eigen::Index>(present.size());
  RowMajorMatrix split(rows, columns + kinds_present - 1);
  split.leftCols(columns) = jacobian;
  std::vector<Eigen::Index> column_of = {shape_column};
  for (Eigen::Index k = 1; k < kinds_present; ++k) {
    column_of.push_back(columns + k - 1);
    split.col(columns + k - 1).setZero();
  }
  for (Eigen::Index i = 0; i < rows; ++i) {
    const auto kind = std::ranges::find(present, kinds[static_cast<std::size_t>(i)]);
    if (kind == present.end() || kind == present.begin()) continue;
    split(i, column_of[static_cast<std::size_t>(kind - present.begin())]) =
        jacobian(i, shape_column);
    split(i, shape_column) = 0;
  }
  Eigen::VectorXd norms = split.colwise().norm().transpose();
  for (double& norm : norms) {
    if (norm == 0) norm = 1;
  }
  split = split * norms.cwiseInverse().asDiagonal();
  const Eigen::Map<const Eigen::VectorXd> values(residual.data(), rows);
  const Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> decomposition(split.transpose() *
                                                                              split);
  const Eigen::MatrixXd factor = decomposition.pseudoInverse();
  const Eigen::VectorXd step = -factor * (split.transpose() * values);
  Eigen::MatrixXd correlated = Eigen::MatrixXd::Zero(split.cols(), split.cols());
  Eigen::Index begin = 0;
  const auto width = static_cast<std::size_t>(split.cols());
  for (const std::size_t samples_of_record : record_rows) {
    const std::vector<double> part =
        noise.Quadratic({split.row(begin).data(), samples_of_record * width}, width);
    correlated += Eigen::Map<const Eigen::MatrixXd>(part.data(), split.cols(), split.cols());
    begin += static_cast<Eigen::Index>(samples_of_record);
  }
  // What the departure from one law leaves in the residuals is not noise here.
  const double sum_of_squares = values.squaredNorm();
  if (!(sum_of_squares > 0)) return {};
  const double left = (values + split * step).squaredNorm() / sum_of_squares;
  const Eigen::MatrixXd covariance =
      variance * (left < 1 ? left : 1.0) * factor * correlated * factor;
  std::vector<BranchShape> shapes;
  for (std::size_t k = 0; k < present.size(); ++k) {
    const Eigen::Index column = column_of[k];
    shapes.push_back({kNames[present[k]], samples[present[k]], alpha + step[column] / norms[column],
                      std::sqrt(covariance(column, column)) / norms[column]});
  }
  return shapes;
}

}  // namespace mindahl::identification
