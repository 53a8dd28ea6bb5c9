#include "identification/inference/reweighting.h"

#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "identification/inference/noise.h"
#include "identification/solve/search.h"
#include "loop/statistics.h"

namespace mindahl::identification {

Eigen::MatrixXd ForceErrors(const loop::DrawnReadings& drawn, const Problem& problem,
                            std::span<const double> theta) {
  const std::size_t samples = problem.size();
  Response response;
  response.Bind(problem);
  Eigen::VectorXd force(static_cast<Eigen::Index>(samples));
  Predict(problem, theta, response, {force.data(), samples});
  Eigen::MatrixXd forces(force.size(), static_cast<Eigen::Index>(drawn.size()));
  ScaledRecords data = *problem.data;
  Problem with_drawn = problem;
  with_drawn.data = &data;
  for (std::size_t k = 0; k < drawn.size(); ++k) {
    for (std::size_t r = 0; r < data.records.size(); ++r) {
      const loop::DrawnReading& reading = drawn[k][r];
      if (reading.displacement.empty()) continue;
      ScaledRecord& record = data.records[r];
      record.reversals = reading.reversals;
      std::ranges::transform(reading.displacement, record.displacement.begin(), [&](double read) {
        return (read - record.units.displacement_reference) / record.units.length;
      });
    }
    response.Bind(with_drawn);
    Predict(with_drawn, theta, response,
            {forces.col(static_cast<Eigen::Index>(k)).data(), samples});
  }
  return forces.colwise() - force;
}

Eigen::MatrixXd WeightedForceErrors(const loop::DrawnReadings* drawn, const Problem& problem,
                                    const Solution& solution) {
  if (drawn == nullptr) return {};
  Eigen::MatrixXd errors = ForceErrors(*drawn, problem, solution.theta);
  Eigen::Index row = 0;
  for (const ScaledRecord& record : problem.data->records) {
    for (const double weight : record.root_weight) errors.row(row++) *= weight;
  }
  return errors;
}

namespace {

constexpr int kMostRounds = 50;
constexpr double kSettled = 1e-4;   // rms change of the forces, over the noise: a valley has no end
constexpr double kHarmless = 1e-2;  // likewise, of what goes on for ever: it matters not

/// Samples that count less the free parameters, at least 1.
double DegreesOfFreedom(const ScaledRecords& data, std::size_t parameters) {
  return std::max(static_cast<double>(data.counted) - static_cast<double>(parameters), 1.0);
}

double RmsDifference(std::span<const double> a, std::span<const double> b) {
  double squares = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(squares / static_cast<double>(a.size()));
}

/// One round of weights, from residuals without weights.
class Weighting {
 public:
  Weighting(const Problem& problem, ScaledRecords& data, const FitOptions& options,
            const loop::DrawnReadings* drawn, bool by_record)
      : problem_(problem), data_(data), options_(options), drawn_(drawn), by_record_(by_record) {
    for (const ScaledRecord& record : data.records) {
      counts_.insert(counts_.end(), record.counts.begin(), record.counts.end());
      last_weight_.insert(last_weight_.end(), record.root_weight.begin(), record.root_weight.end());
    }
    last_distance_.resize(counts_.size());
    degrees_ = DegreesOfFreedom(data, problem.parameters.free().size());
  }

