#include "identification/inference/column_test.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/probability.h"
#include "identification/solve/sums.h"

namespace mindahl::identification {
namespace {

/// Least part of a column orthogonal to the law's, below which it is one of theirs.
constexpr double kOwnShare = 0.02;
/// Least part orthogonal to the columns before it.
constexpr double kIndependent = 1e-3;

/// Wald's statistic, over their number, of the coefficients of orthonormal columns U in the
/// residuals. Noise counts at least as white: where the columns took up what is slow of it, the
/// rest would call what is slow improbable.
/// @param correlated  UᵀRU
double WaldF(const Eigen::VectorXd& coefficients, const Eigen::MatrixXd& correlated,
             double variance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> axes(correlated);
  const Eigen::ArrayXd along = (axes.eigenvectors().transpose() * coefficients).array();
  return (along.square() / axes.eigenvalues().array().max(1.0)).mean() / variance;
}

Eigen::MatrixXd Inverse(const Eigen::MatrixXd& symmetric) {
  if (symmetric.size() == 0) return symmetric;
  return Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(symmetric).pseudoInverse();
}

std::span<const double> ColumnValues(const Eigen::MatrixXd& matrix, Eigen::Index j) {
  return {matrix.col(j).data(), static_cast<std::size_t>(matrix.rows())};
}

std::span<const double> SpanOf(const Eigen::VectorXd& vector) {
  return {vector.data(), static_cast<std::size_t>(vector.size())};
}

/// AᵀA
Eigen::MatrixXd ProductsOf(const Eigen::MatrixXd& columns) {
  Eigen::MatrixXd products(columns.cols(), columns.cols());
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    for (Eigen::Index k = 0; k <= j; ++k) {
      products(j, k) = products(k, j) = Dot(ColumnValues(columns, j), ColumnValues(columns, k));
    }
  }
  return products;
}

/// Orthonormal columns that span both.
Eigen::MatrixXd OrthonormalOf(const Eigen::MatrixXd& one, const Eigen::MatrixXd& other) {
  Eigen::MatrixXd both(one.rows(), one.cols() + other.cols());
  both << one, other;
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(both);
  return qr.householderQ() * Eigen::MatrixXd::Identity(both.rows(), qr.rank());
}

/// AᵀRA of noise that is not white.
Eigen::MatrixXd CorrelatedProducts(const ScaledRecords& data, const Noise& noise,
                                   const Autocorrelation& autocorrelation,
                                   const DisplacementEffect& displacement,
                                   const Eigen::MatrixXd& columns) {
  return displacement.residuals.size() > 0
             ? CorrelatedProduct(data, autocorrelation, noise, displacement, columns)
             : CorrelatedProduct(data, autocorrelation, columns);
}

}  // namespace

ColumnTest::ColumnTest(const Problem& problem, const Noise& noise,
                       const DisplacementEffect& displacement, const Eigen::MatrixXd& law,
                       const Eigen::MatrixXd& others, const Eigen::VectorXd& residual,
                       const ColumnTest* quieter, bool restores)
    : law_(law.cols()),
      samples_(static_cast<double>(problem.data->counted)),
      sum_of_squares_(residual.squaredNorm()) {
  Eigen::MatrixXd columns(law.rows(), law_ + others.cols());
  columns << law, others;
  norms_.resize(columns.cols());
  residual_.resize(columns.cols());
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    const double square = Dot(ColumnValues(columns, j), ColumnValues(columns, j));
    const bool is_told = std::isfinite(square) && square > 0;
    norms_[j] = is_told ? std::sqrt(square) : 1.0;
    if (is_told) {
      columns.col(j) *= 1 / norms_[j];
    } else {
      columns.col(j).setZero();  // overflow: not identifiable
    }
    residual_[j] = Dot(ColumnValues(columns, j), SpanOf(residual));
  }
  plain_ = ProductsOf(columns);
  inverse_of_law_ = Inverse(plain_.topLeftCorner(law_, law_));
  shares_ = inverse_of_law_ * plain_.topRightCorner(law_, others.cols());
  free_plain_ = FreedOfLaw(plain_);
  free_residual_ = residual_.tail(others.cols()) - shares_.transpose() * residual_.head(law_);

  std::vector<Eigen::Index> everything(static_cast<std::size_t>(others.cols()));
  std::iota(everything.begin(), everything.end(), Eigen::Index{0});
  all_ = Orthonormal(everything);
  const Eigen::VectorXd explained = all_.transpose() * free_residual_;
  Eigen::VectorXd in_columns(columns.cols());
  in_columns.tail(others.cols()) = all_ * explained;
  in_columns.head(law_) = -shares_ * in_columns.tail(others.cols());
  Eigen::VectorXd rest = residual;
  for (Eigen::Index j = 0; j < columns.cols(); ++j) {
    AddMultiple({rest.data(), problem.size()}, -in_columns[j], ColumnValues(columns, j));
  }
  has_drawn_ = displacement.residuals.size() > 0;
  if (quieter != nullptr) {
    autocorrelation_ = quieter->autocorrelation_;
  } else if (restores) {
    autocorrelation_ = AutocorrelationBeside(
        *problem.data, {rest.data(), problem.size()},
        OrthonormalOf(columns.leftCols(law_), columns.rightCols(others.cols()) * all_));
  } else {
    autocorrelation_ = AutocorrelationOf(*problem.data, {rest.data(), problem.size()});
  }
  is_white_ = autocorrelation_.order == 0 && displacement.residuals.size() == 0;
  correlated_ =
      is_white_ ? plain_
                : CorrelatedProducts(*problem.data, noise, autocorrelation_, displacement, columns);
  if (!is_white_) free_correlated_ = FreedOfLaw(correlated_);

  // A fit absorbs more of correlated noise than the number of its parameters.
  const double by_law = (inverse_of_law_ * correlated_.topLeftCorner(law_, law_)).trace();
  const double by_others = CorrelationOf(all_).trace();
  const double absorbed = std::min(by_law + by_others, samples_ / 2);
  if (quieter != nullptr) {
    variance_ = quieter->variance_;
  } else {
    variance_ = noise.is_known ? noise.variance : rest.squaredNorm() / (samples_ - absorbed);
  }
  effective_samples_ = samples_ / std::max(1.0, autocorrelation_.SquaredCorrelations());
  degrees_of_freedom_ = std::max(
      1.0, effective_samples_ - static_cast<double>(law_) - static_cast<double>(all_.cols()));
}

