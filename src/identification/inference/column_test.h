#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "identification/inference/departures.h"
#include "identification/inference/estimates.h"
#include "identification/inference/local.h"
#include "identification/inference/noise.h"
#include "identification/problem/problem.h"

namespace mindahl::identification {

/// Each column is paid for by so many samples, or it is not looked for.
inline constexpr std::size_t kSamplesAColumn = 8;

/// A linear step from a fit that lets some more columns in.
struct LinearStep {
  double explains = 0.0;      // fraction of the sum of squares
  double size = 0.0;          // factor of the first of them
  double size_error = 0.0;    // its standard error
  std::vector<double> step;   // of the law's columns
  std::vector<double> error;  // standard errors of these with it
};

/// Makes Wald tests for components of a fit's residuals along given columns, orthogonal to those of
/// its law. Noise is what all columns leave, with its autocorrelation: what a law misses is smooth
/// along the loop and would pass for autocorrelated noise otherwise.
class ColumnTest {
 public:
  /// @param law           columns of what is fitted already
  /// @param others        those that are asked for; all weighted, a row a sample
  /// @param residual      weighted
  /// @param displacement  what drawn errors of the displacement do to the residuals: noise too
  /// @param quieter       of the same samples by another law, whose noise it is; null: its own
  /// @param restores      does the noise get back what the columns took up of its autocorrelation?
  ColumnTest(const Problem& problem, const Noise& noise, const DisplacementEffect& displacement,
             const Eigen::MatrixXd& law, const Eigen::MatrixXd& others,
             const Eigen::VectorXd& residual, const ColumnTest* quieter = nullptr,
             bool restores = false);

  /// True if a column has a part orthogonal to the others, and there is noise to test against.
  [[nodiscard]] bool can_tell() const { return all_.cols() > 0 && variance_ > 0; }
  /// True if the noise is not white, nor drawn errors of the displacement among it: its
  /// autocorrelation is what the columns left of it.
  [[nodiscard]] bool is_correlated() const { return autocorrelation_.order > 0 && !has_drawn_; }
  /// Returns the variance of a weighted residual.
  [[nodiscard]] double variance() const { return variance_; }
  [[nodiscard]] double degrees_of_freedom() const { return degrees_of_freedom_; }
  /// Returns the number of independent samples of the noise.
  [[nodiscard]] double effective_samples() const { return effective_samples_; }
  /// Returns the probability that noise alone makes what all columns explain.
  [[nodiscard]] double p_value() const;
  /// rms of what all columns explain, less what they would of noise, over that of the noise.
  [[nodiscard]] double misfit_over_noise() const;

  struct Part {
    std::size_t columns = 0;  // with something of their own; 0: the law has them all
    double p_value = 1.0;     // that noise alone makes what these explain
    double rms = 0.0;         // of that, less what they would of noise; of a weighted residual
  };
  /// Some of the columns by themselves.
  [[nodiscard]] Part Ask(std::span<const Eigen::Index> places) const;
  [[nodiscard]] LinearStep Step(std::span<const Eigen::Index> places) const;

 private:
  [[nodiscard]] Eigen::MatrixXd FreedOfLaw(const Eigen::MatrixXd& products) const;
  [[nodiscard]] Eigen::MatrixXd Orthonormal(std::span<const Eigen::Index> places) const;
  [[nodiscard]] Part AskBasis(const Eigen::MatrixXd& basis) const;
  /// UᵀRU of orthonormal columns U by their coefficients in columns freed of the law.
  [[nodiscard]] Eigen::MatrixXd CorrelationOf(const Eigen::MatrixXd& basis) const;

  // The columns A of the law and of what is asked for, of unit norm, and their products with each
  // other and with the residuals: all that any question asks for, whatever the number of samples.
  Eigen::Index law_;
  double samples_;
  double sum_of_squares_;
  Eigen::VectorXd norms_;
  Eigen::MatrixXd plain_;       // AᵀA
  bool is_white_ = true;        // R = 1
  bool has_drawn_ = false;      // are drawn errors of the displacement among the noise?
  Eigen::MatrixXd correlated_;  // AᵀRA
  Eigen::VectorXd residual_;    // Aᵀr
  Eigen::MatrixXd inverse_of_law_;
  Eigen::MatrixXd shares_;           // of the law's columns in each of the others
  Eigen::MatrixXd free_plain_;       // the same products of the others freed of the law
  Eigen::MatrixXd free_correlated_;  // of noise that is not white
  Eigen::VectorXd free_residual_;    //
  Eigen::MatrixXd all_;              // orthonormal, of all that have something of their own
  Autocorrelation autocorrelation_;  // of what all columns leave
  double variance_ = 0.0;
  double degrees_of_freedom_ = 1.0;
  double effective_samples_ = 1.0;
};

/// Predicts the fit with one omitted term added, by one linear step; only the p-value of a term
/// that noise may well have made.
struct DepartureFit {
  std::size_t departure = 0;                  // its place in Departures()
  std::optional<std::size_t> covariate = {};  // which, among those of ScaledRecords
  double p_value = 1.0;                       // that noise alone makes it
  double delta_aicc = 0.0;                    // against the fit without
  double explains = 0.0;                      // fraction of the sum of squares
  double size = 0.0;                          // of its first column, in its unit
  double size_p_value = 1.0;                  // that noise alone makes that
  std::string_view unit = {};
  bool is_measured = false;        // without the model, and fitted as it was
  std::vector<double> step = {};   // of θ, one a free parameter
  std::vector<double> error = {};  // standard error of θ with it, likewise
};

/// Tests residuals against noise: what no omitted term explains counts as noise, with the
/// autocorrelation that it has. What the model misses is smooth along the loop and would pass for
/// autocorrelated noise otherwise.
struct AdequacyTest {
  double misfit_over_noise = 0.0;
  double p_value = 1.0;
  double noise = 0.0;               // standard deviation of a weighted residual
  double degrees_of_freedom = 1.0;  // of the noise
  double effective_samples = 1.0;   // of it
  std::vector<DepartureFit> fits;   // of the terms that the record can identify
};

/// @param displacement  what drawn errors of the displacement do to the residuals: that is noise
/// too
AdequacyTest TestAdequacy(const FittedProblem& fitted, const DisplacementEffect& displacement,
                          const Thresholds& thresholds, Response& response);

/// Returns the shift of a parameter by a term, in halves of its 95 % interval; 0 where it is open.
double MoveOf(const Problem& problem, const Solution& solution, const DepartureFit& fit,
              std::size_t parameter, const ParameterEstimate& estimate);

/// Inflates intervals to cover the parameters with each of the omitted terms.
void WidenByDepartures(const Problem& problem, const Solution& solution,
                       std::span<const DepartureFit> fits, double quantile,
                       std::span<ParameterEstimate> estimates);

}  // namespace mindahl::identification