  /// @returns what the new weights stand for
  Noise Update(Loss loss, std::span<const double> theta, Response& response) {
    std::vector<double> residual(problem_.size());
    response.Bind(problem_);
    Predict(problem_, theta, response, residual);
    std::vector<double> from_displacement = VarianceOfDraws(residual, theta);
    TakeOffMeasured(data_, residual);
    const std::optional<double> known = options_.response_noise();
    Noise noise = PlainNoise(data_, options_, 0.0, 0);
    if (by_record_ && !known) {
      SetNoiseOfRecords(residual, from_displacement, loss, noise);
    } else {
      noise.force = known ? *known / data_.response_unit()
                          : ForceNoise(residual, from_displacement, loss, 0, residual.size(),
                                       static_cast<double>(data_.counted) / degrees_);
    }
    // Weighted residuals have the variance of those where the loop is flattest.
    const double of_force = std::max(noise.force, kRoundingRms);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      if (counts_[i] != 0) least = std::min(least, from_displacement[i]);
    }
    const double unit = std::sqrt(of_force * of_force + least);
    std::vector<double> standardised;
    std::vector<double> share(drawn_ != nullptr ? residual.size() : 0);
    std::size_t k = 0;
    for (std::size_t r = 0; r < data_.records.size(); ++r) {
      const double own = noise.of_records.empty() ? of_force : noise.of_records[r];
      for (const std::size_t end = k + data_.records[r].size(); k < end; ++k) {
        const double deviation = std::sqrt(own * own + from_displacement[k]);
        residual[k] /= deviation;
        from_displacement[k] = unit / deviation;  // root weight by noise
        if (!share.empty()) share[k] = own / deviation;
        if (counts_[k] != 0) standardised.push_back(residual[k]);
      }
    }
    // If more than half of the samples are met to the last bit, rounding is their noise.
    const double scale = loss == Loss::kNone || known
                             ? 1.0
                             : std::max(RobustScale(standardised), kRoundingRms / unit);
    SetWeights(residual, from_displacement, scale, loss, unit, noise);
    scale_ = unit * scale;
    noise_ = unit;
    without_loss_ = from_displacement;
    noise.force_share = std::move(share);
    return noise;
  }

  /// Takes the robust loss out of the weights: what is left are those of the displacement's noise.
  void UseWeightsWithoutLoss() {
    ForEachWeight([&](std::size_t i, double& weight) {
      if (counts_[i] != 0) weight = without_loss_[i];
    });
  }
  /// Standard deviation of the weighted residuals, without a loss [units of the data].
  [[nodiscard]] double noise() const { return noise_; }
  /// Scale of the weighted residuals, for a loss of them over it [units of the data].
  [[nodiscard]] double scale() const { return scale_; }

  /// Moves by a fraction of the distance from the last weights, which becomes half of what it was
  /// whenever that distance turns back: weights and forces that chase each other meet.
  void GoPartOfTheWay() {
    constexpr double kTurnsBack = 0.5;
    double along = 0.0;
    double square = 0.0;
    ForEachWeight([&](std::size_t i, double& weight) {
      along += (weight - last_weight_[i]) * last_distance_[i];
      square += last_distance_[i] * last_distance_[i];
      last_distance_[i] = weight - last_weight_[i];
    });
    if (along < -kTurnsBack * square) fraction_ /= 2;
    ForEachWeight([&](std::size_t i, double& weight) {
      weight = last_weight_[i] += fraction_ * last_distance_[i];
    });
  }

  /// True if the last weights leave no sample of any weight.
  [[nodiscard]] bool is_lost() const { return is_lost_; }

 private:
  /// Calls visit(number, root weight) for every sample of all records.
  template <typename Visit>
  void ForEachWeight(const Visit& visit) {
    std::size_t i = 0;
    for (ScaledRecord& record : data_.records) {
      for (double& weight : record.root_weight) visit(i++, weight);
    }
  }

  /// Variance σ_T² of the draws at every sample; that of the last time where the forces have moved
  /// by next to nothing since.
  const std::vector<double>& VarianceOfDraws(const std::vector<double>& force,
                                             std::span<const double> theta) {
    variance_of_draws_.resize(force.size());
    const bool has_moved =
        drawn_at_.empty() || !(RmsDifference(force, drawn_at_) < kHarmless * noise_);
    if (drawn_ == nullptr || !has_moved) return variance_of_draws_;
    const Eigen::MatrixXd drawn = ForceErrors(*drawn_, problem_, theta);
    Eigen::Map<Eigen::VectorXd>(variance_of_draws_.data(), drawn.rows()) =
        drawn.rowwise().squaredNorm() / static_cast<double>(drawn.cols());
    drawn_at_ = force;
    return variance_of_draws_;
  }

