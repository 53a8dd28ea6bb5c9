#pragma once

#include <Eigen/QR>
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
  /// @param held      1 for a linear parameter that is held at a bound
  /// @param theta     θ of all parameters; those of fixed and held ones are used
  /// @param weight    root weight of every sample
  /// @param measured  in: the measured response; out: less what is held, weighted, and orthogonal
  ///                  to the columns
  void Factorise(const Problem& problem, std::span<const unsigned char> held,
                 std::span<const double> theta, std::span<const double> weight,
                 std::span<double> measured);

  /// Makes a column orthogonal to the basis.
  void ProjectOut(std::span<double> column) const;

  /// Makes the model's response orthogonal to the basis and keeps its projections for Solve().
  void ProjectResponse(std::span<double> response);

  /// Writes the least-squares values of the free linear parameters for scale·response into θ, and
  /// 0 for those whose column depends linearly on the others.
  void Solve(double scale, std::span<double> theta) const;

  /// Positions of the free linear parameters, dependent ones included.
  [[nodiscard]] std::span<const std::size_t> parameters() const { return parameters_; }

 private:
  struct Block {  // of columns with the same rows
    std::size_t first_row;
    std::size_t rows;
    std::size_t first_column;
    std::size_t columns;
    std::size_t offset;  // of its basis in basis_
  };

  /// Factorises the columns of members_ over some rows, and leaves the independent ones there.
  void AddBlock(const Problem& problem, std::size_t first_row, std::size_t rows,
                std::span<const double> theta, std::span<const double> weight);
  [[nodiscard]] std::span<const double> Basis(const Block& block, std::size_t k) const {
    return {basis_.data() + block.offset + k * block.rows, block.rows};
  }

  std::vector<std::size_t> parameters_;
  std::vector<std::size_t> independent_;  // of these, in the order of the basis
  std::vector<std::size_t> members_;      // of the block that is being made
  std::vector<Block> blocks_;
  std::vector<double> basis_;
  Eigen::MatrixXd triangle_;  // R of the independent columns
  Eigen::VectorXd measured_projections_;
  Eigen::VectorXd response_projections_;
  Eigen::HouseholderQR<Eigen::MatrixXd> qr_;
  Eigen::MatrixXd columns_;
  Eigen::MatrixXd thin_;
};

}  // namespace mindahl::identification
