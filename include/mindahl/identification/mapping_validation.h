#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace mindahl::identification {

/// A sweep that tests whether fits of Mindlin loops return σ = 8a/G* and α = 1/3.
struct ValidationOptions {
  std::size_t cases = 500;  ///< contacts; each is fitted at every noise level
  std::uint64_t seed = 1;
};

/// Standard deviations of the force noise over the loop's peak force T*.
inline constexpr std::array kNoiseLevels = {0.0, 1e-3, 1e-2, 5e-2};

/// Amplitudes X/δc, taken in turn.
inline constexpr std::array kLambdas = {0.3, 0.5, 0.8, 1.0, 1.2, 2.0, 3.0};

/// All cases at one amplitude and noise level.
struct ValidationRow {
  double lambda = 0.0;
  double noise = 0.0;
  std::size_t cases = 0;
  std::size_t failures = 0;      ///< not converged, or an error above the tolerance
  std::size_t undetermined = 0;  ///< a parameter reported as not identifiable
  /// Largest error of a noise-free loop; with noise largest distance of truth and fit, in standard
  /// errors: the root of twice the difference of log-likelihoods.
  double tolerance = 0.0;
  /// Largest |σ/(8a/G*) − 1|, |α − 1/3| and |Tc/(μN) − 1|
  std::array<double, 3> errors = {};
  double worst_standardized = 0.0;  ///< with noise: largest distance of truth and fit, likewise
  std::size_t intervals = 0;        ///< with noise: 95 % intervals that were stated
  std::size_t covering = 0;         ///< of these, those that cover the truth
};

struct ValidationReport {
  std::vector<ValidationRow> rows;        ///< in order of noise level, amplitude
  std::vector<std::string> failed_cases;  ///< description of each failure with its error
};

/// Draws contacts with N in 1e-6 … 1e5 N, a in 1e-8 … 3e-2 m, G* in 1e-12 … 1e-8 1/Pa (all
/// log-uniform), μ in 0.05 … 1.2, one to four cycles, both directions, sine and triangle; fits
/// their loops by the closed Mindlin equations (contact module) with free α and compares.
/// @throws InvalidArgument where there is no case
ValidationReport ValidateMapping(const ValidationOptions& options);

}  // namespace mindahl::identification
