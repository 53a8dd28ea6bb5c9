#include "identification/problem/ripple.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <cstddef>
#include <numbers>
#include <vector>

namespace mindahl::identification {
namespace {

struct PlacedForce {
  double position;
  double force;
};

/// Takes the least-squares cubic over the position off.
void TakeOffCubic(std::vector<PlacedForce>& forces) {
  const auto size = static_cast<Eigen::Index>(forces.size());
  Eigen::MatrixXd columns(size, 4);
  Eigen::VectorXd values(size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const PlacedForce& at = forces[static_cast<std::size_t>(i)];
    const double square = at.position * at.position;
    columns.row(i) << 1.0, at.position, square, square * at.position;
    values[i] = at.force;
  }
  const Eigen::VectorXd left = values - columns * columns.householderQr().solve(values);
  for (Eigen::Index i = 0; i < size; ++i) forces[static_cast<std::size_t>(i)].force = left[i];
}

/// Forces of the strokes of one direction, of their second halves.
std::vector<PlacedForce> SlidingForces(const ScaledRecords& data, bool is_up) {
  constexpr double kMayStick = 0.5;
  constexpr std::size_t kFewest = 12;  // for a cubic and a wave to be distinguished from noise
  std::vector<PlacedForce> forces;
  for (const ScaledRecord& record : data.records) {
    std::size_t begin = 0;
    for (std::size_t s = 0; s <= record.reversals.size(); ++s) {
      const std::size_t end = s < record.reversals.size() ? record.reversals[s] : record.size() - 1;
      const double from = record.displacement[begin];
      const double way = record.displacement[end] - from;
      for (std::size_t i = begin; i <= end && (way > 0) == is_up; ++i) {
        const double position = record.displacement[i];
        if ((position - from) / way < kMayStick || record.counts[i] == 0) continue;
        forces.push_back({position, record.force[i]});
      }
      begin = end;
    }
  }
  if (forces.size() < kFewest) return {};
  TakeOffCubic(forces);
  return forces;
}

}  // namespace

double StartingPeriod(const ScaledRecords& data) {
  constexpr double kLongest = 1.0;
  constexpr double kHighestFrequency = 40.0;
  constexpr double kStep = 0.1;  // of the frequency: a fifth of what a stroke resolves
  constexpr std::size_t kMostSamples = 500;
  const std::vector<PlacedForce> directions[] = {SlidingForces(data, true),
                                                 SlidingForces(data, false)};
  double best = 0.0;
  double period = kLongest;
  for (double frequency = 1 / kLongest; frequency <= kHighestFrequency; frequency += kStep) {
    double power = 0.0;
    for (const std::vector<PlacedForce>& forces : directions) {
      const std::size_t every = 1 + forces.size() / kMostSamples;
      std::complex<double> sum = 0.0;
      for (std::size_t i = 0; i < forces.size(); i += every) {
        sum += forces[i].force *
               std::polar(1.0, 2 * std::numbers::pi * frequency * forces[i].position);
      }
      if (!forces.empty()) {
        power += std::norm(sum) * static_cast<double>(every) / static_cast<double>(forces.size());
      }
    }
    if (!(power > best)) continue;
    best = power;
    period = 1 / frequency;
  }
  return std::min(period, kLongest);
}

}  // namespace mindahl::identification
