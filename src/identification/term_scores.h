#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "identification/gram/gram.h"
#include "identification/problem/problem.h"
#include "mindahl/identification/fit.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/loop/record.h"

namespace mindahl::identification {

/// Terms that may be added together, or a column of the records.
struct TermChoice {
  std::vector<std::string> terms;
  std::string covariate;  // its name; empty where it is none

  [[nodiscard]] FitOptions AddedTo(FitOptions options) const;
};

/// Predicts, to first order, a fit with some more terms.
struct TermScore {
  double gain = 0.0;                     // fraction by which the choice lowers the rms
  double p_value = 1.0;                  // that chance alone makes its effect
  double rms = 0.0;                      // of all samples after the step [N]
  std::map<std::string, double> values;  // of its parameters, for a search to begin with
  std::map<std::string, double> law;     // by how much θ of σ, α and Tc moves
};

/// Scores terms by one Gauss-Newton step from a fit that does not have them, by the products of its
/// Jacobian and the derivatives by the terms' parameters. Exact for terms that are linear.
class TermScores {
 public:
  /// @param options  of the fits, with the sign of the force that was found
  /// @param choices  all that will be asked for
  /// @throws InvalidArgument as a fit with them would
  TermScores(std::span<const loop::RecordView> records, const FitOptions& options,
             std::span<const TermChoice> choices);

  [[nodiscard]] const loop::PreparedRecords& prepared() const { return prepared_; }

  /// Takes a fit to step from.
  /// @param options  of that fit
  /// @param choices  that are scored; one without terms or a column has no effect
  void StepFrom(const FitResult& fit, const FitOptions& options,
                std::span<const TermChoice> choices);

  /// Returns the score of a choice, by its place; nothing where it has no effect here.
  [[nodiscard]] std::optional<TermScore> Of(std::size_t choice) const;

 private:
  /// A parameter that a choice adds.
  struct Added {
    std::string name;
    Parameter parameter;
    double theta = 0.0;                      // at which the derivatives are
    std::optional<Eigen::Index> place = {};  // of its column; empty where it has no effect
  };
  [[nodiscard]] Problem ProblemOf(const FitResult& fit, const FitOptions& options) const;
  [[nodiscard]] std::vector<Added> AddColumnsOf(const FitResult& fit, const TermChoice& choice,
                                                const FitOptions& options,
                                                std::vector<Eigen::VectorXd>& columns);

  std::vector<std::string> covariates_;
  loop::PreparedRecords prepared_;
  ScaledRecords data_;
  Response response_;
  // The fit from which the steps are taken:
  double effective_samples_ = 1.0;
  std::vector<std::string> names_;  // of those that are inside their bounds
  Eigen::VectorXd freed_;           // what these leave of the residuals
  std::vector<std::vector<Added>> choices_;
  std::optional<Gram> gram_;  // of the fit and the columns of all choices
};

}  // namespace mindahl::identification
