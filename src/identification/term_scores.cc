#include "identification/term_scores.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "core/probability.h"
#include "identification/dense.h"
#include "identification/inference/noise.h"
#include "identification/problem/moved_samples.h"
#include "identification/problem/scaled_records.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

/// Takes a column of unit norm for one that the others have where less of its square is its own.
constexpr double kOwnSquare = 1e-9;
/// Exponents at which the columns that they shape are tried.
constexpr std::array kTriedExponents = {0.25, 0.5, 1.0};
/// Fraction of the distance to a bound beyond which no search begins.
constexpr double kOfBound = 0.9;

/// Returns the θ at which a term has no effect; for an exponent that of a linear force.
double ThetaWithoutEffect(const Parameters& parameters, std::size_t p) {
  const Parameter& parameter = parameters[p];
  if (p == kRig || parameter.is_exponent()) return parameter.upper;
  return parameter.term->positive ? parameter.theta : parameter.ToTheta(0.0);
}

/// Solves the normal equations of some of the columns of unit norm, the residuals' products last.
Eigen::VectorXd StepBy(const Eigen::MatrixXd& products, const std::vector<Eigen::Index>& places) {
  Eigen::MatrixXd matrix = products(places, places);
  matrix.diagonal().array() += kOwnSquare;
  return -SolveSymmetric(matrix, products(places, products.cols() - 1));
}

/// Returns the sum of squares of the residuals after a step.
double SquaresAfter(const Eigen::MatrixXd& products, const std::vector<Eigen::Index>& places,
                    const Eigen::VectorXd& step) {
  const Eigen::Index last = products.cols() - 1;
  return products(last, last) + 2 * step.dot(products(places, last)) +
         step.dot(products(places, places) * step);
}

std::vector<Eigen::Index> Joined(std::vector<Eigen::Index> places,
                                 std::span<const Eigen::Index> more) {
  places.insert(places.end(), more.begin(), more.end());
  return places;
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
  AddColumns(with_all, prepared_, /*with_others=*/false, data_);
}

std::vector<std::vector<bool>> TermScores::LeftOut() const {
  std::vector<std::vector<bool>> left_out;
  for (const loop::PreparedRecord& record : prepared_.records) {
    std::vector<bool>& mask = left_out.emplace_back();
    for (const unsigned char counts : record.counts) mask.push_back(counts == 0);
  }
  return left_out;
}

Problem TermScores::ProblemOf(const FitOptions& options) const {
  FitOptions with_columns = options;
  with_columns.covariates = covariates_;
  with_columns.start.clear();
  return {&data_, options.model, state_, Parameters(data_, with_columns, state_)};
}

/// θ of a problem at the fit's solution, with terms that the fit does not have without effect.
std::vector<double> TermScores::ThetaOf(const Problem& problem) const {
  const Parameters& parameters = problem.parameters;
  std::vector<double> theta(parameters.size());
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const auto fitted = values_.find(parameters.NameOf(p));
    const bool is_new = fitted == values_.end() && !parameters[p].fixed;
    theta[p] = fitted != values_.end() ? parameters[p].ToTheta(fitted->second)
               : is_new                ? ThetaWithoutEffect(parameters, p)
                                       : parameters[p].theta;
  }
  return theta;
}

/// Adds the columns of a choice to those of all: of exponents that shape columns that the fit does
/// not have the value is taken with which the residuals become least.
std::vector<TermScores::Added> TermScores::AddColumnsOf(const TermChoice& choice,
                                                        const FitOptions& options,
                                                        std::vector<Eigen::VectorXd>& columns) {
  const Problem problem = ProblemOf(choice.AddedTo(options));
  const Parameters& parameters = problem.parameters;
  std::vector<double> theta = ThetaOf(problem);
  std::vector<std::size_t> added;
  bool shapes_new = false;
  std::optional<std::size_t> exponent;
  for (const std::size_t p : parameters.free()) {
    const Parameter& parameter = parameters[p];
    if (free_.contains(parameters.NameOf(p))) continue;
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
                                           .theta = theta[added[c]],
                                           .place = -1});
    if (derivatives.cols() == 0) continue;
    const auto column = derivatives.col(static_cast<Eigen::Index>(c));
    if (!(column.squaredNorm() > 0)) continue;
    one.place = at_fit_.jacobian.cols() + std::ssize(columns);
    columns.emplace_back(column);
  }
  return result;
}

