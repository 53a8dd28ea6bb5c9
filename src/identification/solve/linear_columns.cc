#include "identification/solve/linear_columns.h"

#include <Eigen/QR>
#include <cmath>
#include <numeric>

namespace mindahl::identification {

void LinearColumns::Factorise(const Problem& problem, std::span<const unsigned char> held,
                              std::span<const double> theta, const Eigen::VectorXd& weight) {
  const Parameters& parameters = problem.parameters;
  parameters_.clear();
  independent_.clear();
  blocks_.clear();
  triangle_.resize(0, 0);
  const auto members_of = [&](auto&& belongs) {
    std::vector<std::size_t> members;
    for (const std::size_t p : parameters.free()) {
      const Parameter& parameter = parameters[p];
      if (!parameter.term->is_linear || held[p] != 0) continue;
      if (belongs(parameter)) members.push_back(p);
    }
    return members;
  };
  Eigen::Index row = 0;
  for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
    const auto size = static_cast<Eigen::Index>(problem.data->records[r].size());
    AddBlock(problem, members_of([r](const Parameter& parameter) {
               return parameter.term->scope == Scope::kRecord && parameter.record == r;
             }),
             row, size, theta, weight);
    row += size;
  }
  AddBlock(problem, members_of([](const Parameter& parameter) {
             return parameter.term->scope == Scope::kContact;
           }),
           0, row, theta, weight);
}

void LinearColumns::AddBlock(const Problem& problem, const std::vector<std::size_t>& members,
                             Eigen::Index first_row, Eigen::Index rows,
                             std::span<const double> theta, const Eigen::VectorXd& weight) {
  // A column whose part orthogonal to those before it is below this fraction of it depends on them.
  constexpr double kDependent = 1e-12;
  const auto size = static_cast<Eigen::Index>(members.size());
  const auto before = static_cast<Eigen::Index>(independent_.size());
  parameters_.insert(parameters_.end(), members.begin(), members.end());
  Eigen::MatrixXd columns(rows, size);
  Eigen::MatrixXd coupling(before, size);  // products with the blocks before
  Eigen::VectorXd norms(size);
  Eigen::VectorXd whole(weight.size());
  for (Eigen::Index j = 0; j < size; ++j) {
    whole.setZero();
    std::size_t row = 0;
    for (std::size_t r = 0; r < problem.data->records.size(); ++r) {
      const std::size_t count = problem.data->records[r].size();
      AddColumn(problem, members[static_cast<std::size_t>(j)], r, theta, 1.0,
                std::span(whole.data() + row, count));
      row += count;
    }
    whole.array() *= weight.array();
    norms[j] = whole.norm();
    // Twice, as what the first projection leaves of a column that nearly depends on the others is
    // not orthogonal to them.
    coupling.col(j) = ProjectOut(whole);
    coupling.col(j) += ProjectOut(whole);
    columns.col(j) = whole.segment(first_row, rows);
  }
  std::vector<Eigen::Index> kept(members.size());  // those that are independent
  std::iota(kept.begin(), kept.end(), Eigen::Index{0});
  Eigen::HouseholderQR<Eigen::MatrixXd> qr;
  while (!kept.empty()) {
    qr.compute(columns(Eigen::all, kept));
    const auto is_independent = [&](Eigen::Index k) {
      return k < rows &&
             std::abs(qr.matrixQR()(k, k)) > kDependent * norms[kept[static_cast<std::size_t>(k)]];
    };
    Eigen::Index first = 0;
    while (first < std::ssize(kept) && is_independent(first)) ++first;
    if (first == std::ssize(kept)) break;
    kept.erase(kept.begin() + first);
  }
  if (kept.empty()) return;
  const Eigen::Index count = std::ssize(kept);
  triangle_.conservativeResize(before + count, before + count);
  triangle_.bottomRows(count).setZero();
  triangle_.topRightCorner(before, count) = coupling(Eigen::all, kept);
  triangle_.bottomRightCorner(count, count) =
      qr.matrixQR().topRows(count).triangularView<Eigen::Upper>();
  blocks_.push_back({.first_row = first_row,
                     .first_column = before,
                     .basis = qr.householderQ() * Eigen::MatrixXd::Identity(rows, count)});
  for (const Eigen::Index j : kept) {
    independent_.push_back(members[static_cast<std::size_t>(j)]);
  }
}

Eigen::VectorXd LinearColumns::ProjectOut(Eigen::Ref<Eigen::VectorXd> column) const {
  Eigen::VectorXd products(std::ssize(independent_));
  for (const Block& block : blocks_) {
    auto rows = column.segment(block.first_row, block.basis.rows());
    for (Eigen::Index k = 0; k < block.basis.cols(); ++k) {
      const double product = block.basis.col(k).dot(rows);
      products[block.first_column + k] = product;
      rows -= product * block.basis.col(k);
    }
  }
  return products;
}

void LinearColumns::Solve(const Eigen::VectorXd& products, std::span<double> theta) const {
  for (const std::size_t p : parameters_) theta[p] = 0.0;
  if (independent_.empty()) return;
  const Eigen::VectorXd values = triangle_.triangularView<Eigen::Upper>().solve(products);
  for (std::size_t k = 0; k < independent_.size(); ++k) {
    theta[independent_[k]] = values[static_cast<Eigen::Index>(k)];
  }
}

}  // namespace mindahl::identification
