#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace mindahl::identification {

/// A sweep that tests whether fits of Mindlin loops return σ = 8a/G* and α = 1/3: by Masing's law,
/// and by Dahl's own (eq. 10) on the steady part, through its own mapping.
struct ValidationOptions {
  std::size_t cases = 500;  ///< contacts; each is fitted at every noise level
  std::uint64_t seed = 1;
  /// Standard deviation of the force noise over the loop's peak force T*.
  std::vector<double> noise_levels = {0.0, 1e-3, 1e-2, 5e-2};
  /// Amplitudes X/δc, taken in turn.
  std::vector<double> lambdas = {0.3, 0.5, 0.8, 1.0, 1.2, 2.0, 3.0};
};

/// Tolerance on the relative errors of σ and Tc and on the error of α of a noise-free loop.
double NoiseFreeTolerance(double lambda);

/// With noise, the truth may lie this many standard errors from the fit: the square root of twice
/// the difference of log-likelihoods, χ² with three degrees of freedom squared; beyond it once in
/// 10⁷.
inline constexpr double kStandardErrorsTolerated = 6.0;

/// All cases at one amplitude and noise level.
struct ValidationRow {
  double lambda = 0.0;
  double noise = 0.0;
  std::size_t cases = 0;
  std::size_t failures = 0;         ///< not converged, or an error above the tolerance
  std::size_t undetermined = 0;     ///< a parameter reported as not identifiable
  double tolerance = 0.0;           ///< noise-free: on the errors; with noise: in standard errors
  double median_sigma_error = 0.0;  ///< |σ/(8a/G*) − 1|
  double worst_sigma_error = 0.0;
  double median_alpha_error = 0.0;  ///< |α − 1/3|
  double worst_alpha_error = 0.0;
  double median_slip_force_error = 0.0;  ///< |Tc/(μN) − 1|
  double worst_slip_force_error = 0.0;
  double worst_standardized =
      0.0;                ///< with noise: largest distance of the truth in standard errors
  double coverage = 0.0;  ///< with noise: share of the stated 95 % intervals that cover the truth
};

struct ValidationReport {
  std::vector<ValidationRow> rows;  ///< by noise level, then amplitude
  /// Likewise of Dahl's own law, fitted to each loop from its first extreme on. σ, α and Tc are
  /// then those of the Masing law with the same steady loop (models/equivalent_law.h), standard
  /// errors and intervals those of Dahl's law itself.
  std::vector<ValidationRow> dahl_rows;
  std::size_t fits = 0;
  std::size_t failures = 0;
  std::vector<std::string> failed_cases;  ///< what each failed case was and by how much it missed
};

/// Draws contacts with N in 1e-6 … 1e5 N, a in 1e-8 … 3e-2 m, G* in 1e-12 … 1e-8 1/Pa (all
/// log-uniform), μ in 0.05 … 1.2, one to four cycles, both starting directions, sine and triangle;
/// their loops from the Mindlin equations in closed form (contact module, not the fitted models),
/// fits them with free α by either law and compares.
/// @param progress  called with the number of contacts done, may be empty
/// @throws InvalidArgument for options out of range
ValidationReport ValidateMapping(const ValidationOptions& options,
                                 const std::function<void(std::size_t)>& progress = {});

}  // namespace mindahl::identification
