#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "identification/inference/noise.h"
#include "identification/problem/problem.h"
#include "identification/solve/solver.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

using ParameterEstimates = std::vector<ParameterEstimate>;

/// Longest linear step of θ that an interval takes: beyond a factor of e³ it says only that little
/// is known.
inline constexpr double kFarthestStep = 3.0;

/// Ends of an interval, or of a part of one; empty where it is open.
struct Ends {
  std::optional<double> lower = {};
  std::optional<double> upper = {};
};

/// Returns the value at a bound that is the user's or the theory's; empty at a limit of the search,
/// which says nothing of what lies beyond.
std::optional<double> ValueAtBound(const Parameter& parameter, BoundSide side);

/// Returns the values of an interval of θ; an end beyond a bound is ValueAtBound().
Ends EndsWithinBounds(const Parameter& parameter, double from, double to);

/// Begins the interval anew. An end that is not finite is open; there is no standard error then.
void SetInterval(ParameterEstimate& estimate, Ends ends);

/// Extends the interval by a part: an end that is open in either is open from then on. Leaves an
/// estimate without an interval, held or undetermined, as it is.
void Include(ParameterEstimate& estimate, Ends ends);

/// A problem with its solution and its noise, and standard errors, intervals and correlations from
/// the likelihood's parabola at its maximum. Never fails: by the singular values of the Jacobian,
/// columns scaled to unit norm, it knows which parameters the data leave open.
class Estimates {
 public:
  /// @param problem  with `solution`, `noise` and `options`, must outlive this
  /// @param at       the problem by all its free parameters, near the solution
  Estimates(const Problem& problem, const Solution& solution, const Noise& noise,
            const FitOptions& options, Linearization at);

  [[nodiscard]] const Problem& problem() const { return problem_; }
  [[nodiscard]] const Solution& solution() const { return solution_; }
  [[nodiscard]] const Noise& noise() const { return noise_; }
  [[nodiscard]] const FitOptions& options() const { return options_; }
  [[nodiscard]] const Thresholds& thresholds() const { return options_.thresholds; }

  /// Fills an estimate; its identifiability is the judge's.
  void Fill(std::size_t parameter, ParameterEstimate& estimate) const;

  /// NaN where either parameter is fixed or undetermined.
  [[nodiscard]] double Correlation(std::size_t row, std::size_t column) const;

  /// Standard error of θ; infinite where it is not determined, 0 where fixed.
  [[nodiscard]] double ErrorOfTheta(std::size_t parameter) const;

  /// Returns the number of directions in θ without effect on the residual.
  [[nodiscard]] std::size_t open_directions() const { return open_directions_; }
  /// Returns F of a fit with the parameter held, or another in its place, against the solution: the
  /// rise of the sum of squares over the noise, times the ratio of the parameter's white variance
  /// to its variance.
  [[nodiscard]] double FStatistic(std::size_t parameter, double sum_of_squares) const;
  /// θ of the parabola's least cost where one parameter, which is free, is moved by a step.
  [[nodiscard]] std::vector<double> Beside(std::size_t parameter, double step) const;
  /// Returns the number of samples on which a parameter rests: (Σh²)²/Σh⁴ of the influences h of
  /// the samples on its θ (Kish 1965), n where they have the same.
  [[nodiscard]] double SamplesOf(std::size_t parameter) const;
  /// Returns the half width of an interval in standard errors.
  [[nodiscard]] double quantile() const { return quantile_; }
  /// Returns the F beyond which a held parameter is outside its interval.
  [[nodiscard]] double critical() const { return quantile_ * quantile_; }
  /// Returns the half width of the parabola's interval of θ.
  [[nodiscard]] double HalfWidth(std::size_t parameter) const {
    return quantile_ * ErrorOfTheta(parameter);
  }
  /// Returns the Jacobian by all free parameters at the solution, and the weighted residuals.
  [[nodiscard]] const Linearization& linearization() const { return at_; }
  /// The same, with each prior of a free parameter as one more reading: a row at the end.
  [[nodiscard]] Linearization WithPriors() const;

 private:
  /// Returns the place among the free parameters; nothing of one that is fixed or undetermined.
  [[nodiscard]] std::optional<Eigen::Index> PlaceOf(std::size_t parameter) const;

  const Problem& problem_;
  const Solution& solution_;
  const Noise& noise_;
  const FitOptions& options_;
  double quantile_;
  double variance_;
  Linearization at_;
  // A row and a column a free parameter; times the variance of a residual the covariance:
  Eigen::MatrixXd factor_;  // (JᵀJ)⁻¹·JᵀRJ·(JᵀJ)⁻¹ where determined, JᵀRJ by the noise
  Eigen::MatrixXd white_factor_;    // (JᵀJ)⁻¹: what white residuals would give
  Eigen::ArrayX<bool> determined_;  // of each: no part in a direction without effect
  std::size_t open_directions_ = 0;
};

/// Returns what a solution says of the parameters that are reported: values, without errors.
std::vector<ParameterEstimate> ValuesOf(const Problem& problem, const Solution& solution);

}  // namespace mindahl::identification
