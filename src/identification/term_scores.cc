#include "identification/term_scores.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/probability.h"
#include "identification/dense.h"
#include "identification/inference/local.h"
#include "identification/problem/moved_samples.h"
#include "identification/problem/scaled_records.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {

using loop::RecordView;

namespace {

/// Parts of so many strokes each.
std::vector<Part> PartsOf(const FitResult& fit, const SampleMask& mask, std::size_t skip_cycles,
                          std::size_t strokes, std::size_t least) {
  std::vector<Part> parts;
  const std::size_t first = skip_cycles > 0 ? 2 * skip_cycles - 1 : 0;
  for (std::size_t r = 0; r < mask.size(); ++r) {
    const std::vector<std::size_t>& reversals = fit.records[r].reversals;
    std::vector<Part> closed;
    for (std::size_t j = first; j + strokes < reversals.size(); j += strokes) {
      Part part{.record = r, .begin = reversals[j], .end = reversals[j + strokes]};
      for (std::size_t i = part.begin; i < part.end; ++i) part.samples += mask[r][i];
      if (part.samples > 0) closed.push_back(part);
    }
    if (closed.size() >= least) parts.insert(parts.end(), closed.begin(), closed.end());
  }
  return parts;
}

/// Returns those that the options hold out, and the parts of one fold.
std::vector<std::vector<bool>> HeldOut(std::span<const RecordView> records,
                                       const FitOptions& options, std::span<const Part> parts,
                                       std::size_t fold, std::size_t folds) {
  std::vector<std::vector<bool>> mask = options.preparation.held_out;
  mask.resize(records.size());
  for (std::size_t r = 0; r < records.size(); ++r) mask[r].resize(records[r].size(), false);
  for (std::size_t c = fold; c < parts.size(); c += folds) {
    std::vector<bool>& held_out = mask[parts[c].record];
    std::fill(held_out.begin() + static_cast<std::ptrdiff_t>(parts[c].begin),
              held_out.begin() + static_cast<std::ptrdiff_t>(parts[c].end), true);
  }
  return mask;
}

}  // namespace

bool IsFitted(const FitResult& fit) { return !fit.parameters.empty(); }

ScoredSamples CountedSamples(const FitResult& fit, std::span<const RecordView> records) {
  ScoredSamples samples;
  double half_range = 0.0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const std::vector<unsigned char>& counts = fit.records[r].counts;
    samples.mask.emplace_back(counts);
    samples.count += counts.size() - fit.records[r].left_out;
    const auto [lowest, highest] = std::ranges::minmax(records[r].force);
    half_range = std::max(half_range, highest / 2 - lowest / 2);
  }
  samples.rounding = kRoundingRms * half_range;
  return samples;
}

double SumOfSquares(double rms, const ScoredSamples& samples) {
  const double in_units = kRoundingRms * rms / samples.rounding;
  return static_cast<double>(samples.count) * in_units * in_units;
}

std::vector<Part> ClosedCycles(const FitResult& fit, const SampleMask& mask,
                               std::size_t skip_cycles) {
  return PartsOf(fit, mask, skip_cycles, 2, 2);
}

std::vector<Part> Strokes(const FitResult& fit, const SampleMask& mask, std::size_t skip_cycles) {
  return PartsOf(fit, mask, skip_cycles, 1, 4);
}

void HoldInitialStates(const FitResult& fit, FitOptions& options) {
  options.initial_states.clear();
  for (const RecordFit& record : fit.records) {
    options.initial_states.push_back(record.initial_state);
  }
}

FitOptions ContinuedFrom(const FitResult& fit, FitOptions options) {
  options.model = fit.model;
  HoldInitialStates(fit, options);
  options.preparation.force_sense = fit.force_sense;
  options.starts = 1;
  for (const ParameterEstimate& parameter : fit.parameters) {
    if (parameter.status == ParameterStatus::kFixed) continue;
    // One that ran to a bound stays there.
    (parameter.status == ParameterStatus::kFree ? options.start : options.fixed)[parameter.name] =
        parameter.value;
  }
  return options;
}

