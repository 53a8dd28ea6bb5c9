#include "identification/inference/reweighting.h"

#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <boost/math/tools/toms748_solve.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "loop/statistics.h"

namespace mindahl::identification {

Eigen::MatrixXd ForceErrors(const loop::DrawnReadings& drawn, const Problem& problem,
                            std::span<const double> theta) {
  const Eigen::VectorXd force = Predict(problem, theta);
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
    forces.col(static_cast<Eigen::Index>(k)) = Predict(with_drawn, theta);
  }
  return forces.colwise() - force;
}

namespace {

constexpr double kLeastVariance = kRoundingRms * kRoundingRms;
constexpr int kMostRounds = 50;
constexpr double kSettled = 1e-4;   // rms change of the forces, over the noise: a valley has no end
constexpr double kHarmless = 1e-2;  // likewise, of what goes on for ever: it matters not

/// Samples that count less the free parameters, of which there are fewer.
double DegreesOfFreedom(const Problem& problem) {
  return static_cast<double>(problem.data->counted - problem.parameters.free().size());
}

/// The noise of plain residuals: known, or from their sum of squares.
Noise PlainNoise(const Problem& problem, const FitOptions& options, double sum_of_squares) {
  Noise noise;
  noise.samples = problem.data->counted;
  noise.is_known = options.response_noise().has_value();
  const double known = options.response_noise().value_or(0.0) / problem.data->response_unit();
  noise.variance = std::max(
      noise.is_known ? known * known : sum_of_squares / DegreesOfFreedom(problem), kLeastVariance);
  noise.force = std::sqrt(noise.variance);
  return noise;
}

double Rms(const Eigen::ArrayXd& values) { return std::sqrt(values.square().mean()); }

/// Fits of one problem, and the weights that each implies for the next.
class Reweighting {
 public:
  Reweighting(const Problem& problem, ScaledRecords& data, const FitOptions& options,
              Solution& solution)
      : problem_(problem), data_(data), options_(options), solution_(solution) {}

  /// Fits until the forces settle. Returns whether they did.
  bool Settle(Loss loss) {
    constexpr double kTurnsBack = 0.5;
    double change = std::numeric_limits<double>::infinity();
    Eigen::ArrayXd step = Eigen::ArrayXd::Zero(force_.size());
    for (int round = 0; round < kMostRounds; ++round) {
      WeighByNoise(loss);
      const SolverOptions search{.max_iterations = options_.max_iterations};
      if (loss != Loss::kNone) {
        SolveByCeres(problem_, loss, unit_, search, solution_);
      } else {
        ProjectedResidual residual(problem_);
        solution_ = Solve(residual, solution_.theta, search);
      }
      const Eigen::ArrayXd last_force = force_;
      force_ = Predict(problem_, solution_.theta);
      const Eigen::ArrayXd last_step = std::exchange(step, force_ - last_force);
      // Weights and forces that chase each other meet half way.
      if ((step * last_step).sum() < -kTurnsBack * last_step.square().sum()) fraction_ /= 2;
      const double last_change = std::exchange(change, Rms(step));
      // Changes that become less do so by the same factor.
      const bool is_predicted = round > 0 && change < last_change && solution_.converged;
      const double left = is_predicted ? change * change / last_change : change;
      if (left < kSettled * unit_) return true;
    }
    return change < kHarmless * unit_;
  }

  /// Puts the weights ψ(z)/z of a robust loss, of what it leaves, into those of the samples.
  /// @returns false where all samples are so far out that the loss has no minimum
  bool ApplyLoss(Loss loss) {
    WeighByNoise(loss);
    const Eigen::ArrayXd standardised = weights_ * Residual() / unit_;
    Eigen::ArrayXd of_samples = Eigen::ArrayXd::Zero(counts_.size());
    const std::unique_ptr<ceres::LossFunction> function = LossOf(loss);
    double influence_squares = 0.0;
    double slopes = 0.0;
    for (Eigen::Index i = 0; i < counts_.size(); ++i) {
      if (counts_[i] == 0) continue;
      const double z = standardised[i];
      std::array<double, 3> rho{};  // and its derivatives by z²
      function->Evaluate(z * z, rho.data());
      if (rho[1] < 0.5) ++noise_.outliers;
      influence_squares += rho[1] * rho[1] * z * z;
      slopes += rho[1] + 2 * z * z * rho[2];  // ψ'(z)
      of_samples[i] = rho[1];
    }
    SetWeights(weights_ * of_samples.sqrt());
    const double of_loss = of_samples.sum();
    if (!(slopes > 0 && of_loss > 0)) return false;
    // Huber (1981) §7.6: σ²·[Σψ²/(n − p)]/[Σψ'/n]²·(JᵀJ)⁻¹; JᵀWJ is JᵀJ times the mean weight.
    const auto count = static_cast<double>(data_.counted);
    noise_.variance *= (influence_squares / DegreesOfFreedom(problem_)) * (of_loss / count) /
                       ((slopes / count) * (slopes / count));
    // Samples that are met to the last bit are still rounded.
    noise_.variance = std::max(noise_.variance, kLeastVariance);
    return true;
  }

  /// Writes the cost of the solution under the weights that it implies. Returns their noise.
  Noise Finish() {
    solution_.sum_of_squares =
        (weights_ * Residual()).square().sum() + problem_.parameters.PriorCost(solution_.theta);
    if (drawn_ != nullptr) noise_.drawn = weights_.matrix().asDiagonal() * errors_;
    return std::move(noise_);
  }