  /// σ_F of each record, none below a thousandth of the largest, and of all of them.
  void SetNoiseOfRecords(const std::vector<double>& residual,
                         const std::vector<double>& from_displacement, Loss loss,
                         Noise& noise) const {
    constexpr double kLeast = 1e-3;
    double largest = kRoundingRms;
    std::vector<double> samples;
    std::size_t begin = 0;
    for (std::size_t r = 0; r < data_.records.size(); ++r) {
      const std::size_t end = begin + data_.records[r].size();
      samples.push_back(static_cast<double>(CountedSamplesOf(data_.records[r])));
      const double left = std::max(samples.back() - ParametersOfRecord(problem_, r), 1.0);
      noise.of_records.push_back(samples.back() > 0 ? ForceNoise(residual, from_displacement, loss,
                                                                 begin, end, samples.back() / left)
                                                    : 0.0);
      largest = std::max(largest, noise.of_records.back());
      begin = end;
    }
    double squares = 0.0;
    for (std::size_t r = 0; r < samples.size(); ++r) {
      double& own = noise.of_records[r];
      own = std::max(own, kLeast * largest);
      squares += samples[r] * own * own;
    }
    noise.force = std::sqrt(squares / static_cast<double>(data_.counted));
  }

  /// The likeliest σ_F, Σ (r²/s − 1)/s = 0 with s = σ_F² + σ_T²: samples with little noise from the
  /// displacement determine it. Where outliers are expected, that for which the standardised
  /// residuals have the median of normal ones.
  /// @param samples_a_degree  samples over degrees of freedom
  [[nodiscard]] double ForceNoise(const std::vector<double>& residual,
                                  const std::vector<double>& from_displacement, Loss loss,
                                  std::size_t begin, std::size_t end,
                                  double samples_a_degree) const {
    const auto excess = [&](double variance) {
      std::vector<double> standardised;  // for the median
      double squares = 0.0;
      double precisions = 0.0;
      for (std::size_t i = begin; i < end; ++i) {
        if (counts_[i] == 0) continue;
        const double precision = 1 / (variance + from_displacement[i]);
        squares += residual[i] * residual[i] * (precision * precision);
        precisions += precision;
        if (loss != Loss::kNone) standardised.push_back(residual[i] * std::sqrt(precision));
      }
      if (loss != Loss::kNone) return RobustScale(standardised) - 1;
      return samples_a_degree * squares / precisions - 1;
    };
    double high = kRoundingRms * kRoundingRms;
    for (std::size_t i = begin; i < end; ++i) {
      high = std::max(high, 2 * residual[i] * residual[i]);
    }
    const double low = kRoundingRms * kRoundingRms;
    const double at_low = excess(low);
    const double at_high = excess(high);
    if (!(at_low > 0)) return std::sqrt(low);
    if (!(at_high < 0)) return std::sqrt(high);
    constexpr int kBits = 40;
    std::uintmax_t most = 60;
    const auto [from, to] = boost::math::tools::toms748_solve(
        [&](double log_variance) { return excess(std::exp(log_variance)); }, std::log(low),
        std::log(high), at_low, at_high, boost::math::tools::eps_tolerance<double>(kBits), most);
    return std::exp((from + to) / 4);
  }

  void SetWeights(const std::vector<double>& standardised, const std::vector<double>& root_weight,
                  double scale, Loss loss, double unit, Noise& noise) {
    const std::unique_ptr<ceres::LossFunction> function = LossOf(loss);
    double influence_squares = 0.0;
    double slopes = 0.0;
    double weights = 0.0;
    ForEachWeight([&](std::size_t i, double& weight) {
      if (counts_[i] == 0) return;
      const double z = standardised[i] / scale;
      std::array<double, 3> rho = {0.0, 1.0, 0.0};  // and its derivatives by z²
      if (function) function->Evaluate(z * z, rho.data());
      const double of_loss = rho[1];  // ψ(z)/z
      if (of_loss < 0.5) ++noise.outliers;
      influence_squares += of_loss * of_loss * z * z;
      slopes += rho[1] + 2 * z * z * rho[2];  // ψ'(z)
      weights += of_loss;
      weight = root_weight[i] * std::sqrt(of_loss);
    });
    // Huber (1981) §7.6: σ²·[Σψ²/(n − p)]/[Σψ'/n]²·(JᵀJ)⁻¹, where JᵀWJ is JᵀJ times the mean
    // weight.
    const auto count = static_cast<double>(data_.counted);
    if (loss == Loss::kNone && (options_.response_noise() || drawn_ != nullptr)) {
      noise.variance = unit * unit;
      return;
    }
    const double variance = unit * unit * scale * scale;
    // A loss that all samples are far out of has no minimum here, and the rule no meaning.
    is_lost_ = !(slopes > 0 && weights > 0);
    const double of_influence = is_lost_ ? 1.0
                                         : (influence_squares / degrees_) * (weights / count) /
                                               ((slopes / count) * (slopes / count));
    // Samples that are met to the last bit are still rounded.
    noise.variance = std::max(variance * of_influence, kRoundingRms * kRoundingRms);
  }

