#include "identification/term_scores.h"

#include <algorithm>
#include <cmath>

#include "core/probability.h"
#include "identification/gram/gram.h"
#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/problem/motion.h"
#include "identification/problem/problem.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/preparation.h"

namespace mindahl::identification {
namespace {

/// Takes a column for one that the others have where less of its norm is its own.
constexpr double kOwnShare = 3e-5;

/// Returns the θ at which a term has no effect, which of an exponent is any: where it starts.
double ThetaWithoutEffect(const Parameters& parameters, std::size_t p) {
  const Parameter& parameter = parameters[p];
  if (p == kRig) return parameter.upper;
  const bool is_any = parameter.term->positive || parameter.is_exponent();
  return is_any ? parameter.theta : parameter.ToTheta(0.0);
}

/// θ of a problem at the fit's solution, with terms that the fit does not have without effect.
std::vector<double> ThetaOf(const Problem& problem, const FitResult& fit) {
  const Parameters& parameters = problem.parameters;
  std::vector<double> theta(parameters.size());
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const ParameterEstimate* const fitted = fit.Find(parameters.NameOf(p));
    theta[p] = fitted != nullptr     ? parameters[p].ToTheta(fitted->value)
               : parameters[p].fixed ? parameters[p].theta
                                     : ThetaWithoutEffect(parameters, p);
  }
  return theta;
}

/// Scores the choices of one fit.
class Scorer {
 public:
  Scorer(std::span<const loop::RecordView> records, const FitResult& fit, const FitOptions& options,
         std::span<const TermChoice> choices);

  std::optional<TermScore> Score(const TermChoice& choice);

 private:
  [[nodiscard]] Problem ProblemOf(FitOptions options) const;
  [[nodiscard]] bool WasFree(const Problem& problem, std::size_t p) const;
  [[nodiscard]] TermScore ScoreColumns(const Problem& problem, std::span<const std::size_t> added,
                                       const Eigen::MatrixXd& columns) const;

  const FitResult& fit_;
  const FitOptions& options_;
  std::vector<std::string> covariates_;  // of all choices
  ScaledRecords data_;
  Response response_;
  std::vector<std::size_t> inside_;  // its parameters that are not at a bound
  Linearization at_;                 // by these
  double effective_samples_ = 1.0;
};

Scorer::Scorer(std::span<const loop::RecordView> records, const FitResult& fit,
               const FitOptions& options, std::span<const TermChoice> choices)
    : fit_(fit), options_(options) {
  FitOptions with_all = options;
  for (const TermChoice& choice : choices) with_all = choice.AddedTo(std::move(with_all));
  covariates_ = with_all.covariates;
  loop::PreparedRecords prepared = loop::Prepare(records, options.preparation);
  LeaveOutBeyondLags(options, prepared);
  data_ = Scale(prepared, options);
  AddColumns(with_all, prepared, data_);
  for (std::size_t r = 0; r < data_.records.size(); ++r) {
    data_.records[r].turns_between = fit.records[r].turns_between;
  }
  const Problem problem = ProblemOf(options);
  const std::vector<double> theta = ThetaOf(problem, fit);
  for (const std::size_t p : problem.parameters.free()) {
    const bool is_inside = SideOf(problem.parameters[p], theta[p]) == BoundSide::kInside;
    if (is_inside && WasFree(problem, p)) inside_.push_back(p);
  }
  at_ = LinearizeAt(problem, theta, response_, inside_);
  effective_samples_ = EffectiveSamples(problem, theta, response_);
}

Problem Scorer::ProblemOf(FitOptions options) const {
  options.covariates = covariates_;
  options.start.clear();
  return Problem(data_, options, fit_.initial_state);
}

bool Scorer::WasFree(const Problem& problem, std::size_t p) const {
  const ParameterEstimate* const fitted = fit_.Find(problem.parameters.NameOf(p));
  return fitted != nullptr && fitted->status != ParameterStatus::kFixed;
}

std::optional<TermScore> Scorer::Score(const TermChoice& choice) {
  const Problem problem = ProblemOf(choice.AddedTo(options_));
  std::vector<std::size_t> added;
  for (const std::size_t p : problem.parameters.free()) {
    const Parameter& parameter = problem.parameters[p];
    const bool is_other = parameter.term->of_column && parameter.column_name != choice.covariate;
    if (!is_other && !WasFree(problem, p)) added.push_back(p);
  }
  if (added.empty()) return std::nullopt;
  const Linearization at = LinearizeAt(problem, ThetaOf(problem, fit_), response_, added);
  return ScoreColumns(problem, added, at.jacobian);
}

TermScore Scorer::ScoreColumns(const Problem& problem, std::span<const std::size_t> added,
                               const Eigen::MatrixXd& columns) const {
  const Gram gram(at_.jacobian, columns, at_.residual, kOwnShare);
  const GramAxes axes = gram.AxesOfAll();
  const GramStep step = gram.StepBy(axes, axes.values.inverse());
  TermScore score{.parameters = added.size()};
  for (std::size_t c = 0; c < added.size(); ++c) {
    const bool is_lower = step.omitted[static_cast<Eigen::Index>(c)] < 0;
    const Term& term = *problem.parameters[added[c]].term;
    score.is_negative = score.is_negative || (is_lower && term.is_never_negative);
  }
  for (std::size_t j = 0; j < inside_.size() && inside_[j] <= kSlipForce; ++j) {
    score.law[inside_[j]] = step.law[static_cast<Eigen::Index>(j)];
  }
  const auto samples = static_cast<double>(data_.counted);
  const double rounding = samples * kRoundingRms * kRoundingRms;
  const double without = gram.sum_of_squares() + rounding;
  const double with = std::max(without - axes.coefficients.square().sum(), rounding);
  score.rms = data_.force * std::sqrt(with / samples);
  score.gain = 1 - std::sqrt(with / without);
  const double ratio = Evidence(data_.counted, effective_samples_).LikelihoodRatio(without, with);
  const auto columns_of_its_own = static_cast<double>(axes.values.size());
  if (ratio > 0) score.p_value = PValueOfChiSquared(ratio, columns_of_its_own);
  return score;
}

}  // namespace

FitOptions TermChoice::AddedTo(FitOptions options) const {
  for (const std::string& term : terms) {
    if (!HasTerm(options, term)) options.terms.push_back(term);
  }
  if (!covariate.empty()) options.covariates.push_back(covariate);
  return options;
}

std::vector<std::optional<TermScore>> ScoreTerms(std::span<const loop::RecordView> records,
                                                 const FitResult& fit, const FitOptions& options,
                                                 std::span<const TermChoice> choices) {
  Scorer scorer(records, fit, options, choices);
  std::vector<std::optional<TermScore>> scores;
  for (const TermChoice& choice : choices) {
    try {
      scores.push_back(scorer.Score(choice));
    } catch (const InvalidArgument&) {
      scores.emplace_back();  // no lag where time does not go on
    }
  }
  return scores;
}

}  // namespace mindahl::identification
