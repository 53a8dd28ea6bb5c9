#include "mindahl/loop/test_part.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <optional>
#include <ranges>
#include <span>
#include <utility>

#include "loop/rules.h"
#include "loop/statistics.h"
#include "loop/strokes.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/loop/segments.h"

namespace mindahl::loop {
namespace {

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
    if (LargestStep(displacement, excursion) >= TestPartRules::kJump * excursion.range) continue;
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

/// The part of a record that lies outside of its test, which ends at a sample.
struct Part {
  std::size_t sample = 0;
  bool is_travel = false;
};

/// Follows the turning points from an end of the test's strokes outwards, as long as none leaves
/// the positions of all before suddenly: amplitude and mean of a test may change slowly. What is
/// left is travel unless it has as many strokes, as wide or wider, as make a test, and more than a
/// small part of all: a random motion is a test, the swings of a broken specimen are none.
/// @param points  samples of the turning points, outwards, and of the end
/// @param travel  [m] by which travel leaves the positions
/// @param count   number of the strokes of the record
template <typename Points>
Part Outside(std::span<const double> displacement, const Points& points,
             const RepeatedStrokes& strokes, double travel, std::size_t count) {
  double lowest = strokes.lowest;
  double highest = strokes.highest;
  auto point = points.begin();
  Part outside{.sample = *point};
  for (; point != points.end(); ++point) {
    const double at = displacement[*point];
    if (at < lowest - travel || at > highest + travel) break;
    // A rest within the stroke is no turn of the test.
    if (at < lowest + travel || at > highest - travel) outside.sample = *point;
    lowest = std::min(lowest, at);
    highest = std::max(highest, at);
  }
  if (point == points.end()) return outside;
  std::size_t as_wide = 0;
  for (auto next = std::next(point); next != points.end(); ++point, ++next) {
    if (std::abs(displacement[*next] - displacement[*point]) > strokes.range / 2) ++as_wide;
  }
  const auto small_part =
      static_cast<std::size_t>(TestPartRules::kSmallPart * static_cast<double>(count));
  outside.is_travel = as_wide < std::max(TestPartRules::kFewest, small_part);
  return outside;
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

class TestSearch {
 public:
  explicit TestSearch(const RecordView& record) : record_(record) { test_.last = record.size(); }

  TestPart Find() {
    LeaveOutLoadRamps();
    LeaveOutTravel();
    LeaveOutRests();
    std::ranges::sort(test_.left_out, {}, &LeftOut::first);
    return std::move(test_);
  }

 private:
  [[nodiscard]] std::span<const double> Displacement() const {
    return record_.displacement.subspan(test_.first, test_.last - test_.first);
  }

  void CutBefore(LeftOutReason reason, std::size_t first) {
    if (first <= test_.first) return;
    test_.left_out.push_back({.reason = reason, .first = test_.first, .last = first});
    test_.begins_cycled = test_.begins_cycled || reason != LeftOutReason::kRest;
    test_.first = first;
  }

  void CutAfter(LeftOutReason reason, std::size_t last) {
    if (last >= test_.last) return;
    test_.left_out.push_back({.reason = reason, .first = last, .last = test_.last});
    test_.last = last;
  }

  void LeaveOutLoadRamps() {
    const std::optional<ConstantLoad> settled = FindSettledLoad(record_);
    if (!settled) return;
    CutBefore(LeftOutReason::kLoadRamp, settled->first);
    CutAfter(LeftOutReason::kLoadRamp, settled->last);
  }

  void LeaveOutTravel() {
    const std::span<const double> displacement = Displacement();
    const std::size_t from = test_.first;
    const std::optional<RepeatedStrokes> strokes = FindRepeatedStrokes(displacement);
    if (!strokes) return;
    const double travel = TestPartRules::kTravel * strokes->range;
    std::vector<std::size_t> points = FindReversals(displacement, travel);
    points.insert(points.begin(), 0);
    points.push_back(displacement.size() - 1);
    const auto turn = [&](std::size_t sample) { return std::ranges::lower_bound(points, sample); };
    const auto begin = std::make_reverse_iterator(std::next(turn(strokes->first)));
    const Part before = Outside(displacement, std::ranges::subrange(begin, points.rend()), *strokes,
                                travel, points.size());
    if (before.is_travel) CutBefore(LeftOutReason::kTravel, from + before.sample);
    const Part after =
        Outside(displacement, std::ranges::subrange(turn(strokes->last), points.end()), *strokes,
                travel, points.size());
    if (after.is_travel) CutAfter(LeftOutReason::kTravel, from + after.sample + 1);
  }

  void LeaveOutRests() {
    const std::span<const double> displacement = Displacement();
    const std::size_t from = test_.first;
    const double gate = ChooseReversalGate(displacement).gate;
    const double usual = UsualStroke(displacement, gate);
    if (!(usual > 0)) return;
    const auto [least, greatest] = std::ranges::minmax(displacement);
    const double reach = std::max(TestPartRules::kRest * (greatest / 2 - least / 2), gate);
    const auto is_rest = [&](std::size_t samples) {
      return samples > 1 && static_cast<double>(samples) > TestPartRules::kLongestDwell * usual;
    };
    // One sample stays, from which the motion begins and at which it ends.
    const std::size_t before = Resting(displacement, reach);
    if (is_rest(before)) CutBefore(LeftOutReason::kRest, from + before - 1);
    const std::size_t after = Resting(std::views::reverse(displacement), reach);
    if (is_rest(after)) CutAfter(LeftOutReason::kRest, from + displacement.size() - after + 1);
  }

  const RecordView& record_;
  TestPart test_;
};

}  // namespace

std::string_view NameOf(LeftOutReason reason) {
  constexpr std::array<std::string_view, 3> kNames = {"load ramp", "travel", "rest"};
  return kNames[static_cast<std::size_t>(reason)];
}

TestPart FindTestPart(const RecordView& record) {
  if (record.size() == 0) return {};
  return TestSearch(record).Find();
}

}  // namespace mindahl::loop
