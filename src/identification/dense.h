#pragma once

#include <Eigen/Core>

namespace mindahl::identification {

using MatrixView = Eigen::Ref<const Eigen::MatrixXd>;

/// Returns what the columns of A leave of B: B − A·argmin |B − AX|. Compiled once: a factorisation
/// takes longer to compile than most sources that need it.
Eigen::MatrixXd LeftOver(const MatrixView& a, const MatrixView& b);

}  // namespace mindahl::identification
