#include "identification/solve/turning_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

namespace mindahl::identification {
namespace {

/// +1 where a record's reversal is a maximum, −1 where it is a minimum.
double SenseOfTurn(const ScaledRecord& record, std::size_t reversal) {
  const bool is_last = reversal + 1 == record.reversals.size();
  const std::size_t next = is_last ? record.size() - 1 : record.reversals[reversal + 1];
  return record.displacement[record.reversals[reversal]] > record.displacement[next] ? 1.0 : -1.0;
}

/// Returns how far a turning point may lie beyond its sample: the longer of the adjacent steps.
double LongestOvershoot(const ScaledRecord& record, std::size_t reversal) {
  const std::size_t i = record.reversals[reversal];
  const auto& x = record.displacement;
  return std::max(std::abs(x[i] - x[i - 1]), std::abs(x[i + 1] - x[i]));
}

/// Extremum beyond x₀ of the polynomial through samples first … last about it; from three samples
/// the parabola's. Newton's form, and his method from the middle.
double SmoothOvershoot(std::span<const double> x, std::span<const double> t, std::size_t i,
                       std::size_t first, std::size_t last) {
  constexpr std::size_t kMost = 5;
  constexpr int kSteps = 6;  // a parabola takes one, a quartic about a turn three or four
  std::array<double, kMost> c{};
  const std::size_t count = last - first + 1;
  std::copy_n(x.begin() + static_cast<std::ptrdiff_t>(first), count, c.begin());
  for (std::size_t order = 1; order < count; ++order) {
    for (std::size_t k = count - 1; k >= order; --k) {
      c[k] = (c[k] - c[k - 1]) / (t[first + k] - t[first + k - order]);
    }
  }
  const auto evaluate = [&](double at) {
    std::array<double, 3> p{};  // value, first derivative, half the second
    for (std::size_t k = count; k-- > 0;) {
      const double step = at - t[first + k];
      p[2] = p[2] * step + p[1];
      p[1] = p[1] * step + p[0];
      p[0] = p[0] * step + c[k];
    }
    return p;
  };
  double at = t[i];
  for (int k = 0; k < kSteps; ++k) {
    const auto p = evaluate(at);
    const double next = std::clamp(at - p[1] / (2 * p[2]), t[i - 1], t[i + 1]);
    if (next == at) break;
    at = next;
  }
  return std::abs(evaluate(at)[0] - x[i]);
}

/// True if the motion turns before its outermost sample, where the neighbour is the nearer one.
bool TurnsBefore(std::span<const double> x, std::size_t i, double sense) {
  return sense * (x[i - 1] - x[i + 1]) > 0;
}

/// Returns the overshoot beyond x₀ of where the lines through two samples before the turn and two
/// after it meet; empty where the turn is not sharp.
std::optional<double> SharpOvershoot(std::span<const double> x, std::span<const double> t,
                                     std::size_t i, double sense) {
  const std::size_t a = TurnsBefore(x, i, sense) ? i - 1 : i;  // the last before the turn
  const std::size_t b = a + 1;
  if (a < 2 || b + 2 >= x.size()) return {};
  const auto velocity = [&](std::size_t k) { return (x[k + 1] - x[k]) / (t[k + 1] - t[k]); };
  const double rising = velocity(a - 1);
  const double falling = velocity(b);
  const double at_turn = std::abs(rising - falling);
  const double beside = std::abs(rising - velocity(a - 2)) + std::abs(velocity(b + 1) - falling);
  // For a parabola both are equal; for a triangle the velocity changes at the turn only.
  if (!(beside < at_turn / 2)) return {};
  const double since = (x[b] - x[a] - falling * (t[b] - t[a])) / (rising - falling);
  return sense * (x[a] + rising * since - x[i]);
}

}  // namespace

double OvershootOfMotion(const ScaledRecord& record, std::size_t reversal) {
  const std::size_t i = record.reversals[reversal];
  const std::span<const double> x = record.displacement;
  const std::span<const double> t = record.time;
  const std::optional<double> sharp = SharpOvershoot(x, t, i, SenseOfTurn(record, reversal));
  // Five samples where they lie on the two strokes that meet here.
  const std::size_t before = reversal > 0 ? record.reversals[reversal - 1] : 0;
  const bool is_last = reversal + 1 == record.reversals.size();
  const std::size_t after = is_last ? x.size() - 1 : record.reversals[reversal + 1];
  const std::size_t reach = i >= before + 2 && i + 2 <= after ? 2 : 1;
  const double overshoot = sharp ? *sharp : SmoothOvershoot(x, t, i, i - reach, i + reach);
  return std::clamp(std::isfinite(overshoot) ? overshoot : 0.0, 0.0,
                    LongestOvershoot(record, reversal));
}

ScaledRecords PutInTurningPoints(const ScaledRecords& data, std::span<const double> overshoot) {
  ScaledRecords turned = data;
  std::size_t next_overshoot = 0;
  for (std::size_t r = 0; r < data.records.size(); ++r) {
    const ScaledRecord& record = data.records[r];
    std::vector<std::size_t> samples;
    std::vector<std::size_t> turns;
    std::size_t next = 0;
    const auto copy_until = [&](std::size_t end) {
      while (next < end) samples.push_back(next++);
    };
    for (std::size_t k = 0; k < record.reversals.size(); ++k) {
      const std::size_t i = record.reversals[k];
      copy_until(TurnsBefore(record.displacement, i, SenseOfTurn(record, k)) ? i : i + 1);
      turns.push_back(samples.size());
      samples.push_back(i);
    }
    copy_until(record.size());
    ScaledRecord& target = turned.records[r] = record.At(samples);
    target.inserted.assign(target.size(), 0);
    for (std::size_t k = 0; k < turns.size(); ++k) {
      target.displacement[turns[k]] += SenseOfTurn(record, k) * overshoot[next_overshoot++];
      target.root_weight[turns[k]] = 0.0;
      target.counts[turns[k]] = 0;
      target.inserted[turns[k]] = 1;
    }
    target.reversals = std::move(turns);
  }
  return turned;
}

}  // namespace mindahl::identification
