#include "mindahl/loop/segments.h"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <span>

#include "core/extremes.h"
#include "loop/statistics.h"
#include "mindahl/loop/reversals.h"

namespace mindahl::loop {
namespace {

// When the ends of a record are not part of its test.

/// [of the load] Largest deviation of a constant load, which a fit hardly sees.
constexpr double kConstant = 0.01;
/// [standard deviations of the readings' white noise] The same by noise: of 10⁵ readings the
/// widest is 4.4 off.
constexpr double kLoadNoise = 5.0;
/// [of the samples] Least fraction under a constant load: a wave is at its tops for less.
constexpr double kMostOfIt = 0.6;
/// [of the widest of them] Strokes of one range differ by less.
constexpr double kAlike = 0.9;
/// [strokes] Fewer are not repeated: a record of one and a half cycles has three.
constexpr std::size_t kFewest = 4;
/// [of a usual stroke] Farther outside of all other strokes an end is travel: a first loading, a
/// growing amplitude and a nested loop are inside.
constexpr double kTravel = 0.25;
/// [of all strokes] Fewer strokes outside may be the swings of a broken specimen.
constexpr double kSmallPart = 0.125;
/// [of half the range] Largest change of a resting displacement: elastic creep of a rig at rest.
constexpr double kRest = 0.01;
/// [usual strokes] It rests for longer: a dwell at a turning point is a part of the motion, and a
/// sine is within `rest` of its extreme for 0.05 of a stroke to either side.
constexpr double kLongestDwell = 0.5;

/// The widest strokes of which four in succession are of one range, to a tenth.
struct RepeatedStrokes {
  double range = 0.0;     // [m] of the widest; 0 where no stroke is repeated
  std::size_t first = 0;  // number of the first and of the last of their points
  std::size_t last = 0;
};

/// A record and the part of it that is left.
struct Part {
  RecordView record;
  double gate = 0.0;                // [m]
  std::vector<std::size_t> points;  // samples of its ends and of its reversals
  TestPart test{};                  // why what is before and after it is left out
};

/// Leaves out all before a sample and after another.
void Keep(Part& part, std::string_view reason, std::size_t first, std::size_t last) {
  if (first > part.points.front() && part.test.before.empty()) part.test.before = reason;
  if (last < part.points.back() && part.test.after.empty()) part.test.after = reason;
  std::erase_if(part.points, [&](std::size_t point) { return point <= first || point >= last; });
  part.points.insert(part.points.begin(), first);
  part.points.push_back(last);
}

void LeaveOutLoadRamps(Part& part) {
  const std::span<const double> loads = part.record.normal_load;
  if (loads.empty()) return;
  const double load = Median(std::vector<double>(loads.begin(), loads.end()));
  const double tolerance =
      std::max(kConstant * std::abs(load), kLoadNoise * NoiseByDifferences(loads, 1));
  const auto is_constant = [&](double value) { return std::abs(value - load) <= tolerance; };
  const auto constant = static_cast<double>(std::ranges::count_if(loads, is_constant));
  if (constant < kMostOfIt * static_cast<double>(loads.size())) return;
  std::size_t first = 0;
  while (!is_constant(loads[first])) ++first;
  std::size_t last = loads.size() - 1;
  while (!is_constant(loads[last])) --last;
  const auto turn = std::ranges::lower_bound(part.points, first);
  const auto end = std::ranges::upper_bound(part.points, last);
  if (end - turn < static_cast<std::ptrdiff_t>(kFewest)) return;
  Keep(part, "load ramp", first == 0 ? 0 : turn[1], last);
}

RepeatedStrokes FindRepeated(std::span<const double> positions) {
  RepeatedStrokes repeated;
  std::vector<double> ranges;
  for (std::size_t k = 1; k < positions.size(); ++k) {
    ranges.push_back(std::abs(positions[k] - positions[k - 1]));
    if (ranges.size() < kFewest) continue;
    const auto [least, greatest] = ExtremesOf(std::span(ranges).last(kFewest));
    if (least < kAlike * std::max(greatest, repeated.range)) continue;
    if (kAlike * least > repeated.range) repeated.first = k - kFewest;
    repeated.range = std::max(repeated.range, greatest);
    repeated.last = k;
  }
  return repeated;
}

/// Returns the number of strokes at an end that are travel.
/// @param positions  [m] of the points, from that end to the last of the repeated strokes
/// @param range      [m] of such a stroke
std::size_t CountTravels(std::span<const double> positions, double range) {
  const double outside = kTravel * range;
  const double small_part = kSmallPart * static_cast<double>(positions.size());
  const std::size_t most = std::max(kFewest - 1, static_cast<std::size_t>(small_part));
  for (std::size_t count = 0; count <= most && count + 2 < positions.size(); ++count) {
    const double at = positions[count];
    const double next = positions[count + 1];
    const Extremes others = ExtremesOf(positions.subspan(count + 1));
    const bool is_outside = at < others.least - outside || at > others.greatest + outside;
    // From a rest on the way of a travel the next stroke is only a part of one.
    const bool is_part = std::abs(next - at) < kAlike * std::abs(positions[count + 2] - next);
    if (!is_outside && (count == 0 || !is_part)) return count;
  }
  return 0;
}

void LeaveOutTravels(Part& part) {
  std::vector<double> positions;
  for (const std::size_t point : part.points) positions.push_back(part.record.displacement[point]);
  const RepeatedStrokes repeated = FindRepeated(positions);
  if (!(repeated.range > 0)) return;
  const std::size_t before =
      CountTravels(std::span(positions).first(repeated.last + 1), repeated.range);
  std::ranges::reverse(positions);
  const std::size_t after =
      CountTravels(std::span(positions).first(positions.size() - repeated.first), repeated.range);
  if (before + after + 1 >= part.points.size()) return;
  Keep(part, "travel", part.points[before], part.points[part.points.size() - 1 - after]);
}

/// Returns the number of samples, at least one, at which the displacement rests from its start.
template <typename Displacements>
std::size_t Resting(Displacements displacements, double reach) {
  const double at_rest = *displacements.begin();
  const auto moves = std::ranges::find_if(
      displacements, [&](double displacement) { return std::abs(displacement - at_rest) > reach; });
  return static_cast<std::size_t>(moves - displacements.begin());
}

void LeaveOutRests(Part& part) {
  const std::size_t from = part.points.front();
  const std::span<const double> moved =
      part.record.displacement.subspan(from, part.points.back() - from + 1);
  const double reach = std::max(kRest * ExtremesOf(moved).half_range(), part.gate);
  std::vector<double> lengths;
  for (std::size_t k = 2; k + 1 < part.points.size(); ++k) {
    lengths.push_back(static_cast<double>(part.points[k] - part.points[k - 1]));
  }
  if (lengths.empty()) return;
  const double longest = kLongestDwell * Median(lengths);
  // One sample stays, from which the motion begins and at which it ends.
  const auto rest = [&](std::size_t samples) {
    return samples > 1 && static_cast<double>(samples) > longest ? samples - 1 : 0;
  };
  Keep(part, "rest", from + rest(Resting(moved, reach)),
       part.points.back() - rest(Resting(std::views::reverse(moved), reach)));
}

}  // namespace

TestPart FindTestPart(const RecordView& record) {
  if (record.size() == 0) return {};
  const double gate = ChooseReversalGate(record.displacement).gate;
  Part part{record, gate, FindReversals(record.displacement, gate)};
  part.points.insert(part.points.begin(), 0);
  part.points.push_back(record.size() - 1);
  LeaveOutLoadRamps(part);
  LeaveOutTravels(part);
  LeaveOutRests(part);
  part.test.first = part.points.front();
  part.test.last = part.points.back() + 1;
  part.test.begins_cycled = !part.test.before.empty() && part.test.before != "rest";
  return part.test;
}

}  // namespace mindahl::loop
