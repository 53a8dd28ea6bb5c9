#include "convert/bouc_wen_shape.h"

#include <algorithm>
#include <cmath>

namespace mindahl::convert {
namespace {

// e^{−q²} < 2⁻⁵³ at the end.
constexpr double kLast = 6.1;
constexpr std::size_t kTableIntervals = 1220;
constexpr double kStep = kLast / kTableIntervals;

double ForceAt(double q) { return -std::expm1(-q * q); }

}  // namespace

BoucWenShape::BoucWenShape(double exponent, double beta)
    : exponent_(exponent), back_(1 - 2 * beta), nodes_(kTableIntervals + 1) {
  for (std::size_t i = 1; i <= kTableIntervals; ++i) {
    Node& node = nodes_[i];
    node.q = kStep * static_cast<double>(i);
    node.slope = SlopesAt(node.q);
    const Row more = Integrate(nodes_[i - 1].q, node.q);
    for (std::size_t k = 0; k < kColumns; ++k) {
      node.integral[k] = nodes_[i - 1].integral[k] + more[k];
    }
  }
}

/// Returns the derivatives of the integrals by q: those by t times dt/dq = 2q·e^{−q²}.
BoucWenShape::Row BoucWenShape::SlopesAt(double q) const {
  if (q == 0) return {};
  const double remaining = std::exp(-q * q);
  const double log_power = exponent_ * std::log1p(-remaining);
  const double power = std::exp(log_power);    // tⁿ
  const double left = -std::expm1(log_power);  // 1 − tⁿ
  const double per_q = 2 * q * remaining;
  const double back = 1 - back_ * power;  // β > 0: it never vanishes
  const double loading = per_q / left;
  const double unloading = per_q / back;
  // Cancelling parts of the difference are left out: (1 − c)tⁿ/((1 − tⁿ)(1 − c·tⁿ)).
  return {loading, unloading, loading + unloading,
          loading * ForceAt(q) * power * (1 - back_) / back};
}

/// Integrates by Gauss and Legendre at five places: exact to the ninth power of q, where Simpson's
/// rule loses the small loops, whose energy grows as q⁶ from zero.
BoucWenShape::Row BoucWenShape::Integrate(double from, double to) const {
  constexpr std::array kPlaces = {0.0, 0.5384693101056831, 0.9061798459386640};
  constexpr std::array kWeights = {0.5688888888888889, 0.4786286704993665, 0.2369268850561891};
  const double middle = (from + to) / 2;
  const double half = (to - from) / 2;
  Row sum{};
  for (std::size_t place = 0; place < kPlaces.size(); ++place) {
    for (const double side : {-1.0, 1.0}) {
      if (place == 0 && side > 0) continue;
      const Row slope = SlopesAt(middle + side * half * kPlaces[place]);
      for (std::size_t k = 0; k < kColumns; ++k) sum[k] += half * kWeights[place] * slope[k];
    }
  }
  return sum;
}

double BoucWenShape::Interpolate(std::size_t interval, double q, Column column) const {
  const Node& low = nodes_[interval];
  const Node& high = nodes_[interval + 1];
  const double u = (q - low.q) / kStep;
  const double from = low.slope[column] * kStep;
  const double to = high.slope[column] * kStep;
  const double rise = high.integral[column] - low.integral[column];
  return low.integral[column] +
         u * (from + u * ((3 * rise - 2 * from - to) + u * (from + to - 2 * rise)));
}

double BoucWenShape::At(double q, Column column) const {
  return Interpolate(std::min(static_cast<std::size_t>(q / kStep), kTableIntervals - 1), q, column);
}

/// Returns q at which an integral reaches the target.
double BoucWenShape::Solve(double target, Column column) const {
  const auto above = std::ranges::upper_bound(
      nodes_, target, {}, [column](const Node& node) { return node.integral[column]; });
  if (above == nodes_.end()) return kLast;
  if (above == nodes_.begin()) return 0.0;
  const auto interval = static_cast<std::size_t>(above - nodes_.begin()) - 1;
  const Node& low = nodes_[interval];
  const double from = low.slope[column] * kStep;
  const double to = above->slope[column] * kStep;
  const double rise = above->integral[column] - low.integral[column];
  // Newton's rule on the cubic, from its chord: the step is short, and four double the digits to
  // all.
  double u = (target - low.integral[column]) / rise;
  constexpr int kSteps = 5;
  for (int i = 0; i < kSteps; ++i) {
    const double value = u * (from + u * ((3 * rise - 2 * from - to) + u * (from + to - 2 * rise)));
    const double slope =
        from + u * (2 * (3 * rise - 2 * from - to) + u * 3 * (from + to - 2 * rise));
    if (!(slope > 0)) break;
    u = std::clamp(u - (value - (target - low.integral[column])) / slope, 0.0, 1.0);
  }
  return low.q + u * kStep;
}

BoucWenShape::Loop BoucWenShape::LoopOf(double y) const {
  const double q = Solve(2 * y, kWay);
  return {ForceAt(q), At(q, kUnloading)};
}

double BoucWenShape::Rising(const Loop& loop, double distance) const {
  return distance < loop.back ? -ForceAt(Solve(loop.back - distance, kUnloading))
                              : ForceAt(Solve(distance - loop.back, kLoading));
}

double BoucWenShape::Energy(double y) const {
  const double q = Solve(2 * y, kWay);
  const auto interval = std::min(static_cast<std::size_t>(q / kStep), kTableIntervals - 1);
  const Node& node = nodes_[interval];
  const double lost = node.integral[kLost] + Integrate(node.q, q)[kLost];
  // Motion beyond the table slides at the limit, in either direction.
  const double sliding = std::max(2 * y - nodes_.back().integral[kWay], 0.0);
  return 2 * (lost + sliding);
}

}  // namespace mindahl::convert