/// Returns the products of the other columns, orthogonalised to those of the law.
/// @param products  of A
Eigen::MatrixXd ColumnTest::FreedOfLaw(const Eigen::MatrixXd& products) const {
  const Eigen::Index count = products.cols() - law_;
  const Eigen::MatrixXd mixed = shares_.transpose() * products.topRightCorner(law_, count);
  return products.bottomRightCorner(count, count) - mixed - mixed.transpose() +
         shares_.transpose() * products.topLeftCorner(law_, law_) * shares_;
}

/// Coefficients, in columns freed of the law, of orthonormal ones that span some of them; none
/// where a column has less than kOwnShare of its own.
Eigen::MatrixXd ColumnTest::Orthonormal(std::span<const Eigen::Index> places) const {
  Eigen::MatrixXd result =
      Eigen::MatrixXd::Zero(free_plain_.rows(), static_cast<Eigen::Index>(places.size()));
  Eigen::MatrixXd image = result;  // free_plain·result
  Eigen::Index count = 0;
  for (const Eigen::Index place : places) {
    if (!(free_plain_(place, place) >= kOwnShare * kOwnShare)) continue;
    Eigen::VectorXd v = Eigen::VectorXd::Unit(free_plain_.rows(), place);
    Eigen::VectorXd of_v = free_plain_.col(place);
    const auto take_out = [&] {
      const Eigen::VectorXd parts = result.leftCols(count).transpose() * of_v;
      v.noalias() -= result.leftCols(count) * parts;
      of_v.noalias() -= image.leftCols(count) * parts;
    };
    take_out();
    const double left = v.dot(of_v);
    if (!(left >= kIndependent * kIndependent)) continue;
    v /= std::sqrt(left);
    of_v /= std::sqrt(left);
    take_out();
    const double norm = std::sqrt(v.dot(of_v));
    result.col(count) = v / norm;
    image.col(count++) = of_v / norm;
  }
  return result.leftCols(count);
}

Eigen::MatrixXd ColumnTest::CorrelationOf(const Eigen::MatrixXd& basis) const {
  if (is_white_) return Eigen::MatrixXd::Identity(basis.cols(), basis.cols());
  return basis.transpose() * free_correlated_ * basis;
}

ColumnTest::Part ColumnTest::AskBasis(const Eigen::MatrixXd& basis) const {
  Part part{.columns = static_cast<std::size_t>(basis.cols())};
  if (part.columns == 0 || !(variance_ > 0)) return part;
  const Eigen::VectorXd explained = basis.transpose() * free_residual_;
  const Eigen::MatrixXd correlated = CorrelationOf(basis);
  const double f = is_white_
                       ? explained.squaredNorm() / static_cast<double>(basis.cols()) / variance_
                       : WaldF(explained, correlated, variance_);
  const double of_noise = variance_ * correlated.trace();
  part.rms = std::sqrt(std::max(0.0, explained.squaredNorm() - of_noise) / samples_);
  // If nothing is explained, or less by rounding, noise alone makes it.
  part.p_value = f > 0 ? PValueOfF(f, static_cast<double>(part.columns), degrees_of_freedom_) : 1.0;
  return part;
}

ColumnTest::Part ColumnTest::Ask(std::span<const Eigen::Index> places) const {
  return AskBasis(Orthonormal(places));
}

double ColumnTest::p_value() const { return AskBasis(all_).p_value; }

double ColumnTest::misfit_over_noise() const {
  const Eigen::VectorXd explained = all_.transpose() * free_residual_;
  const double of_noise = CorrelationOf(all_).trace();
  return std::sqrt(std::max(0.0, explained.squaredNorm() / variance_ - of_noise) / samples_);
}

LinearStep ColumnTest::Step(std::span<const Eigen::Index> places) const {
  std::vector<Eigen::Index> both(static_cast<std::size_t>(law_));
  std::iota(both.begin(), both.end(), Eigen::Index{0});
  for (const Eigen::Index place : places) both.push_back(law_ + place);
  const Eigen::MatrixXd products = plain_(both, both);
  const Eigen::MatrixXd factor = Inverse(products);
  const Eigen::VectorXd step = -factor * residual_(both);
  const Eigen::MatrixXd covariance = variance_ * factor * correlated_(both, both) * factor;
  const double gain = -step.dot(products * step) - 2 * step.dot(residual_(both));
  const auto error = [&](Eigen::Index j) {
    return std::sqrt(std::max(covariance(j, j), variance_ * factor(j, j)));
  };
  LinearStep result;
  result.explains = sum_of_squares_ > 0 ? std::clamp(gain / sum_of_squares_, 0.0, 1.0) : 0.0;
  const double first = norms_[law_ + places[0]];
  result.size = step[law_] / first;
  result.size_error = error(law_) / first;
  for (Eigen::Index j = 0; j < law_; ++j) {
    result.step.push_back(step[j] / norms_[j]);
    result.error.push_back(error(j) / norms_[j]);
  }
  return result;
}

}  // namespace mindahl::identification
