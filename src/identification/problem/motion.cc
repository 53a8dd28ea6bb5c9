#include "identification/problem/motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "core/refuse.h"
#include "identification/problem/parameters.h"

namespace mindahl::identification {
namespace {

/// Displacements and times of five samples about a turn, the outermost one in the middle.
struct FiveSamples {
  std::span<const double, 5> x;
  std::span<const double, 5> t;

  /// Velocity of the step from sample k to the next.
  [[nodiscard]] double Velocity(std::size_t k) const {
    return (x[k + 1] - x[k]) / (t[k + 1] - t[k]);
  }
};

/// Returns where the lines of both strokes meet; nothing where the velocity also changes elsewhere.
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
  const double weakest = greatest > 0 ? least : -greatest;
  if (!(weakest > kSmooth * std::max(std::abs(least), std::abs(greatest)))) return std::nullopt;
  std::array<double, 5> c{};  // Newton's form
  std::ranges::copy(about.x, c.begin());
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

/// Returns where a motion is between two samples without a turn between them: on their chord, or if
/// it turns between samples on the cubic through four. A second difference counts up to twice the
/// other one, so that the motion runs straight beside a corner, and in the first and the last step.
/// @param next  the later of the two samples
double PositionBetween(const ScaledRecord& motion, std::size_t next, double time) {
  const std::vector<double>& x = motion.displacement;
  const std::vector<double>& t = motion.time;
  const auto velocity = [&](std::size_t k) { return (x[k] - x[k - 1]) / (t[k] - t[k - 1]); };
  const double straight =
      std::lerp(x[next - 1], x[next], (time - t[next - 1]) / (t[next] - t[next - 1]));
  if (!motion.turns_between || next < 2 || next + 1 >= x.size()) return straight;
  const double before = (velocity(next) - velocity(next - 1)) / (t[next] - t[next - 2]);
  const double after = (velocity(next + 1) - velocity(next)) / (t[next + 1] - t[next - 1]);
  if (!std::isfinite(before) || !std::isfinite(after)) return straight;  // a repeated row
  const double most = 2 * std::min(std::abs(before), std::abs(after));
  const double half_curvature =
      std::lerp(std::clamp(before, -most, most), std::clamp(after, -most, most),
                (time - t[next - 2]) / (t[next + 1] - t[next - 2]));
  return straight + (time - t[next - 1]) * (time - t[next]) * half_curvature;
}

/// Returns when a motion turns between two samples, and as which power of time it comes and goes:
/// the second, or the first where it turns sharply.
/// @param next  the sample after the turn
std::pair<double, double> TimeOfTurn(const ScaledRecord& motion, std::size_t next,
                                     double displacement) {
  constexpr double kSharp = 2.0 / 3;  // of the step; smooth motions take a third of it
  const std::vector<double>& x = motion.displacement;
  const std::vector<double>& t = motion.time;
  const double step = t[next] - t[next - 1];
  const double there = displacement - x[next - 1];
  const double back = displacement - x[next];
  // At the speeds of the steps before and after:
  const double coming = there * (t[next - 1] - t[next - 2]) / (x[next - 1] - x[next - 2]);
  const double going = back * (t[next + 1] - t[next]) / (x[next] - x[next + 1]);
  const bool is_sharp = coming + going > kSharp * step;
  const double share = is_sharp ? coming / (coming + going) : 1 / (1 + std::sqrt(back / there));
  return {t[next - 1] + share * step, is_sharp ? 1.0 : 2.0};
}

/// Moves a contact whose force is read late. It turns where the record does, whatever the lag, and
/// rests beyond its ends; where the record turns at its samples it runs straight between them.
std::vector<models::Turn> MoveLate(const ScaledRecord& record, std::span<const models::Turn> turns,
                                   double lag, std::vector<double>& late) {
  const ScaledRecord& motion = record.motion();
  const std::span<const double> x = motion.displacement;
  const std::span<const double> t = motion.time;
  std::vector<models::Turn> moved;
  const auto turn_until = [&](std::size_t count) {
    while (moved.size() < count) moved.push_back({late.size(), turns[moved.size()].displacement});
  };
  std::size_t next = 1;    // the sample that the motion comes to next
  std::size_t before = 0;  // turns before this step
  for (const double read : record.time) {
    const double at = std::clamp(read - lag, t.front(), t.back());
    while (next + 1 < motion.size() && t[next] < at) ++next;
    while (before < turns.size() && turns[before].next < next) ++before;
    const bool turns_here = before < turns.size() && turns[before].next == next;
    const bool is_between = turns_here && turns[before].displacement != x[next - 1];
    double position = x[next];  // of two samples of the same time the later one counts
    bool has_turned = turns_here;
    if (is_between) {
      const double extreme = turns[before].displacement;
      const auto [time, power] = TimeOfTurn(motion, next, extreme);
      has_turned = !(at < time);
      const std::size_t end = has_turned ? next : next - 1;
      position = std::lerp(extreme, x[end], std::pow((time - at) / (time - t[end]), power));
    } else if (t[next] > t[next - 1]) {
      position = PositionBetween(motion, next, at);
    }
    turn_until(before + (has_turned ? 1 : 0));
    late.push_back(position);
  }
  turn_until(turns.size());
  return moved;
}

/// Moves a contact to one side of a gap. In each stroke it runs from where it was when the last one
/// ended. There the gap is closed on the side of the force that is measured, so that the path of
/// the contact depends on the gap alone: exact where no turning point lies within the gap.
/// @param side  +1 of the side that bears forces above zero, −1 of the other
std::vector<models::Turn> MoveBehindGap(const ScaledRecord& record,
                                        std::span<const models::Turn> turns, double gap,
                                        double side, const models::InitialContact& initial,
                                        std::vector<double>& behind) {
  const std::span<const double> x = record.displacement;
  const double half = gap / 2;
  const std::vector<Stroke> strokes = StrokesOf(record);
  std::vector<double> ends;
  for (std::size_t s = 0; s < strokes.size(); ++s) {
    const std::size_t end = strokes[s].end;
    const double closed = record.force[end] == 0 ? strokes[s].direction : record.force[end];
    const double at = s < turns.size() ? turns[s].displacement : x[end];
    ends.push_back(at - std::copysign(half, closed));
  }
  double from = 0.0;
  if (initial.state == models::InitialState::kVirgin) {
    // The contact is unloaded in the middle of the gap.
    from = x.front() - std::clamp(x.front() - initial.unloaded_displacement, -half, half);
  } else {
    const double direction = strokes.front().direction;
    from = x.front() + direction * half;
    for (const double end : ends) {
      if (direction * (end - from) < 0) from = end;
    }
  }
  std::vector<models::Turn> moved;
  for (std::size_t s = 0; s < strokes.size(); ++s) {
    // The contact does not move in a stroke that is shorter than the gap.
    const double to = strokes[s].direction * (ends[s] - from) >= 0 ? ends[s] : from;
    const auto [low, high] = std::minmax(from, to);
    const std::size_t end = s < turns.size() ? turns[s].next : record.size();
    while (behind.size() < end) {
      behind.push_back(std::clamp(x[behind.size()] - side * half, low, high));
    }
    if (s < turns.size()) moved.push_back({end, to});
    from = to;
  }
  behind.back() = from;
  return moved;
}

}  // namespace

std::vector<models::Turn> TurnsOf(const ScaledRecord& record) {
  const ScaledRecord& motion = record.motion();
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
    const FiveSamples about{x.subspan(i - 2).first<5>(), time.subspan(i - 2).first<5>()};
    const double sense = x[i] > x[last] ? 1.0 : -1.0;
    const bool is_before = sense * (x[i - 1] - x[i + 1]) > 0;  // the nearer neighbour's side
    std::optional<double> at = SharpTurn(about, is_before ? 1 : 2);
    if (!at) at = SmoothTurn(about);
    const double farthest = std::max(std::abs(x[i] - x[i - 1]), std::abs(x[i + 1] - x[i]));
    const double beyond = at ? sense * (*at - x[i]) : 0.0;
    if (beyond > 0 && beyond <= farthest) turn = {record.reversals[k] + (is_before ? 0U : 1U), *at};
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

double LongestLag(std::size_t samples, std::size_t reversals) {
  constexpr double kSamples = 10.0;
  constexpr double kLongest = 0.2;
  return std::clamp(kSamples / MeanCycleDuration(static_cast<double>(samples) - 1, reversals),
                    TermOf(TermId::kLag).highest, kLongest);
}

void LeaveOutBeyondLags(const FitOptions& options, loop::PreparedRecords& records) {
  if (!HasTerm(options, TermId::kLag) || records.excitation == loop::Channel::kForce) return;
  const loop::PreparedRecord& first = records.records.front();
  const std::size_t reversals = first.reversals.size();
  const std::span<const double> its_time = first.record.time;
  const double duration =
      its_time.empty() ? static_cast<double>(first.size()) - 1 : its_time.back() - its_time.front();
  const double longest =
      LongestLag(first.size(), reversals) * MeanCycleDuration(duration, reversals);
  Interval lags{-longest, longest};
  if (options.bounds.contains("lag")) lags = options.bounds.at("lag");
  if (options.fixed.contains("lag")) lags = {options.fixed.at("lag"), options.fixed.at("lag")};
  for (loop::PreparedRecord& record : records.records) {
    const std::span<const double> time = record.record.time;
    if (time.empty() != first.record.time.empty() ||
        (!time.empty() && !(time.back() > time.front()))) {
      throw InvalidArgument(
          "lag needs a time that increases in every record, or records without a time");
    }
    const auto at = [&](std::size_t i) { return time.empty() ? static_cast<double>(i) : time[i]; };
    const double begin = at(0);
    const double end = at(record.size() - 1);
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (at(i) - lags.upper < begin || at(i) - lags.lower > end) record.counts[i] = 0;
    }
    record.left_out = static_cast<std::size_t>(std::ranges::count(record.counts, 0));
    if (record.left_out < record.size()) continue;
    Refuse<InvalidArgument>(
        "lags of {:.6g} to {:.6g} move every sample of a record of {} beyond its ends: "
        "give smaller ones, --bound lag=LO:HI",
        lags.lower, lags.upper, record.size());
  }
}

void Locate(const ScaledRecord& record, std::span<const models::Turn> turns,
            std::optional<TermId> moved_by, double amount, models::Memory memory,
            const models::InitialContact& initial, Motion& motion) {
  motion.amount = amount;
  motion.initial = initial;
  motion.paths.resize(moved_by == TermId::kBacklash ? 2 : 1);
  if (!moved_by) {
    models::MakeLoadingPath(record.excitation(), turns, memory, initial, motion.paths.front().path);
    return;
  }
  for (double side = 1.0; auto& [displacement, path] : motion.paths) {
    displacement.clear();
    const std::vector<models::Turn> moved =
        moved_by == TermId::kLag
            ? MoveLate(record, turns, amount, displacement)
            : MoveBehindGap(record, turns, amount, side, initial, displacement);
    side = -1.0;
    models::MakeLoadingPath(displacement, moved, memory, initial, path);
  }
}

}  // namespace mindahl::identification
