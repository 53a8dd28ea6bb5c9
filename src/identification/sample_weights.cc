#include "identification/sample_weights.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "identification/robust_scale.h"
#include "identification/solver.h"
#include "mindahl/core/error.h"

namespace mindahl::identification {
namespace {

constexpr int kMostRounds = 50;
constexpr double kSettled = 1e-4;  // rms change of the forces, over the noise: a valley has no end

/// ψ(z)/z and ψ'(z).
struct Influence {
  double weight;
  double slope;
};

Influence InfluenceOf(Loss loss, double z) {
  constexpr double kHuber = 1.345;
  constexpr double kCauchy = 2.385;
  constexpr double kTukey = 4.685;
  const double magnitude = std::abs(z);
  switch (loss) {
    case Loss::kNone:
      break;
    case Loss::kHuber:
      if (magnitude <= kHuber) break;
      return {kHuber / magnitude, 0.0};
    case Loss::kCauchy: {
      const double weight = 1 / (1 + (z / kCauchy) * (z / kCauchy));
      return {weight, weight * weight * (1 - (z / kCauchy) * (z / kCauchy))};
    }
    case Loss::kTukey: {
      if (magnitude >= kTukey) return {0.0, 0.0};
      const double left = 1 - (z / kTukey) * (z / kTukey);
      return {left * left, left * (1 - 5 * (z / kTukey) * (z / kTukey))};
    }
  }
  return {1.0, 1.0};
}

/// Samples that count less the free parameters, at least 1.
double DegreesOfFreedom(const Candidate& candidate, const ScaledRecords& data) {
  return std::max(static_cast<double>(data.weighted_samples()) -
                      static_cast<double>(candidate.layout.free().size()),
                  1.0);
}

/// One round of weights, from residuals without weights.
class Weighting {
 public:
  Weighting(Candidate& candidate, ScaledRecords& data, const FitOptions& options,
            const DisplacementErrors& displacement_errors)
      : candidate_(candidate), data_(data), options_(options), errors_(displacement_errors) {
    for (const ScaledRecord& record : data.records) {
      for (const double weight : record.root_weight) counts_.push_back(weight > 0);
    }
    degrees_ = DegreesOfFreedom(candidate, data);
  }

  /// @returns what the new weights stand for
  WeightedNoise Update(Loss loss) {
    const std::vector<double>& theta = candidate_.solution.theta;
    std::vector<double> residual(candidate_.residual.size());
    candidate_.residual.Predict(theta, residual);
    std::vector<double> from_displacement(residual.size(), 0.0);  // variance
    std::size_t i = 0;
    for (const ScaledRecord& record : data_.records) {
      for (const double force : record.force) residual[i++] -= force;
    }
    if (errors_.any()) {
      const Eigen::MatrixXd drawn = errors_.ForceErrors(candidate_);
      const auto draws = static_cast<double>(drawn.cols());
      for (i = 0; i < residual.size(); ++i) {
        from_displacement[i] = drawn.row(static_cast<Eigen::Index>(i)).squaredNorm() / draws;
      }
    }
    WeightedNoise noise;
    noise.force_noise = options_.force_noise ? *options_.force_noise / data_.force
                                             : ForceNoise(residual, from_displacement, loss);
    // Weighted residuals have the variance of those where the loop is flat.
    const double unit = std::max(noise.force_noise, kRoundingRms);
    std::vector<double> standardised;
    for (std::size_t k = 0; k < residual.size(); ++k) {
      const double deviation = std::sqrt(unit * unit + from_displacement[k]);
      residual[k] /= deviation;
      from_displacement[k] = unit / deviation;  // root weight by noise
      if (counts_[k]) standardised.push_back(residual[k]);
    }
    const double scale =
        loss == Loss::kNone || options_.force_noise ? 1.0 : RobustScale(standardised);
    SetWeights(residual, from_displacement, scale, loss, unit, noise);
    if (errors_.any()) noise.force_share = from_displacement;
    return noise;
  }

 private:
  /// The likeliest σ_F, Σ (r²/s − 1)/s = 0 with s = σ_F² + σ_T²: samples with little noise from the
  /// displacement tell it. Where outliers are expected, that for which the standardised residuals
  /// have the median of normal ones. Bisection.
  [[nodiscard]] double ForceNoise(const std::vector<double>& residual,
                                  const std::vector<double>& from_displacement, Loss loss) const {
    const auto excess = [&](double variance) {
      std::vector<double> standardised;
      for (std::size_t i = 0; i < residual.size(); ++i) {
        if (counts_[i]) {
          standardised.push_back(residual[i] / std::sqrt(variance + from_displacement[i]));
        }
      }
      if (loss != Loss::kNone) return RobustScale(standardised) - 1;
      double squares = 0.0;
      double precisions = 0.0;
      std::size_t k = 0;
      for (std::size_t i = 0; i < residual.size(); ++i) {
        if (!counts_[i]) continue;
        const double precision = 1 / (variance + from_displacement[i]);
        squares += standardised[k] * standardised[k] * precision;
        precisions += precision;
        ++k;
      }
      return static_cast<double>(standardised.size()) / degrees_ * squares / precisions - 1;
    };
    double high = kRoundingRms * kRoundingRms;
    for (const double r : residual) high = std::max(high, 2 * r * r);
    double low = kRoundingRms * kRoundingRms;
    if (!(excess(low) > 0)) return std::sqrt(low);
    constexpr int kBisections = 60;
    for (int k = 0; k < kBisections; ++k) {
      const double middle = std::sqrt(low * high);
      (excess(middle) > 0 ? low : high) = middle;
    }
    return std::sqrt(high);
  }

