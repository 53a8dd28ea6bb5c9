#include "identification/inference/displacement_errors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/draws.h"

namespace mindahl::identification {
namespace {

/// A standard deviation from as many draws is good to 1/√(2·200) = 5 %; of long records fewer,
/// whose many strokes average.
constexpr std::size_t kMostDraws = 200;
constexpr std::size_t kLeastDraws = 20;
constexpr std::size_t kMostNumbers = 400'000;
constexpr std::uint64_t kSeed = 1;

/// Draws a reading in units of the data.
std::vector<double> DrawReading(const loop::PreparedRecord& record, double length,
                                std::span<const double> truth, Draws& draws) {
  const double step = record.encoder_step / length;
  const double deviation = record.displacement_noise / length;
  // The rounding itself is q/√12; what an estimate says beyond q is noise that the encoder follows.
  const double noise = deviation > step ? deviation : 0.0;
  const double phase = draws.Uniform(0, 1);
  std::vector<double> drawn(truth.begin(), truth.end());
  const std::span<const double> read = record.record.displacement;
  double error = 0.0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    // A reading that says what the one before said is one error.
    if (i == 0 || read[i] != read[i - 1]) error = noise * draws.Normal();
    drawn[i] += error;
    if (step > 0) drawn[i] = step * (std::round(drawn[i] / step + phase) - phase);
  }
  return drawn;
}

}  // namespace

DisplacementErrors::DisplacementErrors(const loop::PreparedRecords& records,
                                       const ScaledRecords& data)
    : data_(data) {
  if (std::ranges::none_of(records.records,
                           [](const auto& record) { return record.displacement_noise > 0; })) {
    return;
  }
  draws_.resize(std::clamp(kMostNumbers / data.samples(), kLeastDraws, kMostDraws));
  Draws draws(kSeed);
  for (std::vector<Drawn>& draw : draws_) {
    for (std::size_t r = 0; r < data.records.size(); ++r) {
      const ScaledRecord& record = data.records[r];
      Drawn& drawn = draw.emplace_back();
      drawn.displacement.assign(record.displacement.begin(), record.displacement.end());
      drawn.reversals.assign(record.reversals.begin(), record.reversals.end());
      if (!(records.records[r].displacement_noise > 0)) continue;
      drawn.displacement = records.records[r].smoother->Smooth(
          DrawReading(records.records[r], data.length, record.displacement, draws));
      drawn.reversals = loop::MoveReversals(drawn.displacement, record.reversals);
    }
  }
}

Eigen::MatrixXd DisplacementErrors::ForceErrors(const Problem& problem,
                                                std::span<const double> theta) const {
  const std::size_t samples = problem.size();
  Response response;
  response.Bind(problem);
  Eigen::VectorXd force(static_cast<Eigen::Index>(samples));
  Predict(problem, theta, response, {force.data(), samples});
  Eigen::MatrixXd forces(force.size(), static_cast<Eigen::Index>(draws_.size()));
  ScaledRecords data = data_;
  Problem drawn = problem;
  drawn.data = &data;
  for (std::size_t k = 0; k < draws_.size(); ++k) {
    for (std::size_t r = 0; r < data.records.size(); ++r) {
      data.records[r].displacement.assign(draws_[k][r].displacement.begin(),
                                          draws_[k][r].displacement.end());
      data.records[r].reversals = draws_[k][r].reversals;
    }
    response.Bind(drawn);
    Predict(drawn, theta, response, {forces.col(static_cast<Eigen::Index>(k)).data(), samples});
  }
  return forces.colwise() - force;
}

DisplacementEffect EffectOf(const DisplacementErrors& errors, const Problem& problem,
                            const Solution& solution, const Noise& noise) {
  if (!errors.any()) return {};
  DisplacementEffect effect{errors.ForceErrors(problem, solution.theta),
                            noise.variance * noise.repeating};
  Eigen::Index row = 0;
  for (const ScaledRecord& record : problem.data->records) {
    for (const double weight : record.root_weight) effect.residuals.row(row++) *= weight;
  }
  return effect;
}

}  // namespace mindahl::identification
