#include "mindahl/loop/segments.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <ranges>
#include <span>

#include "loop/rules.h"
#include "loop/statistics.h"
#include "loop/strokes.h"
#include "mindahl/loop/reversals.h"

namespace mindahl::loop {

namespace {

/// Medians of five, so that single readings end nothing.
std::vector<double> WithoutSpikes(std::span<const double> load) {
  constexpr std::size_t kReach = 2;
  std::vector<double> medians(load.begin(), load.end());
  for (std::size_t i = kReach; i + kReach < load.size(); ++i) {
    std::array<double, 2 * kReach + 1> about{};
    std::ranges::copy(load.subspan(i - kReach, about.size()), about.begin());
    std::ranges::nth_element(about, about.begin() + kReach);
    medians[i] = about[kReach];
  }
  return medians;
}

/// Successive samples [first, last) under one load.
struct LoadRun {
  std::size_t first = 0;
  std::size_t last = 0;
  double load = 0.0;    // [N]
  double spread = 0.0;  // [N], beyond the noise
};

/// A load without its spikes, and the noise [N] of its readings.
struct SmoothLoad {
  std::vector<double> values;
  double noise = 0.0;

  [[nodiscard]] double Tolerance(double load) const {
    return std::max(LoadStepRules::kConstant * load, LoadStepRules::kNoise * noise);
  }
};

/// Returns the samples from one on as far as the load stays within the tolerance, without the ends
/// of the adjacent ramps; `next` becomes the sample after them all.
LoadRun RunFrom(const SmoothLoad& of, std::size_t& next) {
  const std::span<const double> load = of.values;
  LoadRun run{.first = next, .last = next};
  double low = load[next];
  double high = low;
  for (; run.last < load.size(); ++run.last) {
    const double lower = std::min(low, load[run.last]);
    const double upper = std::max(high, load[run.last]);
    if (upper - lower > 2 * of.Tolerance((upper + lower) / 2)) break;
    low = lower;
    high = upper;
  }
  next = run.last;
  const std::span<const double> all = load.subspan(run.first, run.last - run.first);
  run.load = UpperMedian(std::vector<double>(all.begin(), all.end()));
  const double settled = of.Tolerance(run.load) / 2;
  const auto is_settled = [&](std::size_t i) { return std::abs(load[i] - run.load) <= settled; };
  while (run.first > 0 && run.first + 1 < run.last && !is_settled(run.first)) ++run.first;
  while (run.last < load.size() && run.first + 1 < run.last && !is_settled(run.last - 1)) {
    --run.last;
  }
  const auto [least, greatest] = std::ranges::minmax(load.subspan(run.first, run.last - run.first));
  run.spread = std::max(greatest - least - 2 * LoadStepRules::kNoise * of.noise, 0.0);
  return run;
}

bool AreSteps(std::span<const LoadRun> runs, const SmoothLoad& load) {
  if (runs.size() < 2) return false;
  std::size_t samples = runs.front().last - runs.front().first;
  for (std::size_t r = 1; r < runs.size(); ++r) {
    samples += runs[r].last - runs[r].first;
    const double step = std::abs(runs[r].load - runs[r - 1].load);
    const double smaller = std::min(runs[r].load, runs[r - 1].load);
    if (!(step > std::max(LoadStepRules::kStep * smaller, 4 * load.Tolerance(smaller)))) {
      return false;
    }
    if (std::max(runs[r].spread, runs[r - 1].spread) > LoadStepRules::kFlat * step) return false;
  }
  return static_cast<double>(samples) >=
         LoadStepRules::kShare * static_cast<double>(load.values.size());
}

/// The loads of a record that are constant for so many turning points.
struct ConstantLoads {
  SmoothLoad load;
  std::vector<std::size_t> reversals;
  std::vector<LoadRun> runs;