  void SetWeights(const std::vector<double>& standardised, const std::vector<double>& root_weight,
                  double scale, Loss loss, double unit, WeightedNoise& noise) {
    double influence_squares = 0.0;
    double slopes = 0.0;
    double weights = 0.0;
    std::size_t i = 0;
    for (ScaledRecord& record : data_.records) {
      for (double& weight : record.root_weight) {
        if (counts_[i]) {
          const double z = standardised[i] / scale;
          const Influence influence = InfluenceOf(loss, z);
          if (influence.weight < 0.5) ++noise.outliers;
          influence_squares += influence.weight * influence.weight * z * z;
          slopes += influence.slope;
          weights += influence.weight;
          // A weight of exactly 0 would make the sample one that was left out.
          constexpr double kLeast = 1e-12;
          weight = root_weight[i] * std::sqrt(std::max(influence.weight, kLeast));
        }
        ++i;
      }
    }
    // Huber (1981) §7.6: σ²·[Σψ²/(n − p)]/[Σψ'/n]²·(JᵀJ)⁻¹, where JᵀWJ is JᵀJ times the mean
    // weight.
    const double count = static_cast<double>(data_.weighted_samples());
    if (loss == Loss::kNone && (options_.force_noise || errors_.any())) {
      noise.variance = unit * unit;
      return;
    }
    const double variance = unit * unit * scale * scale;
    noise.variance = variance * (influence_squares / degrees_) * (weights / count) /
                     ((slopes / count) * (slopes / count));
  }

  Candidate& candidate_;
  ScaledRecords& data_;
  const FitOptions& options_;
  const DisplacementErrors& errors_;
  std::vector<bool> counts_;
  double degrees_ = 1.0;
};

}  // namespace

std::vector<std::size_t> LeaveOut(ScaledRecords& data, std::span<const loop::Record> records,
                                  std::span<const std::vector<std::size_t>> reversals,
                                  const FitOptions& options) {
  if (!options.held_out.empty()) {
    RequireSameSize("held-out masks", options.held_out.size(), "records", records.size());
  }
  std::vector<std::size_t> left_out;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const loop::Record& record = records[r];
    ScaledRecord& scaled = data.records[r];
    std::size_t& count = left_out.emplace_back(0);
    const auto leave_out = [&](std::size_t i) {
      if (scaled.root_weight[i] > 0) ++count;
      scaled.root_weight[i] = 0.0;
    };
    if (options.load_window) {
      if (record.normal_load.empty()) {
        throw InvalidArgument("the load window needs a normal load in every record");
      }
      for (std::size_t i = 0; i < record.size(); ++i) {
        const double load = record.normal_load[i];
        if (load < options.load_window->lower || load > options.load_window->upper) leave_out(i);
      }
    }
    if (options.skip_cycles > 0) {
      // Two reversals a cycle; the first of them ends the way in.
      const std::size_t turns = 2 * options.skip_cycles;
      const std::size_t first =
          turns <= reversals[r].size() ? reversals[r][turns - 1] : record.size();
      for (std::size_t i = 0; i < std::min(first, record.size()); ++i) leave_out(i);
    }
    if (!options.held_out.empty() && !options.held_out[r].empty()) {
      const std::vector<bool>& held_out = options.held_out[r];
      RequireSameSize("held-out mask", held_out.size(), "samples", record.size());
      for (std::size_t i = 0; i < record.size(); ++i) {
        if (held_out[i]) leave_out(i);
      }
    }
    if (count == record.size()) {
      throw InvalidArgument(fmt::format(
          "nothing is left of record {}: {} samples lie outside the load window, in the cycles "
          "that are skipped, or are held out",
          r + 1, count));
    }
  }
  return left_out;
}

WeightedNoise PlainNoise(const Candidate& candidate, const ScaledRecords& data,
                         const FitOptions& options) {
  WeightedNoise noise;
  const double degrees = DegreesOfFreedom(candidate, data);
  const double known = options.force_noise.value_or(0.0) / data.force;
  noise.variance =
      std::max(options.force_noise ? known * known : candidate.solution.sum_of_squares / degrees,
               kRoundingRms * kRoundingRms);
  noise.force_noise = std::sqrt(noise.variance);
  return noise;
}

WeightedNoise FitWithWeights(Candidate& candidate, ScaledRecords& data, const FitOptions& options,
                             const DisplacementErrors& displacement_errors) {
  Weighting weighting(candidate, data, options, displacement_errors);
  // Tukey's loss has several minima: it starts from Huber's, which has one.
  constexpr int kHuberRounds = 10;
  std::vector<double> last_force(candidate.residual.size());
  candidate.residual.Predict(candidate.solution.theta, last_force);
  WeightedNoise noise;
  for (int round = 0; round < kMostRounds; ++round) {
    const bool first_huber = options.loss != Loss::kNone && round < kHuberRounds;
    noise = weighting.Update(first_huber ? Loss::kHuber : options.loss);
    candidate.solution =
        Solve(candidate.residual, candidate.layout, candidate.solution.theta, options);
    std::vector<double> force(candidate.residual.size());
    candidate.residual.Predict(candidate.solution.theta, force);
    double squares = 0.0;
    for (std::size_t i = 0; i < force.size(); ++i) {
      squares += (force[i] - last_force[i]) * (force[i] - last_force[i]);
    }
    last_force = std::move(force);
    const double change = std::sqrt(squares / static_cast<double>(last_force.size()));
    const bool settled = change < kSettled * std::max(noise.force_noise, kRoundingRms);
    if (settled && (!first_huber || options.loss == Loss::kHuber)) return noise;
    if (settled && first_huber) round = kHuberRounds - 1;
  }
  noise.converged = false;
  return noise;
}

}  // namespace mindahl::identification
