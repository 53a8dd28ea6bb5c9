#include "identification/gram/gram.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace mindahl::identification {
namespace {

/// Scales columns to unit norm; those of zeros, and what overflows, become zero.
Eigen::VectorXd Normalize(Eigen::MatrixXd& columns) {
  Eigen::VectorXd norms = columns.colwise().norm();
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    if (!(std::isfinite(norms[j]) && norms[j] > 0)) {
      norms[j] = 1.0;
      columns.col(j).setZero();
    }
    columns.col(j) /= norms[j];
  }
  return norms;
}

}  // namespace

Gram::Gram(const Eigen::MatrixXd& law, const Eigen::MatrixXd& omitted,
           const Eigen::VectorXd& residual, double own_part) {
  Eigen::MatrixXd j = law;
  Eigen::MatrixXd c = omitted;
  law_norms_ = Normalize(j);
  omitted_norms_ = Normalize(c);
  const Eigen::MatrixXd of_law = j.transpose() * j;
  inverse_of_law_ = j.cols() > 0
                        ? Eigen::MatrixXd(of_law.completeOrthogonalDecomposition().pseudoInverse())
                        : of_law;
  const Eigen::MatrixXd mixed = j.transpose() * c;
  shares_ = inverse_of_law_ * mixed;
  law_residual_ = j.transpose() * residual;
  free_ = c.transpose() * c - mixed.transpose() * shares_;
  free_residual_ = c.transpose() * residual - shares_.transpose() * law_residual_;
  sum_of_squares_ = residual.squaredNorm() - law_residual_.dot(inverse_of_law_ * law_residual_);
  for (Eigen::Index k = 0; k < c.cols(); ++k) {
    if (free_(k, k) >= own_part * own_part) continue;
    free_.row(k).setZero();
    free_.col(k).setZero();
    shares_.col(k).setZero();
    free_residual_[k] = 0.0;
  }
  law_noise_ = inverse_of_law_;
  free_noise_ = free_;
  absorbed_ = (inverse_of_law_ * of_law).trace();
}

void Gram::SetNoise(Eigen::MatrixXd products) {
  Eigen::VectorXd norms(products.rows());
  norms << law_norms_, omitted_norms_;
  products = norms.cwiseInverse().asDiagonal() * products * norms.cwiseInverse().asDiagonal();
  const Eigen::Index law = law_norms_.size();
  const Eigen::Index omitted = omitted_norms_.size();
  const Eigen::MatrixXd of_law = products.topLeftCorner(law, law);
  const Eigen::MatrixXd mixed = shares_.transpose() * products.topRightCorner(law, omitted);
  free_noise_ = products.bottomRightCorner(omitted, omitted) - mixed - mixed.transpose() +
                shares_.transpose() * of_law * shares_;
  absorbed_ = (inverse_of_law_ * of_law).trace();
  law_noise_ = inverse_of_law_ * of_law * inverse_of_law_;
}

double Gram::IndependentTests() const {
  const Eigen::VectorXd scale =
      (free_.diagonal().array() > 0).select(free_.diagonal().array().rsqrt(), 0.0);
  const Eigen::MatrixXd correlation = scale.asDiagonal() * free_ * scale.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> pairs(correlation, Eigen::EigenvaluesOnly);
  const Eigen::ArrayXd values = pairs.eigenvalues().array().max(0.0);
  return std::max(1.0, std::pow(values.sqrt().sum(), 2) / values.sum());
}

GramAxes Gram::AxesOfAll() const {
  std::vector<Eigen::Index> all(static_cast<std::size_t>(free_.cols()));
  std::iota(all.begin(), all.end(), Eigen::Index{0});
  return AxesOf(all);
}

GramAxes Gram::AxesOf(const std::vector<Eigen::Index>& places) const {
  GramAxes axes;
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> pairs(free_(places, places));
  // Square of the norm of an axis that is independent of the others.
  constexpr double kLeast = 1e-6;
  const Eigen::Index count = (pairs.eigenvalues().array() > kLeast).count();  // the last ones
  axes.values = pairs.eigenvalues().tail(count).array();
  axes.vectors = Eigen::MatrixXd::Zero(free_.rows(), count);
  axes.vectors(places, Eigen::all) = pairs.eigenvectors().rightCols(count);
  axes.coefficients = (axes.vectors.transpose() * free_residual_).array() / axes.values.sqrt();
  const Eigen::MatrixXd noise = free_noise_ * axes.vectors;
  axes.noise =
      (axes.vectors.cwiseProduct(noise).colwise().sum().transpose().array() / axes.values).max(1.0);
  return axes;
}

GramStep Gram::StepBy(const GramAxes& axes, const Eigen::ArrayXd& gains) const {
  const Eigen::ArrayXd amounts = gains * axes.values.sqrt() * axes.coefficients;
  const Eigen::VectorXd omitted = -(axes.vectors * amounts.matrix());
  const Eigen::VectorXd law = -(inverse_of_law_ * law_residual_) - shares_ * omitted;
  const Eigen::MatrixXd moved = shares_ * axes.vectors;
  const Eigen::MatrixXd errors =
      law_noise_ + moved * (gains * axes.noise).matrix().asDiagonal() * moved.transpose();
  const Eigen::VectorXd scale = law_norms_.cwiseInverse();
  return {.law = law.cwiseProduct(scale),
          .omitted = omitted.cwiseQuotient(omitted_norms_),
          .covariance = scale.asDiagonal() * errors * scale.asDiagonal()};
}

}  // namespace mindahl::identification
