#include "mindahl/loop/reversals.h"

#include <cmath>
#include <ranges>

#include "loop/excursions.h"
#include "loop/statistics.h"
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

std::vector<Excursion> FindExcursions(std::span<const double> displacement) {
  if (displacement.empty()) return {};
  // The extremes, with the record's ends; those still open stand before those not yet visited.
  std::vector<std::size_t> points = FindReversals(displacement, 0.0);
  points.insert(points.begin(), 0);
  points.push_back(displacement.size() - 1);
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

namespace {

// When an excursion of the displacement looks like noise, and when a gate is certain.

/// [of the main strokes' duration] Longest noise; a nested loop of few samples is not shorter.
constexpr double kBrief = 1.0 / 3;
/// [of the main strokes' duration] Longest jump of the gauge beyond the white noise: an inner
/// loop that the drive makes on its way may last longer.
constexpr double kSudden = 1.0 / 8;
/// [of the excursion's range] Least fraction in one step between samples of a jump: a drive that
/// turns twice takes more samples to do so, while noise and an encoder's last digit take one.
constexpr double kJump = 0.4;
/// [-] Over the likely reach of n samples' normal noise, 2√(2 ln n) standard deviations, which a
/// twentieth of records exceed, and whose deviation is an estimate.
constexpr double kBeyond = 1.25;
/// [of the full range] Largest noise; more is a rough drive, a sequence of unrelated places.
constexpr double kRough = 0.05;
/// [of the excursions that look like noise] Largest fraction classified otherwise.
constexpr double kExceptions = 0.05;
/// [-] Ratio of a plateau's ends below which it is narrow.
constexpr double kClear = 2.5;
/// [-] Under a narrow plateau the noise is believed where there is so much more of it than of the
/// drive: of random walks, whose excursions are of all ranges, it is not.
constexpr double kOutnumber = 20.0;
/// So many wider ones that are as brief make a turn just before an end of the record unclear.
constexpr std::size_t kMany = 8;

/// Classifies an excursion by itself.
enum class Look : unsigned char {
  kNoise,
  kUnclear,  // noise that takes its time, or a record cut just after it turned
  kOdd,      // neither: brief and smooth
  kDrive,
};

/// An excursion and what it looks like.
struct JudgedExcursion : Excursion {
  Look look = Look::kDrive;
};

/// True if one step between samples makes much of an excursion; no jump makes a long one.
bool Jumps(std::span<const double> displacement, const Excursion& excursion) {
  constexpr std::size_t kLongest = 64;  // [samples]
  if (excursion.duration() > kLongest) return false;
  for (std::size_t i = excursion.first + 1; i <= excursion.last; ++i) {
    const double step = std::abs(displacement[i] - displacement[i - 1]);
    if (step >= kJump * excursion.range) return true;
  }
  return false;
}

/// Looks at excursions one by one; empty where none is brief, so that there is no noise.
std::vector<JudgedExcursion> Judge(std::span<const double> displacement,
                                   std::span<const Excursion> excursions) {
  const double main_range = excursions.back().range / 2;
  std::vector<double> durations;  // [samples] of the main strokes
  for (const Excursion& one : excursions) {
    if (one.range >= main_range) durations.push_back(static_cast<double>(one.duration()));
  }
  const double main_duration = Median(durations);
  const auto lasts_at_most = [&](const Excursion& excursion, double share) {
    return excursion.range < main_range &&
           static_cast<double>(excursion.duration()) <= share * main_duration;
  };
  const auto is_brief = [&](const Excursion& excursion) {
    return lasts_at_most(excursion, kBrief);
  };
  if (std::ranges::none_of(excursions, is_brief)) return {};
  std::vector<JudgedExcursion> judged;
  judged.reserve(excursions.size());
  // The widest excursion that white noise or an encoder's last digit makes: normal noise of n
  // samples reaches √(2 ln n) standard deviations to either side.
  const double noise = EstimateDisplacementNoise(displacement);
  const double deviations = std::sqrt(2 * std::log(static_cast<double>(displacement.size())));
  const bool is_rough = noise > kRough * excursions.back().range;
  const double reach = is_rough ? 0.0 : kBeyond * 2 * noise * deviations;
  for (const Excursion& one : excursions) {
    const bool is_brief_inside = is_brief(one) && one.reversals != 1;
    Look look = is_brief_inside ? Look::kOdd : Look::kDrive;
    if (one.range < main_range && one.range <= reach) {
      look = is_brief_inside ? Look::kNoise : Look::kUnclear;
    } else if (lasts_at_most(one, kSudden) && Jumps(displacement, one)) {
      look = one.reversals == 1 ? Look::kUnclear : Look::kNoise;
    }
    judged.push_back({one, look});
  }
  // An apparent reversal just before an end of the record is unclear where many disturbances are as
  // brief and wider: the record may end within one of them.
  std::size_t wider = 0;
  for (JudgedExcursion& one : std::views::reverse(judged)) {
    if (one.look == Look::kOdd) ++wider;
    const bool ends = one.reversals == 1 && is_brief(one) && one.look == Look::kDrive;
    if (ends && wider >= kMany) one.look = Look::kUnclear;
  }
  return judged;
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

/// Returns the widest plateau below the drive's strokes that is nearly as good as the best.
Plateau WidestPlateau(std::span<const JudgedExcursion> excursions) {
  const auto noise = static_cast<std::size_t>(
      std::ranges::count(excursions, Look::kNoise, &JudgedExcursion::look));
  if (noise == 0) return {};
  std::vector<Plateau> plateaus;
  std::size_t exceptions = noise;  // under no gate
  std::size_t fewest = noise;
  for (std::size_t i = 0; i + 1 < excursions.size() && excursions[i].look != Look::kDrive; ++i) {
    if (excursions[i].look == Look::kNoise) --exceptions;
    if (excursions[i].look == Look::kOdd) ++exceptions;
    if (!(excursions[i + 1].range > excursions[i].range)) continue;
    plateaus.push_back({excursions[i].range, excursions[i + 1].range, i + 1, exceptions});
    fewest = std::min(fewest, exceptions);
  }
  const double allowed = static_cast<double>(fewest) + kExceptions * static_cast<double>(noise);
  Plateau widest;
  for (const Plateau& plateau : plateaus) {
    const bool is_good = static_cast<double>(plateau.exceptions) <= allowed;
    if (is_good && plateau.width() > widest.width()) widest = plateau;
  }
  return widest;
}

}  // namespace

ReversalGate ChooseReversalGate(std::span<const double> displacement) {
  const std::vector<Excursion> excursions = FindExcursions(displacement);
  if (excursions.size() < 2) return {};
  const Plateau chosen = WidestPlateau(Judge(displacement, excursions));
  if (chosen.below == 0) return {};
  const bool certain = chosen.upper >= kClear * chosen.lower;
  const auto below = static_cast<double>(chosen.below);
  const auto kept = static_cast<double>(excursions.size() - chosen.below);
  const bool is_noise = certain || below >= kOutnumber * kept;
  return {.gate = is_noise ? chosen.gate() : 0.0, .certain = certain};
}

}  // namespace mindahl::loop
