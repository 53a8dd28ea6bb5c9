#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "identification/problem/problem.h"
#include "identification/problem/scaled_records.h"
#include "mindahl/identification/adequacy.h"
#include "mindahl/identification/fit_result.h"
#include "mindahl/identification/thresholds.h"

namespace mindahl::identification {

/// Describes the residuals that count; differences are taken within a record. Effective samples,
/// which need the noise, are left at 0.
ResidualStatistics DescribeResiduals(std::span<const RecordFit> records);

/// Returns the variance [N² or m²] of the white part of the residuals that count: 2/3 of the mean
/// square of a residual's distance from the middle of its neighbours (Gasser, Sroka &
/// Jennen-Steinmetz 1986).
double WhiteVariance(const FitResult& result);

/// Makes a one-way analysis of variance of a record's residuals over parts of each main stroke, as
/// many as it has samples, but 20 to 200.
/// @param residual  of the record's samples, in any unit
ResidualStructure DescribeStructure(const ScaledRecord& record, std::span<const double> residual,
                                    const Thresholds& thresholds);

/// The autocorrelation of a fit's residuals: an autoregressive process, the same for all records,
///   r_t = Σ φ_k r_{t−k} + ε_t,  k = 1 … p
/// found by Yule and Walker's equations (which make it stable), its order by Schwarz's criterion.
/// Loops leave residuals that are never white: what a model misses is smooth along the loop.
struct Autocorrelation {
  std::vector<double> coefficients = {};     // φ₁ … φ_p; none when the residuals are white
  std::vector<double> correlations = {1.0};  // ρ₀ … ρ_p, the sample's
  double innovation_share = 1.0;             // variance of ε over that of r

  /// 1 + 2Σρ_k² over all lags: as many correlated residuals determine a variance as well as one
  /// independent one does (Bartlett 1946).
  [[nodiscard]] double SquaredCorrelations() const;

  /// JᵀRJ with R the correlation matrix of one record's residuals, which is not formed: columns²,
  /// relative error below 1e-8. J has a row a sample, in order of time.
  [[nodiscard]] Eigen::MatrixXd Quadratic(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
};

/// @param residual  of every sample of the records; those that do not count are left out
Autocorrelation EstimateAutocorrelation(std::span<const ScaledRecord> records,
                                        std::span<const double> residual);

/// The noise of a fit, in units of the data.
struct Noise {
  double variance = 0.0;           // of a weighted residual
  bool is_known = false;           // it was given, not estimated
  double force = 0.0;              // standard deviation of the force's own, of all records
  std::vector<double> of_records;  // variances over that of all; empty of one, and where known
  Autocorrelation autocorrelation;
  double repeating = 1.0;       // by how much a repeatable residual widens a variance
  Eigen::VectorXd force_share;  // σ_F/√(σ_F² + σ_T²) of each sample; empty where δ is exact
  Eigen::MatrixXd drawn;        // weighted residuals that errors of δ make, a column a draw
  std::size_t outliers = 0;     // samples at less than half their weight
  std::size_t samples = 0;      // that count

  /// Returns the effective sample size, at least 1: n/(1 + 2Σρ²) for autocorrelated residuals, and
  /// one stroke's samples for what repeats in every stroke.
  [[nodiscard]] double effective_samples() const;
  /// Returns those of the variance: effective samples less fitted parameters, at least 1;
  /// practically infinite where it is known.
  [[nodiscard]] double degrees_of_freedom(std::size_t parameters) const;

  /// Returns JᵀRJ of all records, each times its own variance over that of all; where the
  /// displacement has errors JᵀSRSJ + JᵀEEᵀJ/(K s²), S the force's fraction of the noise and E the
  /// K drawn residuals. R has the correlations of the process.
  /// @param jacobian  weighted, of every sample
  [[nodiscard]] Eigen::MatrixXd Product(std::span<const ScaledRecord> records,
                                        const Autocorrelation& process,
                                        const Eigen::MatrixXd& jacobian) const;
};

/// Returns the samples that count, over the variance inflation from the residuals' autocorrelation.
double EffectiveSamples(const ScaledRecords& data, std::span<const double> residual);

/// Compares two fits to the same samples; every comparison of fits uses it.
struct Evidence {
  std::size_t samples;  // that count
  double effective;     // as many independent ones as say the same, of what is compared

  /// 2 ln Λ of the fit with the smaller sum of squares against the other: n_eff·ln(SS₀/SS₁), of
  /// sums that are both no less than rounding errors leave.
  [[nodiscard]] double LikelihoodRatio(double held, double free) const;

  /// Akaike's criterion with its small-sample term (Hurvich & Tsai 1989), for Gaussian residuals of
  /// unknown variance. The effective samples weigh the likelihood only: a wrong law leaves a
  /// handful of them, for which the small-sample term would outweigh any difference of two fits.
  [[nodiscard]] double Aicc(double sum_of_squares, std::size_t parameters) const;
};

/// Returns the evidence of a solution's residuals, with at least one effective sample more than
/// free parameters.
Evidence EvidenceOf(const Problem& problem, std::span<const double> theta);

/// Returns the mean squares of each record's residuals, weighted and not all zero, over that of
/// all.
std::vector<double> VariancesOfRecords(const ScaledRecords& data, std::span<const double> residual);

}  // namespace mindahl::identification
