#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/draws.h"
#include "mindahl/loop/record.h"
#include "truth.h"

/// Loops with something wrong with them, and what a fit of one may still say.
namespace mindahl::reliability {

/// Thresholds are developed on one half of the corruptions and tried on the other.
enum class Half { kDevelopment, kHeldOut, kClean };

/// "development", "held-out", "clean"
std::string_view Name(Half half);

/// What is true of a parameter: one value, or all between two where it changes within the record.
struct Range {
  double lowest = 0.0;
  double highest = 0.0;
};

/// Of a parameter that is empty nothing is asked: under this corruption it has no true value.
struct Expected {
  std::optional<Range> sigma = {};
  std::optional<Range> alpha = {};
  std::optional<Range> slip_force = {};
};

/// σ, α and Tc of the law.
Expected AllOf(const models::BranchLaw& law);

/// σ and Tc, where the contact follows another law than the fitted one.
Expected StiffnessAndSlipForce(double sigma, double slip_force);

struct Loop {
  loop::Record record;
  Expected expected;
};

/// Small, middling and large.
inline constexpr std::size_t kLevels = 3;

/// A strength by level.
inline double At(std::size_t level, const std::array<double, kLevels>& strengths) {
  return strengths[level];
}

/// One way in which a record can go wrong: a row of a family's table. A new one is a function and
/// its row.
struct Kind {
  std::string_view name;
  Half half = Half::kDevelopment;
  /// With the contact's origin and force sense; offsets and the sense of the load cell come after.
  Loop (*make)(const Truth& truth, std::size_t level, Draws& draws) = nullptr;
  std::string_view sentence;  ///< the three strengths, and what is asked where that is not all
  bool quick = true;          ///< belongs to the small run
};

/// All, family after family.
std::vector<Kind> Kinds();

/// A loop of a kind as it would be read from a file. The same everywhere for the same seed,
/// whatever other kinds there are.
/// @param level  0 to kLevels − 1
Loop MakeLoop(const Kind& kind, std::size_t level, std::uint64_t seed);

// The families, each in its file. Halves were dealt by turns down the lists, before any was fitted.
std::vector<Kind> NoiseKinds();
std::vector<Kind> ChannelKinds();
std::vector<Kind> LoggerKinds();
std::vector<Kind> RigKinds();
std::vector<Kind> ContactKinds();
std::vector<Kind> LoadKinds();
std::vector<Kind> SamplingKinds();
std::vector<Kind> ExcitationKinds();
std::vector<Kind> CleanKinds();

}  // namespace mindahl::reliability
