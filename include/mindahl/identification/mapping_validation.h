#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
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

/// Returns the tolerance on relative errors of σ and Tc, and errors of α, of a noise-free loop.
double NoiseFreeTolerance(double lambda);

/// Largest distance of truth and fit under noise, in standard errors: the square root of twice
/// the difference of log-likelihoods, χ² with three degrees of freedom squared; beyond it once in
/// 10⁷.
inline constexpr double kStandardErrorsTolerated = 6.0;

/// Coverage of 95 % intervals that docs/coverage.md promises under white noise: at least, and,
/// where the contact slips as a whole, at most. In partial slip intervals may be wider.
inline constexpr double kLowestCoverage = 0.93;
inline constexpr double kHighestCoverage = 0.97;

/// Chance that a validation rejects coverages that are all within what is promised.
inline constexpr double kCoverageFalseAlarm = 1e-3;

/// The parameters whose intervals are counted.
inline constexpr std::array<std::string_view, 3> kValidatedParameters = {"sigma", "alpha",
                                                                         "slip_force"};

/// Intervals of one parameter, of independent loops, and how many of them contain the truth.
struct IntervalCount {
  std::size_t intervals = 0;
  std::size_t covering = 0;

  void Add(const IntervalCount& other) {
    intervals += other.intervals;
    covering += other.covering;
  }
  /// Returns the fraction that covers; 0 of none.
  [[nodiscard]] double fraction() const {
    return intervals == 0 ? 0.0 : static_cast<double>(covering) / static_cast<double>(intervals);
  }
  /// Returns the probability of so few intervals that cover where each covers with kLowestCoverage:
  /// the binomial distribution. 1 of none.
  [[nodiscard]] double ChanceOfSoFew() const;
  /// Returns the probability of so many where each covers with kHighestCoverage. 1 of none.
  [[nodiscard]] double ChanceOfSoMany() const;
};

/// Coverage of the intervals of one parameter by one law, over all loops with noise.
struct CoverageVerdict {
  std::string_view parameter;
  bool by_dahl = false;  ///< true if fitted with Dahl's own law
  IntervalCount all = {};
  IntervalCount sliding = {};  ///< those of loops with λ > 1
  double chance = 1.0;         ///< the smaller of all's of so few, and sliding's of so many
  bool passed = true;          ///< not less than kCoverageFalseAlarm over the number of tests
};

struct ErrorSpread {
  double median = 0.0;
  double worst = 0.0;
};

/// All cases at one amplitude and noise level.
struct ValidationRow {
  double lambda = 0.0;
  double noise = 0.0;
  std::size_t cases = 0;
  std::size_t failures = 0;      ///< not converged, or an error above the tolerance
  std::size_t undetermined = 0;  ///< a parameter reported as not identifiable
  double tolerance = 0.0;        ///< noise-free: on the errors; with noise: in standard errors
  /// Holds the errors |σ/(8a/G*) − 1|, |α − 1/3| and |Tc/(μN) − 1|.
  std::array<ErrorSpread, kValidatedParameters.size()> errors = {};
  double worst_standardized =
      0.0;  ///< with noise: largest distance of the truth in standard errors
  double coverage =
      0.0;  ///< with noise: fraction of the stated 95 % intervals that cover the truth
  std::array<IntervalCount, kValidatedParameters.size()> intervals;  ///< with noise: by parameter
};

struct ValidationReport {
  std::vector<ValidationRow> rows;  ///< in order of noise level, then amplitude
  /// Rows of Dahl's own law, fitted to each loop from its first extreme on. σ, α and Tc are
  /// then those of the Masing law with the same steady loop (models/steady_loop.h), standard
  /// errors and intervals those of Dahl's law itself.
  std::vector<ValidationRow> dahl_rows;
  std::size_t fits = 0;
  std::size_t failures = 0;
  std::vector<std::string> failed_cases;  ///< description of each failed case with its error
  std::vector<CoverageVerdict> coverage;  ///< in order of law, then parameter; empty without noise
  /// Coverages that contradict the stated confidence.
  std::vector<std::string> failed_coverages;

  [[nodiscard]] bool passed() const { return failures == 0 && failed_coverages.empty(); }
};

/// Draws contacts with N in 1e-6 … 1e5 N, a in 1e-8 … 3e-2 m, G* in 1e-12 … 1e-8 1/Pa (all
/// log-uniform), μ in 0.05 … 1.2, one to four cycles, both starting directions, sine and triangle;
/// their loops from the Mindlin equations in closed form (contact module, not the fitted models),
/// fits them with free α by either law and compares. Coverage is judged by binomial tests, two a
/// parameter and law over all rows with noise, at kCoverageFalseAlarm over their number.
/// @throws InvalidArgument for options out of range
ValidationReport ValidateMapping(const ValidationOptions& options);

}  // namespace mindahl::identification