 private:
  /// Returns model − measured of every sample, without weights.
  [[nodiscard]] Eigen::ArrayXd Residual() const {
    return force_ - data_.All(&ScaledRecord::response).array();
  }

  /// Finds the noise, and the root weights of the samples by it: weighted residuals have the
  /// deviation `unit_` of those where the loop is flattest.
  void WeighByNoise(Loss loss) {
    // The draws of the last time hold where the forces have moved by next to nothing since.
    if (drawn_ != nullptr &&
        (drawn_at_.size() == 0 || !(Rms(force_ - drawn_at_) < kHarmless * unit_))) {
      errors_ = ForceErrors(*drawn_, problem_, solution_.theta);
      from_displacement_ +=
          fraction_ * (errors_.array().square().rowwise().mean() - from_displacement_);
      drawn_at_ = force_;
    }
    noise_ = PlainNoise(problem_, options_, 0.0);
    if (!noise_.is_known) noise_.force = ForceNoise(loss);
    const Eigen::ArrayXd deviation = (noise_.force * noise_.force + from_displacement_).sqrt();
    unit_ = (counts_ > 0).select(deviation, std::numeric_limits<double>::infinity()).minCoeff();
    noise_.variance = unit_ * unit_;
    if (drawn_ != nullptr) noise_.force_share = noise_.force / deviation;
    SetWeights(counts_ * unit_ / deviation);
  }

  /// The likeliest σ_F, Σ (r²/s − 1)/s = 0 with s = σ_F² + σ_T²: samples with little noise from the
  /// displacement determine it. Where outliers are expected, that for which the standardised
  /// residuals have the median of normal ones.
  [[nodiscard]] double ForceNoise(Loss loss) const {
    const Eigen::ArrayXd residual = Residual();
    const double samples_a_degree = static_cast<double>(data_.counted) / DegreesOfFreedom(problem_);
    const auto excess = [&](double variance) {
      const Eigen::ArrayXd precision = counts_ / (variance + from_displacement_);
      if (loss == Loss::kNone) {
        return samples_a_degree * (residual * precision).square().sum() / precision.sum() - 1;
      }
      std::vector<double> standardised;
      for (Eigen::Index i = 0; i < residual.size(); ++i) {
        if (counts_[i] > 0) standardised.push_back(residual[i] * std::sqrt(precision[i]));
      }
      // The median of the magnitudes estimates the standard deviation despite outliers.
      return loop::kDeviationOverMedian * boost::math::statistics::median_absolute_deviation(
                                              standardised.begin(), standardised.end(), 0.0) -
             1;
    };
    const double high = std::max(kLeastVariance, 2 * residual.square().maxCoeff());
    const double at_low = excess(kLeastVariance);
    const double at_high = excess(high);
    if (!(at_low > 0)) return kRoundingRms;
    if (!(at_high < 0)) return std::sqrt(high);
    constexpr int kBits = 40;
    std::uintmax_t most = 60;
    const auto [from, to] = boost::math::tools::toms748_solve(
        [&](double log_variance) { return excess(std::exp(log_variance)); },
        std::log(kLeastVariance), std::log(high), at_low, at_high,
        boost::math::tools::eps_tolerance<double>(kBits), most);
    return std::exp((from + to) / 4);
  }

  void SetWeights(Eigen::ArrayXd weights) {
    weights_ = std::move(weights);
    const std::span<const double> of_all(weights_.data(), problem_.size());
    for (ScaledRecord& record : data_.records) {
      std::ranges::copy(record.Of(of_all), record.root_weight.begin());
    }
  }

  const Problem& problem_;
  ScaledRecords& data_;
  const FitOptions& options_;
  const loop::DrawnReadings* drawn_ = options_.preparation.drawn.get();
  Solution& solution_;
  Eigen::ArrayXd counts_ = data_.All(&ScaledRecord::counts);   // 1 of a sample that counts, else 0
  Eigen::ArrayXd force_ = Predict(problem_, solution_.theta);  // of the solution
  /// Variance σ_T² of the draws at every sample.
  Eigen::ArrayXd from_displacement_ = Eigen::ArrayXd::Zero(counts_.size());
  double fraction_ = 1.0;    // of new draws in it
  Eigen::MatrixXd errors_;   // of the last draws
  Eigen::ArrayXd drawn_at_;  // forces
  double unit_ = 0.0;        // deviation of the weighted residuals
  Eigen::ArrayXd weights_;   // roots
  Noise noise_;
};

}  // namespace

bool FitWithWeights(const Problem& problem, ScaledRecords& data, const FitOptions& options,
                    Solution& solution, Noise& noise) {
  if (options.loss == Loss::kNone && !options.preparation.drawn) {
    noise = PlainNoise(problem, options, solution.sum_of_squares);
    return true;
  }
  Reweighting fits(problem, data, options, solution);
  // Other losses have several minima: they start from Huber's, which has one.
  if (options.loss == Loss::kCauchy || options.loss == Loss::kTukey) fits.Settle(Loss::kHuber);
  bool is_settled = fits.Settle(options.loss);
  if (options.loss != Loss::kNone) is_settled = fits.ApplyLoss(options.loss) && is_settled;
  noise = fits.Finish();
  return is_settled;
}

}  // namespace mindahl::identification
