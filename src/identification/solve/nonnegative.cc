#include "identification/solve/nonnegative.h"

#include <limits>

namespace mindahl::identification {
namespace {

/// The least-squares solution over the free ones, 0 elsewhere.
Eigen::VectorXd SolveFree(const Eigen::MatrixXd& product, const Eigen::VectorXd& b,
                          const std::vector<bool>& free) {
  std::vector<Eigen::Index> places;
  for (std::size_t k = 0; k < free.size(); ++k) {
    if (free[k]) places.push_back(static_cast<Eigen::Index>(k));
  }
  Eigen::VectorXd w = Eigen::VectorXd::Zero(b.size());
  if (places.empty()) return w;
  const Eigen::MatrixXd of_free = product(places, places);
  const Eigen::VectorXd right = b(places);
  const Eigen::VectorXd solved = of_free.ldlt().solve(right);
  w(places) = solved;
  return w;
}

}  // namespace

Eigen::VectorXd SolveNonnegative(const Eigen::MatrixXd& product, const Eigen::VectorXd& b,
                                 const Eigen::VectorXd& start) {
  const Eigen::Index count = b.size();
  // A gradient below this fraction of its summands is rounding.
  constexpr double kRounding = 1e-12;
  std::vector<bool> free(static_cast<std::size_t>(count), false);
  Eigen::VectorXd w = Eigen::VectorXd::Zero(count);
  if (start.size() == count) {
    w = start;
    for (Eigen::Index k = 0; k < count; ++k) free[static_cast<std::size_t>(k)] = w[k] > 0;
  }
  const double scale = b.cwiseAbs().maxCoeff();
  bool is_new = start.size() == count;
  for (Eigen::Index round = 0; round < 3 * count; ++round) {
    if (!is_new) {
      const Eigen::VectorXd gradient = b - product * w;
      Eigen::Index best = -1;
      double steepest = kRounding * scale;
      for (Eigen::Index k = 0; k < count; ++k) {
        if (!free[static_cast<std::size_t>(k)] && gradient[k] > steepest) {
          steepest = gradient[k];
          best = k;
        }
      }
      if (best < 0) return w;
      free[static_cast<std::size_t>(best)] = true;
    }
    is_new = false;
    // Back to the first that would turn negative, until none does.
    for (Eigen::Index step = 0; step < count + 1; ++step) {
      const Eigen::VectorXd target = SolveFree(product, b, free);
      double share = 1.0;
      Eigen::Index blocking = -1;
      for (Eigen::Index k = 0; k < count; ++k) {
        if (!free[static_cast<std::size_t>(k)] || target[k] > 0) continue;
        const double reach = w[k] > target[k] ? w[k] / (w[k] - target[k]) : 0.0;
        if (reach < share || blocking < 0) {
          share = reach;
          blocking = k;
        }
      }
      w += share * (target - w);
      if (blocking < 0) break;
      w[blocking] = 0.0;
      free[static_cast<std::size_t>(blocking)] = false;
    }
  }
  return w;
}

}  // namespace mindahl::identification