std::vector<double> PredictParts(std::span<const RecordView> records, FitOptions options,
                                 std::size_t free, const ScoredSamples& samples,
                                 std::span<const Part> parts, std::size_t folds) {
  std::vector<double> mean_square(parts.size(), 0.0);
  const FitOptions whole = options;
  for (std::size_t fold = 0; fold < folds; ++fold) {
    options.preparation.held_out = HeldOut(records, whole, parts, fold, folds);
    auto left = static_cast<double>(samples.count);
    for (std::size_t c = fold; c < parts.size(); c += folds) left -= parts[c].samples;
    if (left < static_cast<double>(free)) return {};
    Fitter fitter(options);
    const FitResult& fit = fitter.Fit(records, Depth::kEstimate);
    if (!fit.converged) return {};
    for (std::size_t c = fold; c < parts.size(); c += folds) {
      const Part& part = parts[c];
      for (std::size_t i = part.begin; i < part.end; ++i) {
        if (samples.mask[part.record][i] == 0) continue;
        const double error = fit.records[part.record].residual[i];
        mean_square[c] += error * error / part.samples;
      }
    }
  }
  return mean_square;
}

MeanOverParts Mean(std::span<const double> values, std::span<const Part> parts, std::size_t folds) {
  double samples = 0.0;
  double sum = 0.0;
  for (std::size_t c = 0; c < values.size(); ++c) {
    samples += parts[c].samples;
    sum += parts[c].samples * values[c];
  }
  MeanOverParts result{.mean = sum / samples};
  double squares = 0.0;
  for (std::size_t c = 0; c < values.size(); ++c) {
    const double deviation = parts[c].samples / samples * (values[c] - result.mean);
    squares += deviation * deviation;
  }
  const auto count = static_cast<double>(values.size());
  const auto of_folds = static_cast<double>(folds);
  result.standard_error =
      std::sqrt(squares * count / (count - 1) * (1 + of_folds / (of_folds - 1)));
  return result;
}

double ChanceOfMean(const MeanOverParts& mean, std::size_t parts) {
  const double t = mean.standard_error > 0 ? mean.mean / mean.standard_error : 0.0;
  const double beyond = PValueOfF(t * t, static_cast<double>(parts - 1)) / 2;
  return t > 0 ? beyond : 1 - beyond;
}

bool PredictsWorse(std::span<const double> other, std::span<const double> best,
                   std::span<const Part> cycles, std::size_t folds, double rounding) {
  if (other.empty() || best.empty()) return false;
  std::vector<double> difference;
  difference.reserve(cycles.size());
  for (std::size_t c = 0; c < cycles.size(); ++c) difference.push_back(other[c] - best[c]);
  const MeanOverParts mean = Mean(difference, cycles, folds);
  return mean.mean > mean.standard_error + rounding * rounding;
}

namespace {

/// Takes a column of unit norm for one that the others have where less of its square is its own.
constexpr double kOwnSquare = 1e-9;
/// Exponents at which the columns that they shape are tried.
constexpr std::array kTriedExponents = {0.25, 0.5, 1.0};
/// Fraction of the distance to a bound beyond which no search begins.
constexpr double kOfBound = 0.9;

bool IsExponent(const Parameter& parameter) { return parameter.term->name.ends_with("_exponent"); }

/// Returns the θ at which a term has no effect; for an exponent that of a linear force.
double ThetaWithoutEffect(const Parameters& parameters, std::size_t p) {
  const Parameter& parameter = parameters[p];
  if (p == kRig) return parameter.upper;
  if (IsExponent(parameter)) return parameter.upper;
  return parameter.term->positive ? parameter.theta : parameter.ToTheta(0.0);
}

FitOptions WithTerms(FitOptions options, std::span<const std::string> terms) {
  for (const std::string& term : terms) {
    if (!HasTerm(options, term)) options.terms.push_back(term);
  }
  return options;
}

/// Prepares the records, less the samples that do not count under one of the terms.
loop::PreparedRecords PreparedFor(std::span<const loop::RecordView> records,
                                  const FitOptions& options, Arena& arena) {
  loop::PreparedRecords prepared = loop::Prepare(records, options.preparation, &arena);
  LeaveOutBeyondLags(options, prepared);
  return prepared;
}

}  // namespace

TermScores::TermScores(std::span<const loop::RecordView> records, const FitOptions& options,
                       std::span<const std::string> terms, std::span<const std::string> covariates)
    : TermScores(records, options, WithTerms(options, terms),
                 {covariates.begin(), covariates.end()}) {}

