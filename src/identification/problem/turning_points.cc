#include "identification/problem/turning_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

namespace mindahl::identification {
namespace {

/// The displacements of five samples about a turn, the outermost one in the middle, and their
/// times.
struct FiveSamples {
  std::array<double, 5> x;
  std::array<double, 5> t;

  /// Velocity of the step from sample k to the next.
  [[nodiscard]] double Velocity(std::size_t k) const {
    return (x[k + 1] - x[k]) / (t[k + 1] - t[k]);
  }
};

/// Returns where the lines of both strokes meet; nothing where the velocity changes elsewhere than
/// at the turn.
/// @param before  the last sample before the turn, 1 or 2
std::optional<double> SharpTurn(const FiveSamples& about, std::size_t before) {
  constexpr double kStraight = 0.1;  // change of the velocity beside the turn, over that at it
  const std::size_t after = before + 1;
  const double rising = about.Velocity(before - 1);
  const double falling = about.Velocity(after);
  // The stroke of three samples has a second step.
  const double beside = before > 1 ? std::abs(rising - about.Velocity(before - 2))
                                   : std::abs(falling - about.Velocity(after + 1));
  if (!(beside < kStraight * std::abs(rising - falling))) return std::nullopt;
  const double way = about.x[after] - about.x[before];
  const double since = (way - falling * (about.t[after] - about.t[before])) / (rising - falling);
  return about.x[before] + rising * since;
}

/// Returns the extremum of the polynomial through all five; nothing where the motion is not smooth.
std::optional<double> SmoothTurn(const FiveSamples& about) {
  constexpr double kSmooth = 0.7;  // least curvature beside the turn, over the largest
  constexpr int kSteps = 6;        // Newton's about a turn take three or four
  std::array<double, 3> curvatures{};
  for (std::size_t k = 0; k < 3; ++k) curvatures[k] = about.Velocity(k + 1) - about.Velocity(k);
  const auto [least, greatest] = std::ranges::minmax(curvatures);
  const double sense = greatest > 0 ? 1.0 : -1.0;
  const double weakest = sense > 0 ? least : -greatest;
  if (!(weakest > kSmooth * std::max(std::abs(least), std::abs(greatest)))) return std::nullopt;
  std::array<double, 5> c = about.x;  // Newton's form
  for (std::size_t order = 1; order < c.size(); ++order) {
    for (std::size_t k = c.size() - 1; k >= order; --k) {
      c[k] = (c[k] - c[k - 1]) / (about.t[k] - about.t[k - order]);
    }
  }
  std::array<double, 3> p{};  // value, first derivative, half the second
  double at = about.t[2];
  for (int step = 0; step <= kSteps; ++step) {
    if (step > 0) at = std::clamp(at - p[1] / (2 * p[2]), about.t[1], about.t[3]);
    p = {};
    for (std::size_t k = c.size(); k-- > 0;) {
      const double way = at - about.t[k];
      p = {p[0] * way + c[k], p[1] * way + p[0], p[2] * way + p[1]};
    }
  }
  return p[0];
}

}  // namespace

std::vector<models::Turn> TurnsOf(const ScaledRecord& record) {
  const ScaledRecord& motion = record.whole != nullptr ? *record.whole : record;
  const std::span<const double> x = motion.excitation();
  const std::span<const double> time = motion.time;
  std::vector<models::Turn> turns;
  for (std::size_t k = 0; k < motion.reversals.size(); ++k) {
    const std::size_t i = motion.reversals[k];
    models::Turn& turn = turns.emplace_back(record.reversals[k] + 1, x[i]);
    // All five lie on the two strokes that meet here.
    const std::size_t first = k > 0 ? motion.reversals[k - 1] : 0;
    const std::size_t last =
        k + 1 < motion.reversals.size() ? motion.reversals[k + 1] : x.size() - 1;
    if (!motion.turns_between || i < first + 2 || i + 2 > last) continue;
    FiveSamples about{};
    for (std::size_t j = 0; j < about.x.size(); ++j) {
      about.x[j] = x[i - 2 + j];
      about.t[j] = time[i - 2 + j];
    }
    const double sense = x[i] > x[last] ? 1.0 : -1.0;
    const bool is_before = sense * (x[i - 1] - x[i + 1]) > 0;  // the nearer neighbour's side
    std::optional<double> at = SharpTurn(about, is_before ? 1 : 2);
    if (!at) at = SmoothTurn(about);
    const double farthest = std::max(std::abs(x[i] - x[i - 1]), std::abs(x[i + 1] - x[i]));
    const double beyond = at ? sense * (*at - x[i]) : 0.0;
    if (!(beyond > 0 && beyond <= farthest)) continue;
    turn = {record.reversals[k] + (is_before ? 0U : 1U), *at};
  }
  return turns;
}

double TurnBetweenSamples(ScaledRecords& data) {
  double farthest = 0.0;
  for (ScaledRecord& record : data.records) {
    record.turns_between = record.imposed == loop::Channel::kDisplacement && !record.is_smoothed;
    const std::vector<models::Turn> turns = TurnsOf(record);
    for (std::size_t k = 0; k < turns.size(); ++k) {
      const double sample = record.excitation()[record.reversals[k]];
      farthest = std::max(farthest, std::abs(turns[k].displacement - sample));
    }
  }
  return farthest;
}

void TurnAtSamples(ScaledRecords& data) {
  for (ScaledRecord& record : data.records) record.turns_between = false;
}

}  // namespace mindahl::identification
