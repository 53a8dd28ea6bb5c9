#include "mindahl/loop/reversals.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "loop/rules.h"
#include "loop/statistics.h"
#include "loop/strokes.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/disturbances.h"

namespace mindahl::loop {

std::vector<std::size_t> FindReversals(std::span<const double> displacement, double gate) {
  RequireNonNegative("reversal gate [m]", gate);
  std::vector<std::size_t> reversals;
  ReversalFinder finder(gate);
  for (const double x : displacement) {
    if (const std::optional<std::size_t> reversal = finder.Add(x)) reversals.push_back(*reversal);
  }
  return reversals;
}

namespace {

/// Returns the extremes, with the record's ends.
std::vector<std::size_t> LocalExtremes(std::span<const double> displacement) {
  std::vector<std::size_t> points = FindReversals(displacement, 0.0);
  if (displacement.empty()) return points;
  points.insert(points.begin(), 0);
  points.push_back(displacement.size() - 1);
  return points;
}

}  // namespace

std::vector<Excursion> FindExcursions(std::span<const double> displacement) {
  // Points that are still open are kept in front of those not yet visited.
  std::vector<std::size_t> points = LocalExtremes(displacement);
  std::vector<Excursion> excursions;
  excursions.reserve(points.size());
  std::size_t open = 0;
  const auto excursion = [&](std::size_t i, std::size_t reversals) {
    return Excursion{std::abs(displacement[points[i + 1]] - displacement[points[i]]), points[i],
                     points[i + 1], reversals};
  };
  for (const std::size_t point : points) {
    points[open++] = point;
    while (open >= 4) {
      const Excursion inner = excursion(open - 3, 2);
      if (inner.range > excursion(open - 4, 1).range ||
          inner.range > excursion(open - 2, 1).range) {
        break;
      }
      excursions.push_back(inner);
      points[open - 3] = points[open - 1];
      open -= 2;
    }
  }
  for (std::size_t i = 0; i + 1 < open; ++i) excursions.push_back(excursion(i, 1));
  std::ranges::sort(excursions, [](const Excursion& one, const Excursion& other) {
    return one.range != other.range ? one.range < other.range : one.first < other.first;
  });
  return excursions;
}

std::size_t CountReversals(std::span<const Excursion> excursions, double gate) {
  std::size_t ends = 0;
  for (const Excursion& excursion : excursions) {
    if (excursion.range > gate) ends += excursion.reversals;
  }
  return ends == 0 ? 0 : ends - 1;  // one stroke is left, with a reversal at neither end
}

namespace {

using Excursions = std::span<const Excursion>;

/// Returns the median duration [samples] of the strokes at least half as wide as the widest.
double MainDuration(Excursions excursions) {
  std::vector<std::size_t> durations;
  durations.reserve(excursions.size());
  for (const Excursion& excursion : excursions) {
    if (excursion.range >= excursions.back().range / 2) durations.push_back(excursion.duration());
  }
  return static_cast<double>(UpperMedian(durations));
}

/// Returns the widest excursion [m] that white noise or an encoder's last digit makes.
double ReachOfNoise(std::span<const double> displacement, double full_range,
                    const ReversalRules& rules) {
  const double noise = EstimateDisplacementNoise(displacement);
  if (noise > rules.rough * full_range) return 0.0;
  // Normal noise of n samples reaches √(2 ln n) standard deviations to either side.
  return rules.beyond * 2 * noise *
         std::sqrt(2 * std::log(static_cast<double>(displacement.size())));
}

/// True if one step makes much of the excursion; false for long ones, which no jump makes.
bool Jumps(std::span<const double> displacement, const Excursion& excursion, double share) {
  constexpr std::size_t kLongest = 64;  // [samples]
  if (excursion.duration() > kLongest) return false;
  return LargestStep(displacement, excursion) >= share * excursion.range;
}

/// Classifies an excursion by itself.
enum class Look : unsigned char {
  kNoise,
  kUnclear,  // noise that takes its time, or a record cut just after it turned
  kOdd,      // neither: brief and smooth
  kDrive,
};

/// Looks at excursions one by one.
class Judge {
 public:
  Judge(std::span<const double> displacement, Excursions excursions, const ReversalRules& rules)
      : displacement_(displacement),
        rules_(rules),
        main_duration_(MainDuration(excursions)),
        main_range_(excursions.back().range / 2) {
    // Without a brief one there is no noise to be estimated.
    if (std::ranges::any_of(excursions, [&](const Excursion& one) { return IsBrief(one); })) {
      reach_ = ReachOfNoise(displacement, excursions.back().range, rules);
      any_brief_ = true;
    }
  }