TermScores::TermScores(std::span<const loop::RecordView> records, const FitOptions& options,
                       const FitOptions& with_all, std::vector<std::string> covariates)
    : covariates_(std::move(covariates)),
      prepared_(PreparedFor(records, with_all, arena_)),
      data_(Scale(prepared_, options, &arena_)) {
  AddCovariates(covariates_, false, prepared_, options.offsets, data_);
  AddColumnsOfTerms(with_all, data_);
  if (HasTerm(with_all, TermId::kLag)) SetClocks(data_);
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
  return {&data_, options.model, state_,
          Parameters(data_, with_columns, state_, std::pmr::get_default_resource())};
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

void TermScores::StepFrom(const FitResult& fit, const FitOptions& options,
                          std::span<const Part> parts, std::size_t folds) {
  state_ = fit.initial_state;
  parts_ = parts;
  folds_ = folds;
  values_.clear();
  free_.clear();
  for (const ParameterEstimate& estimate : fit.parameters) {
    values_.emplace(estimate.name, estimate.value);
    if (estimate.status != ParameterStatus::kFixed) free_.insert(estimate.name);
  }
  const Problem problem = ProblemOf(options);
  const std::vector<double> theta = ThetaOf(problem);
  std::vector<std::size_t> inside;
  names_.clear();
  for (const std::size_t p : problem.parameters.free()) {
    if (!free_.contains(problem.parameters.NameOf(p))) continue;
    if (SideOf(problem.parameters[p], theta[p]) == BoundSide::kInside) inside.push_back(p);
  }
  for (const std::size_t p : inside) names_.push_back(problem.parameters.NameOf(p));
  at_fit_ = LinearizeAt(problem, theta, response_, inside);
}

TermScore TermScores::OfFit() const {
  Eigen::VectorXd step;
  return Solve(at_fit_.jacobian, step);
}

std::optional<TermScore> TermScores::Of(const FitOptions& with) {
  const Problem problem = ProblemOf(with);
  const Parameters& parameters = problem.parameters;
  std::vector<double> theta = ThetaOf(problem);
  std::vector<std::size_t> added;
  bool shapes_new = false;  // columns that the fit does not have
  for (const std::size_t p : parameters.free()) {
    const Parameter& parameter = parameters[p];
    if (free_.contains(parameters.NameOf(p))) continue;
    const bool is_asked_for = std::ranges::any_of(with.covariates, [&](const std::string& column) {
      return column == parameter.column_name;
    });
    if (parameter.term->of_column && !is_asked_for) continue;
    added.push_back(p);
    shapes_new = shapes_new || !IsExponent(parameter);
  }
  const auto exponent =
      std::ranges::find_if(added, [&](std::size_t p) { return IsExponent(parameters[p]); });
  const bool is_tried = exponent != added.end() && shapes_new;
  const Eigen::MatrixXd& fitted = at_fit_.jacobian;
  std::optional<TermScore> best;
  for (const double tried : kTriedExponents) {
    if (is_tried) theta[*exponent] = tried;
    const Eigen::MatrixXd derivatives = LinearizeAt(problem, theta, response_, added).jacobian;
    std::vector<Eigen::Index> effective;
    for (Eigen::Index c = 0; c < derivatives.cols(); ++c) {
      if (derivatives.col(c).squaredNorm() > 0) effective.push_back(c);
    }
    if (effective.empty()) return std::nullopt;
    const auto more = static_cast<Eigen::Index>(effective.size());
    Eigen::MatrixXd columns(fitted.rows(), fitted.cols() + more);
    columns.leftCols(fitted.cols()) = fitted;
    for (Eigen::Index c = 0; c < more; ++c) {
      columns.col(fitted.cols() + c) = derivatives.col(effective[static_cast<std::size_t>(c)]);
    }
    Eigen::VectorXd step;
    TermScore score = Solve(columns, step);
    score.p_value = TestEffects(columns.rightCols(more));
    if (!best || score.rms < best->rms) {
      for (const std::string_view name : {"sigma", "alpha", "slip_force"}) {
        const auto place = std::ranges::find(names_, name) - names_.begin();
        if (place < fitted.cols()) score.law.emplace(name, step(place));
      }
      for (const std::size_t p : added) score.values[parameters.NameOf(p)] = theta[p];
      for (Eigen::Index c = 0; c < more; ++c) {
        const std::size_t p =
            added[static_cast<std::size_t>(effective[static_cast<std::size_t>(c)])];
        score.values[parameters.NameOf(p)] += step(fitted.cols() + c);
      }
      for (const std::size_t p : added) {
        const Parameter& parameter = parameters[p];
        double& value = score.values[parameters.NameOf(p)];
        // The linear step of a rig is one of its compliance, which starts at zero.
        if (p == kRig) value = theta[p] - std::log(std::max(theta[p] - value, 1.0));
        const double inside =
            std::clamp(value, kOfBound * parameter.lower + (1 - kOfBound) * parameter.upper,
                       kOfBound * parameter.upper + (1 - kOfBound) * parameter.lower);
        value = parameter.ToValue(inside);
      }
      best = std::move(score);
    }
    if (!is_tried) break;
  }
  return best;
}

std::vector<std::pair<Eigen::Index, Eigen::Index>> TermScores::RowsOfParts() const {
  std::vector<Eigen::Index> begins;
  Eigen::Index begin = 0;
  for (const ScaledRecord& record : data_.records) {
    begins.push_back(begin);
    begin += static_cast<Eigen::Index>(record.size());
  }
  std::vector<std::pair<Eigen::Index, Eigen::Index>> rows;
  for (const Part& part : parts_) {
    rows.emplace_back(begins[part.record] + static_cast<Eigen::Index>(part.begin),
                      static_cast<Eigen::Index>(part.end - part.begin));
  }
  return rows;
}

/// Tests whether the products of the residuals with the terms' columns, freed of the fit's, have a
/// mean over the parts: by F, as Hotelling's T², of parts that are independent of each other. Their
/// scatter is that of the residuals with the terms: a trend has little effect on the parts in the
/// middle, which is no scatter. Where the terms weigh the same in all parts it is T² itself.
std::optional<double> TermScores::TestEffects(const Eigen::MatrixXd& added) const {
  constexpr std::size_t kLeastDegrees = 3;
  const auto terms = static_cast<std::size_t>(added.cols());
  const std::size_t parts = parts_.size();
  if (parts < terms + kLeastDegrees) return std::nullopt;
  const Eigen::MatrixXd freed = LeftOver(at_fit_.jacobian, added);
  const Eigen::VectorXd before = LeftOver(at_fit_.jacobian, at_fit_.residual);
  const Eigen::VectorXd after = LeftOver(freed, before);
  const auto rows = RowsOfParts();
  Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(added.cols(), added.cols());
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(added.cols());
  const auto count = static_cast<double>(parts);
  for (const auto& [first, samples] : rows) {
    const auto columns = freed.middleRows(first, samples);
    mean += columns.transpose() * before.segment(first, samples) / count;
    const Eigen::VectorXd effect = columns.transpose() * after.segment(first, samples);
    scatter += effect * effect.transpose() / (count - 1);
  }
  Eigen::Index rank = 0;
  const Eigen::VectorXd weighed = SolveLeastSquares(scatter, mean, &rank);
  if (rank < added.cols()) return std::nullopt;
  const auto columns = static_cast<double>(terms);
  const double t_squared = count * mean.dot(weighed);
  return PValueOfF((count - columns) / (columns * (count - 1)) * t_squared, columns,
                   count - columns);
}

/// Solves the normal equations of all samples, and of all without each fold.
/// @param step  written: of all samples, by the columns as they are
TermScore TermScores::Solve(const Eigen::MatrixXd& columns, Eigen::VectorXd& step) const {
  const Eigen::VectorXd norms =
      columns.colwise().norm().transpose().unaryExpr([](double n) { return n > 0 ? n : 1.0; });
  const Eigen::MatrixXd unit = columns * norms.cwiseInverse().asDiagonal();
  const Eigen::MatrixXd whole = TransposedProduct(unit, unit);
  const Eigen::VectorXd& residual = at_fit_.residual;
  const Eigen::VectorXd wanted = -(unit.transpose() * residual);
  const auto solve = [&](Eigen::MatrixXd matrix, const Eigen::VectorXd& vector) {
    matrix.diagonal().array() += kOwnSquare;
    return Eigen::VectorXd(SolveSymmetric(matrix, vector));
  };
  TermScore score;
  const Eigen::VectorXd solution = solve(whole, wanted);
  step = solution.cwiseQuotient(norms);
  score.rms = data_.force * std::sqrt((residual + unit * solution).squaredNorm() /
                                      static_cast<double>(data_.counted));
  const auto rows_of_parts = RowsOfParts();
  score.predictions.resize(parts_.size());
  for (std::size_t fold = 0; fold < folds_; ++fold) {
    Eigen::MatrixXd matrix = whole;
    Eigen::VectorXd vector = wanted;
    for (std::size_t c = fold; c < parts_.size(); c += folds_) {
      const auto [first, count] = rows_of_parts[c];
      const auto rows = unit.middleRows(first, count);
      matrix -= TransposedProduct(rows, rows);
      vector.noalias() += rows.transpose() * residual.segment(first, count);
    }
    const Eigen::VectorXd without = solve(std::move(matrix), vector);
    for (std::size_t c = fold; c < parts_.size(); c += folds_) {
      const auto [first, count] = rows_of_parts[c];
      const double squares =
          (residual.segment(first, count) + unit.middleRows(first, count) * without).squaredNorm();
      score.predictions[c] = squares * data_.force * data_.force / parts_[c].samples;
    }
  }
  return score;
}

}  // namespace mindahl::identification
