#include "identification/displacement_errors.h"

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <boost/random/uniform_01.hpp>
#include <cmath>
#include <cstdint>

namespace mindahl::identification {
namespace {

/// A standard deviation from as many draws is good to 1/√(2·200) = 5 %; of long records fewer,
/// whose many strokes average.
constexpr std::size_t kMostDraws = 200;
constexpr std::size_t kLeastDraws = 20;
constexpr std::size_t kMostNumbers = 4'000'000;
constexpr std::uint64_t kSeed = 1;

using Engine = boost::random::mt19937_64;

std::vector<double> DrawReading(const DisplacementReading& reading,
                                const std::vector<double>& truth, Engine& engine) {
  boost::random::normal_distribution<double> normal;
  const double step = reading.encoder_step;
  // The rounding itself is q/√12; what an estimate says beyond q is noise that the encoder follows.
  const double noise = reading.noise > step ? reading.noise : 0.0;
  const double phase = boost::random::uniform_01<double>{}(engine);
  std::vector<double> drawn(truth);
  double error = 0.0;
  for (std::size_t i = 0; i < drawn.size(); ++i) {
    if (!reading.repeats[i]) error = noise * normal(engine);
    drawn[i] += error;
    if (step > 0) drawn[i] = step * (std::round(drawn[i] / step + phase) - phase);
  }
  return drawn;
}

}  // namespace

DisplacementErrors::DisplacementErrors(const ScaledRecords& data,
                                       std::span<const DisplacementReading> readings)
    : data_(data) {
  if (std::ranges::none_of(readings, [](const auto& reading) { return reading.noise > 0; })) return;
  draws_.resize(std::clamp(kMostNumbers / data.samples(), kLeastDraws, kMostDraws));
  Engine engine(kSeed);
  for (std::vector<Drawn>& draw : draws_) {
    for (std::size_t r = 0; r < readings.size(); ++r) {
      const ScaledRecord& record = data.records[r];
      Drawn& drawn = draw.emplace_back(Drawn{record.displacement, record.reversals});
      if (!(readings[r].noise > 0)) continue;
      drawn.displacement =
          readings[r].smoother.Smooth(DrawReading(readings[r], record.displacement, engine));
      drawn.reversals = loop::MoveReversals(drawn.displacement, record.reversals);
    }
  }
}

Eigen::MatrixXd DisplacementErrors::ForceErrors(const Candidate& candidate) const {
  const std::vector<double>& theta = candidate.solution.theta;
  const std::size_t samples = candidate.residual.size();
  Eigen::VectorXd force(static_cast<Eigen::Index>(samples));
  candidate.residual.Predict(theta, {force.data(), samples});
  Eigen::MatrixXd forces(force.size(), static_cast<Eigen::Index>(draws_.size()));
  ScaledRecords data = data_;
  for (std::size_t k = 0; k < draws_.size(); ++k) {
    for (std::size_t r = 0; r < data.records.size(); ++r) {
      data.records[r].displacement = draws_[k][r].displacement;
      data.records[r].reversals = draws_[k][r].reversals;
    }
    const ForceResidual residual(data, candidate.residual.model(), candidate.state,
                                 candidate.layout);
    residual.Predict(theta, {forces.col(static_cast<Eigen::Index>(k)).data(), samples});
  }
  return forces.colwise() - force;
}

}  // namespace mindahl::identification