  [[nodiscard]] ConstantLoad PieceOf(const LoadRun& run) const {
    const auto turn = std::ranges::lower_bound(reversals, run.first);
    const std::size_t first = run.first == 0 ? 0 : *std::next(turn);
    return {.first = first, .last = run.last, .normal_load = run.load};
  }
};

ConstantLoads FindConstantLoads(const RecordView& record) {
  ConstantLoads loads;
  if (record.normal_load.empty()) return loads;
  loads.load = {WithoutSpikes(record.normal_load), NoiseByDifferences(record.normal_load, 1)};
  loads.reversals =
      FindReversals(record.displacement, ChooseReversalGate(record.displacement).gate);
  const auto next_turn = [&](std::size_t sample) {
    return std::ranges::lower_bound(loads.reversals, sample);
  };
  for (std::size_t i = 0; i < record.size();) {
    const LoadRun run = RunFrom(loads.load, i);
    const auto turns = static_cast<std::size_t>(next_turn(run.last) - next_turn(run.first));
    if (run.load > 0 && turns >= LoadStepRules::kTurns) loads.runs.push_back(run);
  }
  return loads;
}

}  // namespace

std::vector<ConstantLoad> FindLoadSteps(const RecordView& record) {
  const ConstantLoads loads = FindConstantLoads(record);
  std::vector<ConstantLoad> pieces;
  if (!AreSteps(loads.runs, loads.load)) return pieces;
  for (const LoadRun& run : loads.runs) pieces.push_back(loads.PieceOf(run));
  return pieces;
}

std::optional<ConstantLoad> FindSettledLoad(const RecordView& record) {
  const ConstantLoads loads = FindConstantLoads(record);
  const auto longest = std::ranges::max_element(
      loads.runs, {}, [](const LoadRun& run) { return run.last - run.first; });
  if (longest == loads.runs.end()) return std::nullopt;
  const ConstantLoad piece = loads.PieceOf(*longest);
  const bool is_whole = piece.first == 0 && piece.last == record.size();
  const bool is_short = static_cast<double>(piece.last - piece.first) <
                        LoadStepRules::kShare * static_cast<double>(record.size());
  return is_whole || is_short ? std::nullopt : std::optional(piece);
}

namespace {

constexpr std::string_view kLoadRamp = "load ramp";
constexpr std::string_view kTravel = "travel";
constexpr std::string_view kRest = "rest";

/// The strokes of a test, which are of one range, and the positions that they reach.
struct RepeatedStrokes {
  std::size_t first = 0;  // samples of the first and of the last turning point
  std::size_t last = 0;
  double range = 0.0;   // [m] of the widest
  double lowest = 0.0;  // [m]
  double highest = 0.0;
};

/// Describes excursions of nearly one range; nothing where they are too few, jump, or leave most of
/// their time to something else.
std::optional<RepeatedStrokes> StrokesOf(std::span<const double> displacement,
                                         std::span<const Excursion> excursions) {
  RepeatedStrokes strokes{.first = displacement.size(),
                          .range = excursions.back().range,
                          .lowest = displacement[excursions.back().first],
                          .highest = displacement[excursions.back().first]};
  std::size_t count = 0;
  double lasting = 0.0;  // [samples]
  for (const Excursion& excursion : excursions) {
    if (IsOneStep(displacement, excursion)) continue;
    count += excursion.reversals;
    lasting += static_cast<double>(excursion.duration() * excursion.reversals);
    strokes.first = std::min(strokes.first, excursion.first);
    strokes.last = std::max(strokes.last, excursion.last);
    const auto [low, high] =
        std::minmax(displacement[excursion.first], displacement[excursion.last]);
    strokes.lowest = std::min(strokes.lowest, low);
    strokes.highest = std::max(strokes.highest, high);
  }
  if (count < TestPartRules::kFewest) return std::nullopt;
  const auto span = static_cast<double>(strokes.last - strokes.first);
  if (lasting < TestPartRules::kFilled * span) return std::nullopt;
  return strokes;
}

/// Finds the widest strokes that others repeat.
std::optional<RepeatedStrokes> FindRepeatedStrokes(std::span<const double> displacement) {
  const std::vector<Excursion> excursions = FindExcursions(displacement);
  std::size_t last = excursions.size();
  for (std::size_t tried = 0; last > 0 && tried < TestPartRules::kClasses; ++tried) {
    const double widest = excursions[last - 1].range;
    if (!(widest > 0)) return std::nullopt;
    const auto first =
        std::ranges::lower_bound(excursions, TestPartRules::kAlike * widest, {}, &Excursion::range);
    const auto begin = static_cast<std::size_t>(first - excursions.begin());
    const std::span<const Excursion> alike = std::span(excursions).subspan(begin, last - begin);
    if (auto strokes = StrokesOf(displacement, alike)) return strokes;
    --last;
  }
  return std::nullopt;
}

/// Follows the turning points from an end of the test's strokes outwards, as long as none leaves
/// the positions of all before suddenly: amplitude and mean of a test may change slowly. What is
/// left is travel unless it has as many strokes, as wide or wider, as make a test, and more than a
/// small part of all: a random motion is a test, the swings of a broken specimen are none.
/// @returns the last sample of the test where there is travel outside of it
/// @param points  samples of the turning points, outwards, and of the end
/// @param travel  [m] by which travel leaves the positions
/// @param count   number of the strokes of the record
template <typename Points>
std::optional<std::size_t> Outside(std::span<const double> displacement, const Points& points,
                                   const RepeatedStrokes& strokes, double travel,
                                   std::size_t count) {
  double lowest = strokes.lowest;
  double highest = strokes.highest;
  auto point = points.begin();
  std::size_t last = *point;
  for (; point != points.end(); ++point) {
    const double at = displacement[*point];
    if (at < lowest - travel || at > highest + travel) break;
    // A rest within the stroke is no turn of the test.
    if (at < lowest + travel || at > highest - travel) last = *point;
    lowest = std::min(lowest, at);
    highest = std::max(highest, at);
  }
  if (point == points.end()) return std::nullopt;
  std::size_t as_wide = 0;
  for (auto next = std::next(point); next != points.end(); ++point, ++next) {
    if (std::abs(displacement[*next] - displacement[*point]) > strokes.range / 2) ++as_wide;
  }
  const auto small_part =
      static_cast<std::size_t>(TestPartRules::kSmallPart * static_cast<double>(count));
  const bool is_test = as_wide >= std::max(TestPartRules::kFewest, small_part);
  return is_test ? std::nullopt : std::optional(last);
}

/// Returns the number of samples, at least one, at which the displacement rests from its start.
template <typename Displacements>
std::size_t Resting(const Displacements& displacements, double reach) {
  const double at_rest = *displacements.begin();
  const auto moves = std::ranges::find_if(
      displacements, [&](double displacement) { return std::abs(displacement - at_rest) > reach; });
  return static_cast<std::size_t>(moves - displacements.begin());
}

/// Returns the number of samples of a usual stroke; 0 where there is none.
double UsualStroke(std::span<const double> displacement, double gate) {
  const std::vector<std::size_t> reversals = FindReversals(displacement, gate);
  const std::vector<std::size_t> points = TurningPoints(displacement, reversals);
  std::vector<double> lengths;
  for (std::size_t k = 1; k < points.size(); ++k) {
    lengths.push_back(static_cast<double>(points[k] - points[k - 1]));
  }
  return lengths.empty() ? 0.0 : UpperMedian(lengths);
}

void CutBefore(std::string_view reason, std::size_t first, TestPart& test) {
  if (first <= test.first) return;
  test.left_out.push_back({.reason = reason, .first = test.first, .last = first});
  test.begins_cycled = test.begins_cycled || reason != kRest;
  test.first = first;
}

void CutAfter(std::string_view reason, std::size_t last, TestPart& test) {
  if (last >= test.last) return;
  test.left_out.push_back({.reason = reason, .first = last, .last = test.last});
  test.last = last;
}

void LeaveOutTravel(std::span<const double> all, TestPart& test) {
  const std::size_t from = test.first;
  const std::span<const double> displacement = all.subspan(from, test.last - from);
  const std::optional<RepeatedStrokes> strokes = FindRepeatedStrokes(displacement);
  if (!strokes) return;
  const double travel = TestPartRules::kTravel * strokes->range;
  std::vector<std::size_t> points = FindReversals(displacement, travel);
  points.insert(points.begin(), 0);
  points.push_back(displacement.size() - 1);
  const auto turn = [&](std::size_t sample) { return std::ranges::lower_bound(points, sample); };
  const auto begin = std::make_reverse_iterator(std::next(turn(strokes->first)));
  const auto before = Outside(displacement, std::ranges::subrange(begin, points.rend()), *strokes,
                              travel, points.size());
  if (before) CutBefore(kTravel, from + *before, test);
  const auto after = Outside(displacement, std::ranges::subrange(turn(strokes->last), points.end()),
                             *strokes, travel, points.size());
  if (after) CutAfter(kTravel, from + *after + 1, test);
}

void LeaveOutRests(std::span<const double> displacement, TestPart& test) {
  const std::size_t from = test.first;
  const std::span<const double> moved = displacement.subspan(from, test.last - from);
  const double gate = ChooseReversalGate(moved).gate;
  const double usual = UsualStroke(moved, gate);
  if (!(usual > 0)) return;
  const auto [least, greatest] = std::ranges::minmax(moved);
  const double reach = std::max(TestPartRules::kRest * (greatest / 2 - least / 2), gate);
  const auto is_rest = [&](std::size_t samples) {
    return samples > 1 && static_cast<double>(samples) > TestPartRules::kLongestDwell * usual;
  };
  // One sample stays, from which the motion begins and at which it ends.
  const std::size_t before = Resting(moved, reach);
  if (is_rest(before)) CutBefore(kRest, from + before - 1, test);
  const std::size_t after = Resting(std::views::reverse(moved), reach);
  if (is_rest(after)) CutAfter(kRest, from + moved.size() - after + 1, test);
}

}  // namespace

TestPart FindTestPart(const RecordView& record) {
  TestPart test{.last = record.size()};
  if (record.size() == 0) return test;
  if (const std::optional<ConstantLoad> settled = FindSettledLoad(record)) {
    CutBefore(kLoadRamp, settled->first, test);
    CutAfter(kLoadRamp, settled->last, test);
  }
  LeaveOutTravel(record.displacement, test);
  LeaveOutRests(record.displacement, test);
  std::ranges::sort(test.left_out, {}, &LeftOut::first);
  return test;
}

}  // namespace mindahl::loop
