#include "identification/term_scores.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/probability.h"
#include "identification/dense.h"
#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"
#include "identification/problem/motion.h"
#include "identification/problem/scaled_records.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

/// Takes a column for one that the others have where less of its norm is its own.
constexpr double kOwnShare = 3e-5;
/// Exponents at which the columns that they shape are tried.
constexpr std::array kTriedExponents = {0.25, 0.5, 1.0};
/// Fraction of the distance to a bound beyond which no search begins.
constexpr double kOfBound = 0.99;

/// Returns the θ at which a term has no effect; for an exponent that of a linear force.
double ThetaWithoutEffect(const Parameters& parameters, std::size_t p) {
  const Parameter& parameter = parameters[p];
  if (p == kRig || parameter.is_exponent()) return parameter.upper;
  return parameter.term->positive ? parameter.theta : parameter.ToTheta(0.0);
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

bool WasFree(const FitResult& fit, const std::string& name) {
  const ParameterEstimate* const fitted = fit.Find(name);
  return fitted != nullptr && fitted->status != ParameterStatus::kFixed;
}

}  // namespace

FitOptions TermChoice::AddedTo(FitOptions options) const {
  options.terms.insert(options.terms.end(), terms.begin(), terms.end());
  if (!covariate.empty()) options.covariates.push_back(covariate);
  return options;
}

TermScores::TermScores(std::span<const loop::RecordView> records, const FitOptions& options,
                       std::span<const TermChoice> choices) {
  FitOptions with_all = options;
  for (const TermChoice& choice : choices) {
    for (const std::string& term : choice.terms) {
      if (!HasTerm(with_all, term)) with_all.terms.push_back(term);
    }
    if (!choice.covariate.empty()) with_all.covariates.push_back(choice.covariate);
  }
  covariates_ = with_all.covariates;
  prepared_ = loop::Prepare(records, with_all.preparation);
  LeaveOutBeyondLags(with_all, prepared_);
  data_ = Scale(prepared_, options);
  AddColumns(with_all, prepared_, data_);
}

Problem TermScores::ProblemOf(const FitResult& fit, const FitOptions& options) const {
  const std::vector states(data_.records.size(), fit.initial_state);
  FitOptions with_columns = options;
  with_columns.covariates = covariates_;
  with_columns.start.clear();
  return {&data_, options.model, states, Parameters(data_, with_columns, states)};
}

/// Adds the columns of a choice to those of all: of exponents that shape columns that the fit does
/// not have the value is taken with which the residuals become least.
std::vector<TermScores::Added> TermScores::AddColumnsOf(const FitResult& fit,
                                                        const TermChoice& choice,
                                                        const FitOptions& options,
                                                        std::vector<Eigen::VectorXd>& columns) {
  const Problem problem = ProblemOf(fit, choice.AddedTo(options));
  const Parameters& parameters = problem.parameters;
  std::vector<double> theta = ThetaOf(problem, fit);
  std::vector<std::size_t> added;
  bool shapes_new = false;
  std::optional<std::size_t> exponent;
  for (const std::size_t p : parameters.free()) {
    const Parameter& parameter = parameters[p];
    if (WasFree(fit, parameters.NameOf(p))) continue;
    if (parameter.term->of_column && parameter.column_name != choice.covariate) continue;
    added.push_back(p);
    shapes_new = shapes_new || !parameter.is_exponent();
    if (parameter.is_exponent()) exponent = p;
  }
  const bool is_tried = exponent && shapes_new;
  double least = std::numeric_limits<double>::infinity();
  double best = 0.0;
  Eigen::MatrixXd derivatives;
  for (const double tried : kTriedExponents) {
    if (is_tried) theta[*exponent] = tried;
    Eigen::MatrixXd here = LinearizeAt(problem, theta, response_, added).jacobian;
    const double left = is_tried ? LeftOver(here, freed_).squaredNorm() : 0.0;
    if (left < least) {
      least = left;
      best = tried;
      derivatives = std::move(here);
    }
    if (!is_tried) break;
  }
  if (is_tried) theta[*exponent] = best;
  std::vector<Added> result;
  for (std::size_t c = 0; c < added.size(); ++c) {
    Added& one = result.emplace_back(Added{.name = parameters.NameOf(added[c]),
                                           .parameter = parameters[added[c]],
                                           .theta = theta[added[c]]});
    if (derivatives.cols() == 0) continue;
    const auto column = derivatives.col(static_cast<Eigen::Index>(c));
    if (!(column.squaredNorm() > 0)) continue;
    one.place = std::ssize(columns);
    columns.emplace_back(column);
  }
  return result;
}

