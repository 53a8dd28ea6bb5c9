#include "identification/gram/omitted_terms.h"

#include <Eigen/Core>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>

#include "core/probability.h"
#include "identification/gram/gram.h"
#include "identification/inference/estimates.h"
#include "identification/inference/noise.h"

namespace mindahl::identification {
namespace {

/// Noise of the residuals, where it is asked of their products: what no column explains.
struct NoiseLevel {
  double variance = 0.0;  // of a weighted residual
  double degrees = 1.0;   // of it
  bool is_known = false;
};

/// γ as a random vector.
struct RandomTerms {
  double p_value = 1.0;   // likelihood of τ = 0 over the largest: no less than its chance
  double variance = 0.0;  // of the noise
  Eigen::ArrayXd gains;   // of the axes
};

/// Maximises the marginal likelihood of the residuals over τ²/s² and s², which along the axes is a
/// product of Gaussians of variance s²·noise + τ²·value.
RandomTerms EstimateTerms(const GramAxes& axes, const NoiseLevel& noise) {
  const Eigen::ArrayXd squares = axes.coefficients.square();
  const double degrees = static_cast<double>(axes.values.size()) + noise.degrees;
  const auto spread = [&](double ratio) -> Eigen::ArrayXd {
    return axes.noise + ratio * axes.values;
  };
  const auto variance = [&](double ratio) {
    if (noise.is_known) return noise.variance;
    return ((squares / spread(ratio)).sum() + noise.degrees * noise.variance) / degrees;
  };
  const auto cost = [&](double ratio) {  // −2 ln L
    const double of_noise = noise.is_known ? (squares / spread(ratio)).sum() / noise.variance
                                           : degrees * std::log(variance(ratio));
    return spread(ratio).log().sum() + of_noise;
  };
  const auto cost_of_log = [&](double log_ratio) { return cost(std::exp(log_ratio)); };
  constexpr int kNothing = -8;  // of ln τ²/s²
  constexpr int kAll = 24;
  double best = kNothing;
  for (int log_ratio = kNothing; log_ratio <= kAll; ++log_ratio) {
    if (cost_of_log(log_ratio) < cost_of_log(best)) best = log_ratio;
  }
  constexpr int kBits = 20;
  best = boost::math::tools::brent_find_minima(cost_of_log, best - 1, best + 1, kBits).first;
  const double ratio = std::exp(best);
  return {.p_value = std::min(1.0, std::exp((cost(ratio) - cost(0.0)) / 2)),
          .variance = variance(ratio),
          .gains = ratio / spread(ratio)};
}

}  // namespace

std::vector<OmittedTerm> CausesOf(std::vector<OmittedTerm> terms, const Thresholds& thresholds) {
  std::erase_if(terms, [&](const OmittedTerm& term) {
    return !(term.p_value < thresholds.rare_chance && term.delta_aicc < 0);
  });
  std::ranges::stable_sort(terms, {}, &OmittedTerm::delta_aicc);
  const double best = terms.empty() ? 0.0 : terms.front().explains;
  std::erase_if(terms,
                [&](const OmittedTerm& term) { return term.explains < thresholds.rival * best; });
  // Causes that a fit can model come first: the user can try only those.
  std::ranges::stable_partition(terms, [](const OmittedTerm& term) { return !term.term.empty(); });
  return terms;
}

AdequacyTest TestAdequacy(const Estimates& fitted) {
  const Thresholds& thresholds = fitted.thresholds();
  const Problem& problem = fitted.problem();
  const Solution& solution = fitted.solution();
  const Noise& noise = fitted.noise();
  const ScaledRecords& data = *problem.data;
  auto [jacobian, residual] = fitted.WithPriors();
  // A parameter at a bound, the user's or the program's, cannot move: its column explains nothing.
  for (Eigen::Index j = 0; const std::size_t p : problem.parameters.free()) {
    auto column = jacobian.col(j++);
    if (SideOf(problem.parameters[p], solution.theta[p]) != BoundSide::kInside) column.setZero();
  }
  const auto law = static_cast<double>(jacobian.cols());
  const auto samples = static_cast<double>(data.counted);
  if (samples <= law + 1) return {};
  const auto most = static_cast<std::size_t>((samples - law) / thresholds.samples_a_column);
  DepartureColumns departures = ColumnsOfDepartures(problem, solution.theta, thresholds, most);
  if (departures.terms.empty()) return {};
  const Eigen::Index readings = departures.columns.rows();
  departures.columns.conservativeResizeLike(
      Eigen::MatrixXd::Zero(jacobian.rows(), departures.columns.cols()));
  Gram gram(jacobian, departures.columns, residual, thresholds.own_part);
  GramAxes axes = gram.AxesOfAll();
  const GramStep best = gram.StepBy(axes, axes.values.inverse());
  const Eigen::VectorXd left = residual + jacobian * best.law + departures.columns * best.omitted;
  const Autocorrelation process =
      EstimateAutocorrelation(data.records, {left.data(), static_cast<std::size_t>(readings)});
  if (!process.coefficients.empty() || noise.drawn.size() > 0 || !noise.of_records.empty()) {
    Eigen::MatrixXd columns(readings, jacobian.cols() + departures.columns.cols());
    columns << jacobian.topRows(readings), departures.columns.topRows(readings);
    gram.SetNoise(noise.Product(data.records, process, columns));
    axes = gram.AxesOfAll();
  }
  AdequacyTest test;
  const auto own = static_cast<double>(axes.values.size());
  const double effective_samples = samples / process.SquaredCorrelations();
  test.degrees_of_freedom = std::max(1.0, effective_samples - law - own);
  // A fit absorbs more of correlated noise than the number of its parameters.
  const double absorbed = std::min(gram.absorbed() + axes.noise.sum(), samples / 2);
  const NoiseLevel level{
      .variance = noise.is_known ? noise.variance : left.squaredNorm() / (samples - absorbed),
      .degrees = test.degrees_of_freedom,
      .is_known = noise.is_known};
  if (axes.values.size() == 0 || !(level.variance > 0)) return test;
  const RandomTerms terms = EstimateTerms(axes, level);
  const GramStep step = gram.StepBy(axes, terms.gains);
  double explained = (terms.gains * axes.values * axes.coefficients).square().sum();
  test.step = step.law;
  test.error = (terms.variance * step.covariance.diagonal()).cwiseMax(0.0).cwiseSqrt();

  const Evidence evidence{data.counted, effective_samples};
  double least = 1.0;
  for (OmittedTerm& term : departures.terms) {
    const GramAxes of_term = gram.AxesOf(term.places);
    const auto columns = static_cast<double>(of_term.values.size());
    if (columns == 0) continue;
    const Eigen::ArrayXd squares = of_term.coefficients.square();
    const double f = (squares / of_term.noise).mean() / level.variance;
    term.p_value = f > 0 ? PValueOfF(f, columns, level.degrees) : 1.0;
    if (term.p_value < thresholds.rare_chance) {
      term.explains = std::clamp(squares.sum() / gram.sum_of_squares(), 0.0, 1.0);
      term.step = gram.StepBy(of_term, of_term.values.inverse()).law;
      term.delta_aicc = 2 * columns - evidence.LikelihoodRatio(1.0, 1.0 - term.explains);
    }
    // Under autocorrelated noise the F test of a single term is too liberal.
    if (process.coefficients.empty()) {
      least = std::min(least, term.p_value);
      explained = std::max(explained, term.explains * gram.sum_of_squares());
    }
    ++test.adequacy.tried;
  }
  const double misfit_over_noise = std::sqrt(explained / samples / level.variance);
  test.adequacy.misfit_over_noise = misfit_over_noise;
  test.adequacy.misfit = misfit_over_noise * std::sqrt(level.variance) * data.response_unit();
  // Two tests are made, of all terms together and of the one that noise alone makes least often.
  test.adequacy.p_value = std::min(terms.p_value, 2 * gram.IndependentTests() * least);
  test.causes = CausesOf(std::move(departures.terms), thresholds);
  test.adequacy.causes.assign(test.causes.begin(), test.causes.end());
  return test;
}

}  // namespace mindahl::identification