  const Problem& problem_;
  ScaledRecords& data_;
  const FitOptions& options_;
  const loop::DrawnReadings* drawn_;
  bool by_record_;
  std::vector<unsigned char> counts_;
  std::vector<double> without_loss_;  // root weights
  std::vector<double> variance_of_draws_;
  std::vector<double> drawn_at_;  // forces
  std::vector<double> last_weight_;
  std::vector<double> last_distance_;  // to these from those before them
  double fraction_ = 1.0;
  double noise_ = 0.0;  // of the last weights
  double scale_ = 1.0;
  double degrees_ = 1.0;
  bool is_lost_ = false;
};

/// Writes the cost of a solution under the weights that it implies.
void FillCost(const Problem& problem, Response& response, Solution& solution) {
  std::vector<double> residual(problem.size());
  EvaluateResidual(problem, solution.theta, response, residual);
  solution.sum_of_squares = problem.parameters.PriorCost(solution.theta);
  for (const double r : residual) solution.sum_of_squares += r * r;
  solution.report.final_cost = solution.sum_of_squares / 2;
}

}  // namespace

double RobustScale(std::vector<double> residuals) {
  return loop::kDeviationOverMedian * boost::math::statistics::median_absolute_deviation(
                                          residuals.begin(), residuals.end(), 0.0);
}

Noise PlainNoise(const ScaledRecords& data, const FitOptions& options, double sum_of_squares,
                 std::size_t parameters) {
  Noise noise;
  noise.samples = data.counted;
  noise.is_known = options.response_noise().has_value();
  const double known = options.response_noise().value_or(0.0) / data.response_unit();
  noise.variance =
      std::max(noise.is_known ? known * known : sum_of_squares / DegreesOfFreedom(data, parameters),
               kRoundingRms * kRoundingRms);
  noise.force = std::sqrt(noise.variance);
  return noise;
}

bool FitWithWeights(const Problem& problem, ScaledRecords& data, const FitOptions& options,
                    const loop::DrawnReadings* drawn, Solver& solver,
                    const SolverOptions& solver_options, Solution& solution, Noise& noise,
                    bool by_record) {
  Response& response = solver.response;
  Weighting weighting(problem, data, options, drawn, by_record);
  // Tukey's loss has several minima: it starts from Huber's, which has one.
  constexpr int kHuberRounds = 10;
  std::vector<double> last_force(problem.size());
  response.Bind(problem);
  Predict(problem, solution.theta, response, last_force);
  std::vector<double> force(problem.size());
  double change = std::numeric_limits<double>::infinity();
  for (int round = 0; round < kMostRounds; ++round) {
    const bool first_huber = options.loss != Loss::kNone && round < kHuberRounds;
    const Loss loss = first_huber ? Loss::kHuber : options.loss;
    noise = weighting.Update(loss, solution.theta, response);
    if (weighting.is_lost()) return false;
    if (loss != Loss::kNone) {
      weighting.UseWeightsWithoutLoss();
      SolveRobustly(problem, loss, weighting.scale(), solver_options, solution);
      // The weights that the loss implies there, of which the errors are.
      noise = weighting.Update(loss, solution.theta, response);
      if (weighting.is_lost()) return false;
    } else {
      weighting.GoPartOfTheWay();
      const std::vector<double> start = solution.theta;
      solver.Bind(problem);
      solver.Solve(start, solver_options, solution);
    }
    response.Bind(problem);
    Predict(problem, solution.theta, response, force);
    const double last_change = std::exchange(change, RmsDifference(force, last_force));
    // Changes that become less do so by the same factor.
    const bool is_predicted = round > 0 && change < last_change && solution.converged;
    const double left = is_predicted ? change * change / last_change : change;
    std::swap(force, last_force);
    const bool settled = left < kSettled * weighting.noise();
    if (settled && (!first_huber || options.loss == Loss::kHuber)) {
      FillCost(problem, response, solution);
      return true;
    }
    if (settled && first_huber) round = kHuberRounds - 1;
  }
  FillCost(problem, response, solution);
  return change < kHarmless * weighting.noise();
}

}  // namespace mindahl::identification
