#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "identification/problem/problem.h"

namespace mindahl::identification {

/// Orthonormal basis of the weighted columns of a problem's free linear parameters, from Eigen's
/// Householder QR. A record's own columns are factorised over its own rows; the columns that all
/// records share are factorised after those have been projected out, so that the cost of a
/// projection grows with the number of samples and not with the number of records.
class LinearColumns {
 public:
  /// Factorises the columns of the linear parameters that are neither fixed nor held.
  /// @param held    1 for a linear parameter that is held at a bound
  /// @param theta   θ of all parameters; of those that shape columns it is used
  /// @param weight  root weight of every sample
  void Factorise(const Problem& problem, std::span<const unsigned char> held,
                 std::span<const double> theta, const Eigen::VectorXd& weight);

  /// Makes a column orthogonal to the basis.
  /// @returns its products with the basis
  Eigen::VectorXd ProjectOut(Eigen::Ref<Eigen::VectorXd> column) const;

  /// Writes the values of the parameters whose columns have these products with the basis into θ,
  /// and 0 for those whose column depends linearly on the others.
  void Solve(const Eigen::VectorXd& products, std::span<double> theta) const;

  /// Positions of the free linear parameters, dependent ones included.
  [[nodiscard]] std::span<const std::size_t> parameters() const { return parameters_; }

 private:
  struct Block {  // of columns with the same rows
    Eigen::Index first_row;
    Eigen::Index first_column;
    Eigen::MatrixXd basis;
  };

  /// Factorises the columns of some parameters over some rows, as far as they are independent.
  void AddBlock(const Problem& problem, const std::vector<std::size_t>& members,
                Eigen::Index first_row, Eigen::Index rows, std::span<const double> theta,
                const Eigen::VectorXd& weight);

  std::vector<std::size_t> parameters_;
  std::vector<std::size_t> independent_;  // of these, in the order of the basis
  std::vector<Block> blocks_;
  Eigen::MatrixXd triangle_;  // R of the independent columns
};

}  // namespace mindahl::identification