  [[nodiscard]] bool any_brief() const { return any_brief_; }
  [[nodiscard]] bool IsBrief(const Excursion& excursion) const {
    return LastsAtMost(excursion, rules_.brief);
  }

  [[nodiscard]] Look LookAt(const Excursion& excursion) const {
    if (excursion.range >= main_range_) return Look::kDrive;
    const bool at_an_end = excursion.reversals == 1;
    if (excursion.range <= reach_) {
      return IsBrief(excursion) && !at_an_end ? Look::kNoise : Look::kUnclear;
    }
    if (LastsAtMost(excursion, rules_.sudden) && Jumps(displacement_, excursion, rules_.jump)) {
      return at_an_end ? Look::kUnclear : Look::kNoise;
    }
    return IsBrief(excursion) && !at_an_end ? Look::kOdd : Look::kDrive;
  }

 private:
  [[nodiscard]] bool LastsAtMost(const Excursion& excursion, double share) const {
    return excursion.range < main_range_ &&
           static_cast<double>(excursion.duration()) <= share * main_duration_;
  }

  std::span<const double> displacement_;
  const ReversalRules& rules_;
  double main_duration_;  // [samples]
  double main_range_;     // [m]
  double reach_ = 0.0;    // [m]
  bool any_brief_ = false;
};

/// Marks as unclear what would be a turn just before an end of the record, were there not many
/// disturbances that are as brief and wider: the record may as well end within one of those.
void DoubtEnds(Excursions excursions, const Judge& judge, const ReversalRules& rules,
               std::span<Look> looks) {
  std::size_t wider = 0;
  for (std::size_t i = excursions.size(); i-- > 0;) {
    if (looks[i] == Look::kOdd) ++wider;
    const bool ends = excursions[i].reversals == 1 && judge.IsBrief(excursions[i]);
    if (ends && looks[i] == Look::kDrive && wider >= rules.many) looks[i] = Look::kUnclear;
  }
}

/// A range of gates [m] under which the count is the same.
struct Plateau {
  double lower = 0.0;
  double upper = 0.0;
  std::size_t below = 0;       // excursions that are taken for noise
  std::size_t exceptions = 0;  // that look otherwise than they are taken

