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

namespace {

constexpr int kMostRounds = 50;
constexpr double kSettled = 1e-4;   // rms change of the forces, over the noise: a valley has no end
constexpr double kHarmless = 1e-2;  // likewise, of what goes on for ever: it matters not

/// Samples that count less the free parameters, at least 1.
double DegreesOfFreedom(const ScaledRecords& data, std::size_t parameters) {
  return std::max(static_cast<double>(data.counted) - static_cast<double>(parameters), 1.0);
}

/// Standard deviation of normal values of mean 0, one or more, by the median of their magnitudes,
/// which outliers do not move.
double RobustScale(std::vector<double> residuals) {
  return loop::kDeviationOverMedian * boost::math::statistics::median_absolute_deviation(
                                          residuals.begin(), residuals.end(), 0.0);
}

/// The noise of plain residuals: known, or from their sum of squares.
/// @param parameters  free ones
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

double Rms(const Eigen::VectorXd& values) {
  return values.norm() / std::sqrt(static_cast<double>(values.size()));
}

/// Fits of one problem, and the weights that each implies for the next.
class Reweighting {
 public:
  Reweighting(const Problem& problem, ScaledRecords& data, const FitOptions& options,
              const loop::DrawnReadings* drawn, Solver& solver, Solution& solution)
      : problem_(problem),
        data_(data),
        options_(options),
        drawn_(drawn),
        solver_(solver),
        solution_(solution),
        force_(static_cast<Eigen::Index>(problem.size())),
        from_displacement_(Eigen::VectorXd::Zero(force_.size())) {
    for (const ScaledRecord& record : data.records) {
      counts_.insert(counts_.end(), record.counts.begin(), record.counts.end());
    }
    degrees_ = DegreesOfFreedom(data, problem.parameters.free().size());
    PredictForce();
  }

  /// Fits until the forces settle.
  /// @returns whether they did
  bool Settle(Loss loss) {
    constexpr double kTurnsBack = 0.5;
    double change = std::numeric_limits<double>::infinity();
    Eigen::VectorXd step = Eigen::VectorXd::Zero(force_.size());
    for (int round = 0; round < kMostRounds; ++round) {
      SetWeights(WeightsByNoise(loss));
      if (loss != Loss::kNone) {
        SolveByCeres(problem_, loss, unit_, SolverOptionsOf(options_), solution_);
      } else {
        const std::vector<double> start = solution_.theta;
        solver_.Bind(problem_);
        solver_.Solve(start, SolverOptionsOf(options_), solution_);
      }
      const Eigen::VectorXd last_force = force_;
      PredictForce();
      const Eigen::VectorXd last_step = std::exchange(step, force_ - last_force);
      // Weights and forces that chase each other meet half way.
      if (step.dot(last_step) < -kTurnsBack * last_step.squaredNorm()) fraction_ /= 2;
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
    std::vector<double> weights = WeightsByNoise(loss);
    const std::vector<double> residual = Residual();
    const std::unique_ptr<ceres::LossFunction> function = LossOf(loss);
    double influence_squares = 0.0;
    double slopes = 0.0;
    double of_loss = 0.0;
    noise_.outliers = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      if (counts_[i] == 0) continue;
      const double z = weights[i] * residual[i] / unit_;
      std::array<double, 3> rho{};  // and its derivatives by z²
      function->Evaluate(z * z, rho.data());
      if (rho[1] < 0.5) ++noise_.outliers;
      influence_squares += rho[1] * rho[1] * z * z;
      slopes += rho[1] + 2 * z * z * rho[2];  // ψ'(z)
      of_loss += rho[1];
      weights[i] *= std::sqrt(rho[1]);
    }
    SetWeights(weights);
    if (!(slopes > 0 && of_loss > 0)) return false;
    // Huber (1981) §7.6: σ²·[Σψ²/(n − p)]/[Σψ'/n]²·(JᵀJ)⁻¹, where JᵀWJ is JᵀJ times the mean
    // weight.
    const auto count = static_cast<double>(data_.counted);
    noise_.variance *=
        (influence_squares / degrees_) * (of_loss / count) / ((slopes / count) * (slopes / count));
    // Samples that are met to the last bit are still rounded.
    noise_.variance = std::max(noise_.variance, kRoundingRms * kRoundingRms);
    return true;
  }

  /// Writes the cost of the solution under the weights that it implies.
  /// @returns what these stand for
  Noise Finish() {
    std::vector<double> residual(problem_.size());
    EvaluateResidual(problem_, solution_.theta, solver_.response, residual);
    solution_.sum_of_squares = problem_.parameters.PriorCost(solution_.theta);
    for (const double r : residual) solution_.sum_of_squares += r * r;
    solution_.report.final_cost = solution_.sum_of_squares / 2;
    noise_.drawn = std::move(errors_);
    Eigen::Index row = 0;
    for (const ScaledRecord& record : data_.records) {
      for (const double weight : record.root_weight) {
        if (noise_.drawn.size() > 0) noise_.drawn.row(row++) *= weight;
      }
    }
    return std::move(noise_);
  }

