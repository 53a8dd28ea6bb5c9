#include "identification/solve/linear_columns.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "identification/dense.h"
#include "identification/solve/sums.h"

namespace mindahl::identification {

namespace {

/// A column whose part orthogonal to those before it is below this fraction of it depends on them.
constexpr double kDependent = 1e-12;

std::span<double> ColumnSpan(Eigen::MatrixXd& matrix, Eigen::Index j) {
  return {matrix.col(j).data(), static_cast<std::size_t>(matrix.rows())};
}

}  // namespace

void LinearColumns::Factorise(const Problem& problem, std::span<const unsigned char> held,
                              std::span<const double> theta, std::span<const double> weight,
                              std::span<double> measured) {
  const ScaledRecords& data = *problem.data;
  const Parameters& parameters = problem.parameters;
  parameters_.clear();
  independent_.clear();
  blocks_.clear();
  basis_.clear();
  triangle_.resize(0, 0);
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const Parameter& parameter = parameters[p];
    if (parameter.term->column == Regressor::kNone || theta[p] == 0) continue;
    if (!parameter.fixed && held[p] == 0) continue;
    std::size_t row = 0;
    for (std::size_t r = 0; r < data.records.size(); ++r) {
      const std::size_t size = data.records[r].size();
      AddColumn(problem, p, r, theta, -theta[p], measured.subspan(row, size));
      row += size;
    }
  }
  Weigh(measured, 1.0, weight);
  const auto is_free = [&](std::size_t p) {
    return parameters[p].term->column != Regressor::kNone && !parameters[p].fixed && held[p] == 0;
  };
  std::size_t row = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const std::size_t size = data.records[r].size();
    members_.clear();
    for (std::size_t p = 0; p < parameters.size(); ++p) {
      const Parameter& parameter = parameters[p];
      const bool is_own = parameter.term->scope == Scope::kRecord && parameter.record == r;
      if (is_own && is_free(p)) members_.push_back(p);
    }
    AddBlock(problem, row, size, theta, weight);
    row += size;
  }
  members_.clear();
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].term->scope == Scope::kContact && is_free(p)) members_.push_back(p);
  }
  AddBlock(problem, 0, problem.size(), theta, weight);
  const auto count = static_cast<Eigen::Index>(independent_.size());
  measured_projections_.resize(count);
  response_projections_.setZero(count);
  for (const Block& block : blocks_) {
    const std::span<double> rows = measured.subspan(block.first_row, block.rows);
    for (std::size_t k = 0; k < block.columns; ++k) {
      measured_projections_[static_cast<Eigen::Index>(block.first_column + k)] =
          TakeOut(rows, Basis(block, k));
    }
  }
}

void LinearColumns::AddBlock(const Problem& problem, std::size_t first_row, std::size_t rows,
                             std::span<const double> theta, std::span<const double> weight) {
  std::vector<std::size_t>& kept = members_;
  if (kept.empty()) return;
  parameters_.insert(parameters_.end(), kept.begin(), kept.end());
  const std::size_t before = independent_.size();
  Eigen::MatrixXd coupling;  // Qᵀ of the blocks before, by this block's columns
  while (!kept.empty()) {
    const auto count = static_cast<Eigen::Index>(kept.size());
    columns_.setZero(static_cast<Eigen::Index>(rows), count);
    coupling.setZero(static_cast<Eigen::Index>(before), count);
    Eigen::VectorXd norms(count);
    for (Eigen::Index j = 0; j < count; ++j) {
      const std::span<double> column = ColumnSpan(columns_, j);
      std::size_t row = 0;
      for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
        const std::size_t size = problem.data->records[r].size();
        if (row >= first_row && row + size <= first_row + rows) {
          AddColumn(problem, kept[static_cast<std::size_t>(j)], r, theta, 1.0,
                    column.subspan(row - first_row, size));
        }
        row += size;
      }
      Weigh(column, 1.0, weight.subspan(first_row, rows));
      norms[j] = columns_.col(j).norm();
      // Twice, as what the first projection leaves of a column that nearly depends on the others
      // is not orthogonal to them.
      for (int round = 0; round < 2 && before > 0; ++round) {
        for (const Block& block : blocks_) {
          if (block.first_row < first_row || block.first_row + block.rows > first_row + rows) {
            continue;
          }
          for (std::size_t k = 0; k < block.columns; ++k) {
            coupling(static_cast<Eigen::Index>(block.first_column + k), j) +=
                TakeOut(column.subspan(block.first_row - first_row, block.rows), Basis(block, k));
          }
        }
      }
    }
    qr_.compute(columns_);
    Eigen::Index dependent = 0;
    while (dependent < count && dependent < columns_.rows() &&
           std::abs(qr_.matrixQR()(dependent, dependent)) > kDependent * norms[dependent]) {
      ++dependent;
    }
    if (dependent == count) break;
    kept.erase(kept.begin() + dependent);
  }
  if (kept.empty()) return;
  const auto count = static_cast<Eigen::Index>(kept.size());
  const auto first = static_cast<Eigen::Index>(before);
  thin_.setIdentity(static_cast<Eigen::Index>(rows), count);
  thin_.applyOnTheLeft(qr_.householderQ());
  triangle_.conservativeResize(first + count, first + count);
  triangle_.bottomRows(count).setZero();
  triangle_.topRightCorner(first, count) = coupling;
  triangle_.bottomRightCorner(count, count) =
      qr_.matrixQR().topRows(count).triangularView<Eigen::Upper>();
  blocks_.push_back({.first_row = first_row,
                     .rows = rows,
                     .first_column = before,
                     .columns = kept.size(),
                     .offset = basis_.size()});
  basis_.insert(basis_.end(), thin_.data(), thin_.data() + thin_.size());
  independent_.insert(independent_.end(), kept.begin(), kept.end());
}

void LinearColumns::ProjectOut(std::span<double> column) const {
  for (const Block& block : blocks_) {
    const std::span<double> rows = column.subspan(block.first_row, block.rows);
    for (std::size_t k = 0; k < block.columns; ++k) TakeOut(rows, Basis(block, k));
  }
}

void LinearColumns::ProjectResponse(std::span<double> response) {
  for (const Block& block : blocks_) {
    const std::span<double> rows = response.subspan(block.first_row, block.rows);
    for (std::size_t k = 0; k < block.columns; ++k) {
      response_projections_[static_cast<Eigen::Index>(block.first_column + k)] =
          TakeOut(rows, Basis(block, k));
    }
  }
}

void LinearColumns::Solve(double scale, std::span<double> theta) const {
  for (const std::size_t p : parameters_) theta[p] = 0.0;
  if (independent_.empty()) return;
  const Eigen::VectorXd values = triangle_.triangularView<Eigen::Upper>().solve(
      measured_projections_ - scale * response_projections_);
  for (std::size_t k = 0; k < independent_.size(); ++k) {
    theta[independent_[k]] = values[static_cast<Eigen::Index>(k)];
  }
}

}  // namespace mindahl::identification
