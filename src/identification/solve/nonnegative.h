#pragma once

#include <Eigen/Dense>
#include <vector>

namespace mindahl::identification {

/// min wᵀGw − 2bᵀw, w ≥ 0, by Lawson and Hanson's (1974) active set.
/// @param product  G, symmetric, positive definite on any set that is let free
/// @param start    w to begin with, ≥ 0, of which the positive ones are free; empty: zero
Eigen::VectorXd SolveNonnegative(const Eigen::MatrixXd& product, const Eigen::VectorXd& b,
                                 const Eigen::VectorXd& start = {});

}  // namespace mindahl::identification