 private:
  void PredictForce() {
    solver_.response.Bind(problem_);
    Predict(problem_, solution_.theta, solver_.response,
            {force_.data(), static_cast<std::size_t>(force_.size())});
  }

  /// Returns model − measured of every sample, without weights.
  [[nodiscard]] std::vector<double> Residual() const {
    std::vector<double> residual(force_.begin(), force_.end());
    TakeOffMeasured(data_, residual);
    return residual;
  }

  /// Finds the noise, and the root weights of the samples by it: weighted residuals have the
  /// deviation `unit_` of those where the loop is flattest.
  std::vector<double> WeightsByNoise(Loss loss) {
    // The draws of the last time hold where the forces have moved by next to nothing since.
    if (drawn_ != nullptr &&
        (drawn_at_.size() == 0 || !(Rms(force_ - drawn_at_) < kHarmless * unit_))) {
      errors_ = ForceErrors(*drawn_, problem_, solution_.theta);
      from_displacement_ +=
          fraction_ * (errors_.rowwise().squaredNorm() / static_cast<double>(errors_.cols()) -
                       from_displacement_);
      drawn_at_ = force_;
    }
    noise_ = PlainNoise(data_, options_, 0.0, 0);
    if (!noise_.is_known) noise_.force = ForceNoise(loss);
    const double of_force = std::max(noise_.force, kRoundingRms);
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      if (counts_[i] != 0)
        least = std::min(least, from_displacement_[static_cast<Eigen::Index>(i)]);
    }
    unit_ = std::sqrt(of_force * of_force + least);
    noise_.variance = unit_ * unit_;
    std::vector<double> weights(counts_.size());
    if (drawn_ != nullptr) noise_.force_share.resize(counts_.size());
    for (std::size_t i = 0; i < counts_.size(); ++i) {
      const double deviation =
          std::sqrt(of_force * of_force + from_displacement_[static_cast<Eigen::Index>(i)]);
      if (counts_[i] != 0) weights[i] = unit_ / deviation;
      if (drawn_ != nullptr) noise_.force_share[i] = of_force / deviation;
    }
    return weights;
  }

  /// The likeliest σ_F, Σ (r²/s − 1)/s = 0 with s = σ_F² + σ_T²: samples with little noise from the
  /// displacement determine it. Where outliers are expected, that for which the standardised
  /// residuals have the median of normal ones.
  [[nodiscard]] double ForceNoise(Loss loss) const {
    const std::vector<double> residual = Residual();
    const double samples_a_degree = static_cast<double>(data_.counted) / degrees_;
    const auto excess = [&](double variance) {
      std::vector<double> standardised;  // for the median
      double squares = 0.0;
      double precisions = 0.0;
      for (std::size_t i = 0; i < residual.size(); ++i) {
        if (counts_[i] == 0) continue;
        const double precision = 1 / (variance + from_displacement_[static_cast<Eigen::Index>(i)]);
        squares += residual[i] * residual[i] * (precision * precision);
        precisions += precision;
        if (loss != Loss::kNone) standardised.push_back(residual[i] * std::sqrt(precision));
      }
      if (loss != Loss::kNone) return RobustScale(std::move(standardised)) - 1;
      return samples_a_degree * squares / precisions - 1;
    };
    const double low = kRoundingRms * kRoundingRms;
    double high = low;
    for (const double r : residual) high = std::max(high, 2 * r * r);
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

  void SetWeights(std::span<const double> weights) {
    for (ScaledRecord& record : data_.records) {
      std::ranges::copy(weights.first(record.size()), record.root_weight.begin());
      weights = weights.subspan(record.size());
    }
  }

  const Problem& problem_;
  ScaledRecords& data_;
  const FitOptions& options_;
  const loop::DrawnReadings* drawn_;
  Solver& solver_;
  Solution& solution_;
  std::vector<unsigned char> counts_;
  Eigen::VectorXd force_;              // of the solution
  Eigen::VectorXd from_displacement_;  // variance σ_T² of the draws at every sample
  double fraction_ = 1.0;              // of new draws in it
  Eigen::MatrixXd errors_;             // of the last draws
  Eigen::VectorXd drawn_at_;           // forces
  double unit_ = 0.0;                  // deviation of the weighted residuals
  double degrees_ = 1.0;
  Noise noise_;
};

}  // namespace

bool FitWithWeights(const Problem& problem, ScaledRecords& data, const FitOptions& options,
                    const loop::DrawnReadings* drawn, Solver& solver, Solution& solution,
                    Noise& noise) {
  if (options.loss == Loss::kNone && drawn == nullptr) {
    noise = PlainNoise(data, options, solution.sum_of_squares, problem.parameters.free().size());
    return true;
  }
  Reweighting fits(problem, data, options, drawn, solver, solution);
  // Other losses have several minima: they start from Huber's, which has one.
  if (options.loss == Loss::kCauchy || options.loss == Loss::kTukey) fits.Settle(Loss::kHuber);
  bool is_settled = fits.Settle(options.loss);
  if (options.loss != Loss::kNone) is_settled = fits.ApplyLoss(options.loss) && is_settled;
  noise = fits.Finish();
  return is_settled;
}

}  // namespace mindahl::identification