void TermScores::StepFrom(const FitResult& fit, const FitOptions& options,
                          std::span<const TermChoice> choices) {
  state_ = fit.initial_state;
  values_.clear();
  free_.clear();
  for (const ParameterEstimate& estimate : fit.parameters) {
    values_.emplace(estimate.name, estimate.value);
    if (estimate.status != ParameterStatus::kFixed) free_.insert(estimate.name);
  }
  const Problem problem = ProblemOf(options);
  const std::vector<double> theta = ThetaOf(problem);
  std::vector<std::size_t> inside;
  for (const std::size_t p : problem.parameters.free()) {
    if (!free_.contains(problem.parameters.NameOf(p))) continue;
    if (SideOf(problem.parameters[p], theta[p]) == BoundSide::kInside) inside.push_back(p);
  }
  at_fit_ = LinearizeAt(problem, theta, response_, inside);
  names_.clear();
  for (const std::size_t p : inside) names_.push_back(problem.parameters.NameOf(p));
  const Eigen::VectorXd& residual = at_fit_.residual;
  freed_ = LeftOver(at_fit_.jacobian, residual);
  effective_samples_ = EffectiveSamples(problem, theta, response_);
  choices_.clear();
  std::vector<Eigen::VectorXd> columns;
  for (const TermChoice& choice : choices) {
    try {
      choices_.push_back(AddColumnsOf(choice, options, columns));
    } catch (const InvalidArgument&) {
      choices_.emplace_back();  // no lag where time does not go on
    }
  }
  TakeProducts(columns);
}

void TermScores::TakeProducts(const std::vector<Eigen::VectorXd>& columns) {
  const Eigen::Index of_law = at_fit_.jacobian.cols();
  const Eigen::Index count = of_law + std::ssize(columns);
  Eigen::MatrixXd all(at_fit_.jacobian.rows(), count + 1);
  all.leftCols(of_law) = at_fit_.jacobian;
  for (Eigen::Index c = of_law; c < count; ++c) {
    all.col(c) = columns[static_cast<std::size_t>(c - of_law)];
  }
  norms_ = all.leftCols(count).colwise().norm().transpose().unaryExpr(
      [](double norm) { return norm > 0 ? norm : 1.0; });
  for (Eigen::Index c = 0; c < count; ++c) all.col(c) /= norms_[c];
  all.col(count) = at_fit_.residual;
  products_ = TransposedProduct(all, all);
  of_fit_.resize(static_cast<std::size_t>(of_law));
  std::iota(of_fit_.begin(), of_fit_.end(), Eigen::Index{0});
  squares_of_fit_ = SquaresAfter(products_, of_fit_, StepBy(products_, of_fit_));
}

/// Writes the values of a choice's parameters after a step, well inside their bounds.
void TermScores::PutValues(std::size_t choice, const Eigen::VectorXd& step,
                           std::map<std::string, double>& to) const {
  Eigen::Index next = std::ssize(of_fit_);
  for (const Added& added : choices_[choice]) {
    const Parameter& parameter = added.parameter;
    double theta = added.theta;
    if (added.place >= 0) {
      const double moved = step[next++] / norms_[added.place];
      // The linear step of a rig is one of its compliance, which starts at zero.
      theta +=
          parameter.term->id == TermId::kRigStiffness ? -std::log(std::max(-moved, 1.0)) : moved;
    }
    const double inside =
        std::clamp(theta, kOfBound * parameter.lower + (1 - kOfBound) * parameter.upper,
                   kOfBound * parameter.upper + (1 - kOfBound) * parameter.lower);
    to[added.name] = parameter.ToValue(inside);
  }
}

std::optional<TermScore> TermScores::Of(std::size_t choice) const {
  std::vector<Eigen::Index> added;
  for (const Added& one : choices_[choice]) {
    if (one.place >= 0) added.push_back(one.place);
  }
  if (added.empty()) return std::nullopt;
  const std::vector<Eigen::Index> places = Joined(of_fit_, added);
  const Eigen::VectorXd step = StepBy(products_, places);
  TermScore score;
  PutValues(choice, step, score.values);
  for (const char* const name : {"sigma", "alpha", "slip_force"}) {
    const auto place = std::ranges::find(names_, name) - names_.begin();
    if (place < std::ssize(names_)) score.law.emplace(name, step[place] / norms_[place]);
  }
  const auto samples = static_cast<double>(data_.counted);
  const double rounding = samples * kRoundingRms * kRoundingRms;
  const double without = squares_of_fit_ + rounding;
  const double with = SquaresAfter(products_, places, step) + rounding;
  score.rms = data_.force * std::sqrt(with / samples);
  score.gain = 1 - std::sqrt(std::min(with / without, 1.0));
  const double ratio = Evidence(data_.counted, effective_samples_).LikelihoodRatio(without, with);
  if (ratio > 0) score.p_value = PValueOfChiSquared(ratio, static_cast<double>(added.size()));
  return score;
}

}  // namespace mindahl::identification