void TermScores::StepFrom(const FitResult& fit, const FitOptions& options,
                          std::span<const TermChoice> choices) {
  for (std::size_t r = 0; r < data_.records.size(); ++r) {
    data_.records[r].turns_between = fit.records[r].turns_between;
  }
  const Problem problem = ProblemOf(fit, options);
  const std::vector<double> theta = ThetaOf(problem, fit);
  std::vector<std::size_t> inside;
  for (const std::size_t p : problem.parameters.free()) {
    if (!WasFree(fit, problem.parameters.NameOf(p))) continue;
    if (SideOf(problem.parameters[p], theta[p]) == BoundSide::kInside) inside.push_back(p);
  }
  const auto& [jacobian, residual] = LinearizeAt(problem, theta, response_, inside);
  names_.clear();
  for (const std::size_t p : inside) names_.push_back(problem.parameters.NameOf(p));
  freed_ = LeftOver(jacobian, residual);
  effective_samples_ = EffectiveSamples(problem, theta, response_);
  choices_.clear();
  std::vector<Eigen::VectorXd> columns;
  for (const TermChoice& choice : choices) {
    try {
      choices_.push_back(AddColumnsOf(fit, choice, options, columns));
    } catch (const InvalidArgument&) {
      choices_.emplace_back();  // no lag where time does not go on
    }
  }
  Eigen::MatrixXd omitted(residual.size(), std::ssize(columns));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    omitted.col(static_cast<Eigen::Index>(c)) = columns[c];
  }
  gram_.emplace(jacobian, omitted, residual, kOwnShare);
}

std::optional<TermScore> TermScores::Of(std::size_t choice) const {
  std::vector<Eigen::Index> places;
  for (const Added& added : choices_[choice]) {
    if (added.place) places.push_back(*added.place);
  }
  if (places.empty()) return std::nullopt;
  const GramAxes axes = gram_->AxesOf(places);
  const GramStep step = gram_->StepBy(axes, axes.values.inverse());
  TermScore score;
  for (const auto& [name, parameter, at, place] : choices_[choice]) {
    const double moved = place ? step.omitted[*place] : 0.0;
    // The linear step of a rig is one of its compliance, which starts at zero.
    const bool is_rig = place && parameter.term->id == TermId::kRigStiffness;
    const double theta = at + (is_rig ? -std::log(std::max(-moved, 1.0)) : moved);
    const double inside =
        std::clamp(theta, kOfBound * parameter.lower + (1 - kOfBound) * parameter.upper,
                   kOfBound * parameter.upper + (1 - kOfBound) * parameter.lower);
    score.values[name] = parameter.ToValue(inside);
  }
  for (const char* const name : {"sigma", "alpha", "slip_force"}) {
    const auto place = std::ranges::find(names_, name) - names_.begin();
    if (place < std::ssize(names_)) score.law.emplace(name, step.law[place]);
  }
  const auto samples = static_cast<double>(data_.counted);
  const double rounding = samples * kRoundingRms * kRoundingRms;
  const double without = gram_->sum_of_squares() + rounding;
  const double explained = axes.coefficients.square().sum();
  const double with = std::max(without - explained, rounding);
  score.rms = data_.force * std::sqrt(with / samples);
  score.gain = 1 - std::sqrt(with / without);
  const double ratio = Evidence(data_.counted, effective_samples_).LikelihoodRatio(without, with);
  if (ratio > 0) score.p_value = PValueOfChiSquared(ratio, static_cast<double>(places.size()));
  return score;
}

}  // namespace mindahl::identification
