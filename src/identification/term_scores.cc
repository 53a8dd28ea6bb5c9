#include "identification/term_scores.h"

#include <algorithm>
#include <cmath>

#include "core/probability.h"
#include "identification/gram/gram.h"
#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/problem/problem.h"
#include "identification/solved_fit.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

/// Takes a column for one that the others have where less of its norm is its own.
constexpr double kOwnShare = 3e-5;

/// θ of a problem at the fit's solution, with terms that the fit does not have without effect: an
/// exponent, of which that is any value, where it starts.
std::vector<double> ThetaOf(const Problem& problem, const FitResult& fit) {
  std::vector<double> theta;
  for (const Parameter& parameter : problem.parameters) {
    const std::size_t p = theta.size();
    const ParameterEstimate* const fitted = fit.Find(problem.parameters.NameOf(p));
    const bool stays =
        parameter.fixed || parameter.term->positive || parameter.term->name.ends_with("_exponent");
    theta.push_back(fitted != nullptr               ? parameter.ToTheta(fitted->value)
                    : p == kRig && !parameter.fixed ? parameter.upper
                    : stays                         ? parameter.theta
                                                    : parameter.ToTheta(0.0));
  }
  return theta;
}

/// Scores the columns of some parameters that are added to a fit.
/// @param inside  parameters of the fit that are not at a bound, with the columns of `at`
TermScore ScoreColumns(const Problem& problem, std::span<const std::size_t> inside,
                       const Linearization& at, const Evidence& evidence,
                       std::span<const std::size_t> added, const Eigen::MatrixXd& columns) {
  const Gram gram(at.jacobian, columns, at.residual, kOwnShare);
  const GramAxes axes = gram.AxesOfAll();
  const GramStep step = gram.StepBy(axes, axes.values.inverse());
  TermScore score{.parameters = added.size()};
  for (Eigen::Index c = 0; const std::size_t p : added) {
    score.is_negative |= step.omitted[c++] < 0 && problem.parameters[p].term->is_never_negative;
  }
  for (std::size_t j = 0; j < inside.size() && inside[j] <= kSlipForce; ++j) {
    score.law[inside[j]] = step.law[static_cast<Eigen::Index>(j)];
  }
  const auto samples = static_cast<double>(problem.data->counted);
  const double rounding = samples * kRoundingRms * kRoundingRms;
  const double without = gram.sum_of_squares() + rounding;
  const double with = std::max(without - axes.coefficients.square().sum(), rounding);
  score.rms = problem.data->force * std::sqrt(with / samples);
  score.gain = 1 - std::sqrt(with / without);
  const double ratio = evidence.LikelihoodRatio(without, with);
  if (ratio > 0) score.p_value = PValueOfChiSquared(ratio, static_cast<double>(axes.values.size()));
  return score;
}

}  // namespace

FitOptions TermChoice::AddedTo(FitOptions options) const {
  for (const std::string& term : terms) {
    if (!HasTerm(options, term)) options.terms.push_back(term);
  }
  const bool has_it = std::ranges::count(options.covariates, covariate) > 0;
  if (!covariate.empty() && !has_it) options.covariates.push_back(covariate);
  return options;
}

std::vector<std::optional<TermScore>> ScoreTerms(std::span<const loop::RecordView> records,
                                                 const FitResult& fit, const FitOptions& options,
                                                 std::span<const TermChoice> choices) {
  FitOptions with_all = options;
  for (const TermChoice& choice : choices) with_all = choice.AddedTo(std::move(with_all));
  const ScaledRecords data = ScaledAsFitted(records, options, with_all, fit);
  const auto problem_of = [&](FitOptions with) {
    with.covariates = with_all.covariates;
    with.start.clear();
    return Problem(data, with, fit.initial_state);
  };
  const auto was_free = [&](const Problem& problem, std::size_t p) {
    const ParameterEstimate* const fitted = fit.Find(problem.parameters.NameOf(p));
    return fitted != nullptr && fitted->status != ParameterStatus::kFixed;
  };
  const Problem fitted = problem_of(options);
  const std::vector<double> theta = ThetaOf(fitted, fit);
  std::vector<std::size_t> inside;
  for (const std::size_t p : fitted.parameters.free()) {
    const bool is_inside = SideOf(fitted.parameters[p], theta[p]) == BoundSide::kInside;
    if (is_inside && was_free(fitted, p)) inside.push_back(p);
  }
  const Linearization at = Response(fitted).LinearizeAt(theta, inside);
  const Evidence evidence = EvidenceOf(fitted, theta);
  std::vector<std::optional<TermScore>> scores;
  for (const TermChoice& choice : choices) {
    std::optional<TermScore>& score = scores.emplace_back();
    try {
      const Problem problem = problem_of(choice.AddedTo(options));
      std::vector<std::size_t> added;
      for (const std::size_t p : problem.parameters.free()) {
        const Parameter& parameter = problem.parameters[p];
        const bool is_other =
            parameter.term->of_column && parameter.covariate.name != choice.covariate;
        if (!is_other && !was_free(problem, p)) added.push_back(p);
      }
      if (added.empty()) continue;
      const Linearization with = Response(problem).LinearizeAt(ThetaOf(problem, fit), added);
      score = ScoreColumns(problem, inside, at, evidence, added, with.jacobian);
    } catch (const InvalidArgument&) {
      continue;  // no lag where time does not go on
    }
  }
  return scores;
}

}  // namespace mindahl::identification
