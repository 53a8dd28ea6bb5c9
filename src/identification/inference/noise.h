#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace mindahl::identification {

/// The autocorrelation of a fit's residuals: an autoregressive process, the same for all records,
///   r_t = Σ φ_k r_{t−k} + ε_t,  k = 1 … p
/// found by Yule and Walker's equations (which make it stable), its order by Schwarz's criterion.
/// Loops leave residuals that are never white: what a model misses is smooth along the loop.
struct Autocorrelation {
  static constexpr std::size_t kHighestOrder = 12;

  std::size_t order = 0;                                 // p; 0 when the residuals are white
  std::array<double, kHighestOrder> coefficients{};      // φ₁ … φ_p
  std::array<double, kHighestOrder + 1> correlations{};  // ρ₀ … ρ_p, the sample's
  double innovation_share = 1.0;                         // variance of ε over that of r

  /// 1 + 2Σρ_k² over all lags: as many correlated residuals determine a variance as well as one
  /// independent one does (Bartlett 1946).
  [[nodiscard]] double SquaredCorrelations() const;

  /// R·columns with R that matrix: filtered backwards, then forwards.
  [[nodiscard]] Eigen::MatrixXd Apply(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;

  /// JᵀRJ with R the correlation matrix of one record's residuals, without ever forming it: the
  /// columns are filtered backwards by 1/φ, on to earlier times until they have decayed.
  /// @param columns  J of one record, a row a sample in order of time
  /// @returns columns², relative error below 1e-8
  [[nodiscard]] Eigen::MatrixXd Quadratic(const Eigen::Ref<const Eigen::MatrixXd>& columns) const;
};

/// @param residuals  one series a record
/// @param counts     of each sample, 0 where it is left out; of the same sizes
Autocorrelation EstimateAutocorrelation(std::span<const std::span<const double>> residuals,
                                        std::span<const std::span<const unsigned char>> counts);

/// The autocorrelation of noise of which the residuals are what orthonormal columns Q leave, which
/// take up most of what is slow in it: the process whose covariances Γ, as the residuals would have
/// them, (1 − QQᵀ)Γ(1 − QQᵀ) along its diagonals, are the measured ones.
/// @param columns  Q, a row a sample of all series one after the other
Autocorrelation EstimateAutocorrelationBeside(
    std::span<const std::span<const double>> residuals,
    std::span<const std::span<const unsigned char>> counts, const Eigen::MatrixXd& columns);

/// The one account of the noise of a fit, in units of the data: whoever states an error, compares
/// two fits or counts samples asks it.
struct Noise {
  double variance = 0.0;           // of a weighted residual
  bool is_known = false;           // it was given, not estimated
  double force = 0.0;              // standard deviation of the force's own, of all records
  std::vector<double> of_records;  // of each record's own, where they differ in it; else empty
  Autocorrelation autocorrelation;
  double repeating = 1.0;           // by how much a repeatable residual widens a variance
  std::vector<double> force_share;  // σ_F/√(σ_F² + σ_T²) of each sample; empty where δ is exact
  std::size_t outliers = 0;         // samples at less than half their weight
  std::size_t samples = 0;          // that count
  double confidence = 0.95;         // of the intervals that follow from it

  /// Returns the effective sample size, at least 1: n/(1 + 2Σρ²) for autocorrelated residuals, and
  /// one stroke's samples for what repeats in every stroke.
  [[nodiscard]] double effective_samples() const;
  /// Returns those of the variance: effective samples less fitted parameters, at least 1;
  /// practically infinite where it is known.
  [[nodiscard]] double degrees_of_freedom(std::size_t parameters) const;
};

}  // namespace mindahl::identification
