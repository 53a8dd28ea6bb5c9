#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "kind.h"
#include "mindahl/loop/record.h"

/// Loops of contacts that follow other laws than the fitted one, with what is true of them whatever
/// the law: for the intervals of parameters that are effective.
namespace mindahl::reliability {

/// A loop that slides over most of its stroke.
struct OtherLoop {
  loop::Record record;
  double plateau = 0.0;  ///< [N]: force at which the contact slides in the middle of its stroke
  /// [N/m]: from the stiffness at a reversal to that of the chord to where the force has changed by
  /// a tenth of the gap. Empty where the contact stands still there.
  std::optional<Range> stiffness;
};

/// One law that is not Masing's with one exponent.
struct OtherLaw {
  std::string_view name;
  Half half = Half::kDevelopment;
  OtherLoop (*make)(Draws& draws) = nullptr;
  std::string_view sentence;  ///< what is drawn
};

/// LuGre, Bouc–Wen, Stribeck, sixty asperities, friction of the position and backlash, on which the
/// intervals were developed; a power-law spectrum, a spring and a dashpot, which were held out.
std::span<const OtherLaw> OtherLaws();

/// How intervals of one parameter hold what is true.
struct Effective {
  std::size_t loops = 0;   ///< whose model is not adequate and of which the truth is known
  std::size_t given = 0;   ///< fits in which the parameter is effective
  std::size_t held = 0;    ///< of these, intervals that contain the truth
  std::size_t narrow = 0;  ///< of those that do not, intervals within a quarter of the value
  /// Median half width of the intervals over the 95 % quantile of the estimates' errors, both over
  /// the truth: 1 of intervals that are as wide as they need be.
  double inflation = 0.0;
};

struct EffectiveTally {
  Effective slip_force;
  Effective stiffness;
  std::size_t adequate = 0;  ///< fits whose model is adequate
};

/// Fits so many loops of a law, the first with this seed.
EffectiveTally Measure(const OtherLaw& law, std::size_t loops, std::uint64_t seed);

}  // namespace mindahl::reliability