  [[nodiscard]] double width() const { return lower > 0 ? std::log(upper / lower) : 0.0; }
  /// Returns a gate well above what it rejects, but not at the small strokes.
  [[nodiscard]] double gate() const { return std::min(2 * lower, std::sqrt(lower * upper)); }
};

/// Calls visit(plateau) for each plateau between two ranges, from the lowest, up to the first
/// stroke of the drive.
template <typename Visit>
void ForEachPlateau(Excursions excursions, std::span<const Look> looks, Visit visit) {
  Plateau plateau{.exceptions = static_cast<std::size_t>(std::ranges::count(looks, Look::kNoise))};
  for (std::size_t i = 0; i + 1 < excursions.size() && looks[i] != Look::kDrive; ++i) {
    plateau.lower = excursions[i].range;
    plateau.upper = excursions[i + 1].range;
    plateau.below = i + 1;
    if (looks[i] == Look::kNoise) --plateau.exceptions;
    if (looks[i] == Look::kOdd) ++plateau.exceptions;
    if (plateau.upper > plateau.lower) visit(plateau);
  }
}

/// Returns the widest of the plateaus nearly as good as the best.
Plateau WidestPlateau(Excursions excursions, std::span<const Look> looks,
                      const ReversalRules& rules) {
  const auto noise = static_cast<std::size_t>(std::ranges::count(looks, Look::kNoise));
  Plateau widest;
  if (noise == 0) return widest;
  std::size_t fewest = noise;  // under no gate
  ForEachPlateau(excursions, looks,
                 [&](const Plateau& plateau) { fewest = std::min(fewest, plateau.exceptions); });
  const double allowed =
      static_cast<double>(fewest) + rules.exceptions * static_cast<double>(noise);
  ForEachPlateau(excursions, looks, [&](const Plateau& plateau) {
    const bool is_good = static_cast<double>(plateau.exceptions) <= allowed;
    if (is_good && plateau.width() > widest.width()) widest = plateau;
  });
  return widest;
}

/// Returns a far wider plateau above many brief excursions that lie as densely as those of noise,
/// though none of them looks like it: vibration, or noise that a filter has made smooth.
Plateau AboveSmoothDisturbances(Excursions excursions, const Judge& judge,
                                const ReversalRules& rules) {
  Plateau widest;
  double least = 0.0;  // of the brief excursions, since the last gap
  std::size_t count = 0;
  for (std::size_t i = 0; i + 1 < excursions.size() && judge.IsBrief(excursions[i]); ++i) {
    const double range = excursions[i].range;
    if (i == 0 || range > rules.clear * excursions[i - 1].range) {
      least = range;
      count = 0;
    }
    ++count;
    const double upper = excursions[i + 1].range;
    if (count >= rules.many && range >= rules.spread * least && upper >= rules.far * range) {
      widest = {.lower = range, .upper = upper, .below = i + 1};
    }
  }
  return widest;
}

/// @param other  another gate that competes
ReversalGate Under(Excursions excursions, double gate, std::optional<double> other = {}) {
  const std::size_t count = CountReversals(excursions, gate);
  return {.gate = gate,
          .count = count,
          .certain = !other,
          .other_count = other ? CountReversals(excursions, *other) : count,
          .other_gate = other.value_or(gate)};
}

/// Chooses the gate by what the excursions look like, one by one.
ReversalGate ChooseByLooks(std::span<const double> displacement, Excursions excursions,
                           const ReversalRules& rules) {
  const Judge judge(displacement, excursions, rules);
  if (!judge.any_brief()) return Under(excursions, 0.0);
  std::vector<Look> looks;
  looks.reserve(excursions.size());
  for (const Excursion& excursion : excursions) looks.push_back(judge.LookAt(excursion));
  DoubtEnds(excursions, judge, rules, looks);
  const Plateau chosen = WidestPlateau(excursions, looks, rules);
  const Plateau smooth = AboveSmoothDisturbances(excursions, judge, rules);
  if (smooth.below > chosen.below) return Under(excursions, smooth.gate(), chosen.gate());
  if (chosen.below == 0) return Under(excursions, 0.0);
  if (chosen.upper >= rules.clear * chosen.lower) return Under(excursions, chosen.gate());
  const auto kept = static_cast<double>(excursions.size() - chosen.below);
  return static_cast<double>(chosen.below) < rules.outnumber * kept
             ? Under(excursions, 0.0, chosen.gate())
             : Under(excursions, chosen.gate(), 0.0);
}

}  // namespace

ReversalGate ChooseReversalGate(std::span<const double> displacement) {
  const ReversalRules rules;
  const std::vector<Excursion> excursions = FindExcursions(displacement);
  if (excursions.size() < 2) return Under(excursions, 0.0);
  const ReversalGate chosen = ChooseByLooks(displacement, excursions, rules);
  // An encoder that counts to and fro is at rest, however long that takes it.
  const double flicker = rules.counts * EncoderStep(displacement);
  const bool flickers = excursions.front().range <= flicker;
  const bool is_stroke = flicker >= excursions.back().range / 2;
  return flickers && !is_stroke && flicker > chosen.gate ? Under(excursions, flicker) : chosen;
}

}  // namespace mindahl::loop
