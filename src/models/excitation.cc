#include "mindahl/models/excitation.h"

#include <algorithm>
#include <array>
#include <boost/math/special_functions/cos_pi.hpp>
#include <boost/math/special_functions/sin_pi.hpp>
#include <cmath>
#include <random>

#include "mindahl/core/error.h"

namespace mindahl::models {
namespace {

// In the order of Waveform.
constexpr std::array<std::string_view, 5> kNames = {"sine", "triangle", "growing-sine", "random",
                                                    "nested"};

/// Returns the wave in units of the amplitude, at `phase` in [0, 1).
double UnitWave(Waveform waveform, double phase) {
  if (waveform != Waveform::kTriangle) return boost::math::sin_pi(2 * phase);
  if (phase <= 0.25) return 4 * phase;
  if (phase <= 0.75) return 2 - 4 * phase;
  return 4 * phase - 4;
}

/// Draws uniformly in (0, 1): an odd multiple of 2⁻⁵³. The generator is the same everywhere, the
/// standard distributions are not.
double UniformDraw(std::mt19937_64& engine) {
  return std::ldexp(static_cast<double>((engine() >> 11) | 1), -53);
}

/// Returns, in units of the amplitude, `count` extremes that are reached, and the one after.
std::vector<double> RandomExtremes(std::size_t count, std::uint64_t seed) {
  // Complemented, so that noise drawn with the same seed does not repeat these numbers.
  std::mt19937_64 engine(~seed);
  std::vector<double> extremes = {2 * UniformDraw(engine) - 1};
  double bound = extremes.front() > 0 ? -1.0 : 1.0;
  while (extremes.size() <= count) {
    extremes.push_back(extremes.back() + (bound - extremes.back()) * UniformDraw(engine));
    bound = -bound;
  }
  double largest = 0.0;
  for (std::size_t k = 0; k < count; ++k) largest = std::max(largest, std::abs(extremes[k]));
  for (double& extreme : extremes) extreme = std::clamp(extreme / largest, -1.0, 1.0);
  return extremes;
}

/// Returns nested extremes, in the form of RandomExtremes.
std::vector<double> NestedExtremes(std::size_t count) {
  const auto innermost = std::floor(static_cast<double>(count) / 2);
  const auto size = [&](std::size_t k) {
    return std::abs(4 * (static_cast<double>(k) - innermost) + 1);
  };
  const double largest = std::max(size(0), size(count - 1));
  std::vector<double> extremes;
  for (std::size_t k = 0; k <= count; ++k) {
    const double extreme = std::min(size(k) / largest, 1.0);
    extremes.push_back(k % 2 == 0 ? extreme : -extreme);
  }
  return extremes;
}

/// Returns the number of extremes up to a sample.
std::size_t ExtremesReached(std::size_t sample, std::size_t per_cycle) {
  return (4 * sample + per_cycle) / (2 * per_cycle);
}

/// Returns a sample on the half-cosines that join `extremes`.
double JoinExtremes(const std::vector<double>& extremes, std::size_t sample,
                    std::size_t per_cycle) {
  const std::size_t next = ExtremesReached(sample, per_cycle);
  const std::size_t past = (4 * sample + per_cycle) % (2 * per_cycle);
  const double to = extremes[next];
  // Half way from the first extreme's mirror image to itself is 0, at time 0.
  const double from = next == 0 ? -to : extremes[next - 1];
  const double half_periods = static_cast<double>(past) / static_cast<double>(2 * per_cycle);
  const double weight = (1 - boost::math::cos_pi(half_periods)) / 2;
  // std::lerp is monotone: rounding neither passes an extreme nor adds one.
  return std::lerp(from, to, weight);
}

void RequireExcitation(const ExcitationOptions& options) {
  RequirePositive("amplitude [m]", options.amplitude);
  RequirePositive("cycles [-]", options.cycles);
  RequirePositive("frequency [Hz]", options.frequency);
  RequireFinite("growth [-]", options.growth);
  if (options.growth < 1) ThrowInvalid("growth [-]", options.growth, "must be >= 1");
  if (options.samples_per_cycle < 4 || options.samples_per_cycle > 1'000'000'000) {
    ThrowInvalid("samples per cycle [-]", static_cast<double>(options.samples_per_cycle),
                 "must be >= 4 and <= 1e9");
  }
  constexpr double kLargestAmplitude = 1e307;  // [m], as of a loading path
  if (options.amplitude > kLargestAmplitude) {
    ThrowInvalid("amplitude [m]", options.amplitude, "must be <= 1e307");
  }
  constexpr double kMostSamples = 1e9;
  if (options.cycles > kMostSamples) {
    ThrowInvalid("cycles [-]", options.cycles, "must be <= 1e9");
  }
  const double samples = options.cycles * static_cast<double>(options.samples_per_cycle);
  if (samples < 0.5 || samples > kMostSamples) {
    ThrowInvalid("cycles times samples per cycle [-]", samples, "must be >= 1/2 and <= 1e9");
  }
  constexpr double kLongest = 1e300;  // [s]
  if (options.frequency < options.cycles / kLongest) {
    ThrowInvalid("frequency [Hz]", options.frequency,
                 "is too low: cycles over frequency must be <= 1e300 s");
  }
}

}  // namespace

std::span<const std::string_view> WaveformNames() { return kNames; }

std::optional<Waveform> FindWaveform(std::string_view name) {
  const auto found = std::ranges::find(kNames, name);
  if (found == kNames.end()) return std::nullopt;
  return static_cast<Waveform>(found - kNames.begin());
}

Excitation MakeExcitation(const ExcitationOptions& options) {
  RequireExcitation(options);
  const auto per_cycle = static_cast<double>(options.samples_per_cycle);
  const auto steps = static_cast<std::size_t>(std::llround(options.cycles * per_cycle));
  const std::size_t reached =
      std::max<std::size_t>(ExtremesReached(steps, options.samples_per_cycle), 1);
  std::vector<double> extremes;
  if (options.waveform == Waveform::kRandom) extremes = RandomExtremes(reached, options.seed);
  if (options.waveform == Waveform::kNested) extremes = NestedExtremes(reached);
  Excitation excitation;
  excitation.time.reserve(steps + 1);
  excitation.displacement.reserve(steps + 1);
  excitation.envelope.reserve(steps + 1);
  for (std::size_t i = 0; i <= steps; ++i) {
    excitation.time.push_back(static_cast<double>(i) / per_cycle / options.frequency);
    const double phase = static_cast<double>(i % options.samples_per_cycle) / per_cycle;
    const double progress =
        static_cast<double>(i) / static_cast<double>(std::max<std::size_t>(steps, 1));
    const double envelope = options.waveform == Waveform::kGrowingSine
                                ? options.amplitude * std::pow(options.growth, progress - 1)
                                : options.amplitude;
    excitation.displacement.push_back(
        envelope * (extremes.empty() ? UnitWave(options.waveform, phase)
                                     : JoinExtremes(extremes, i, options.samples_per_cycle)));
    excitation.envelope.push_back(envelope);
  }
  return excitation;
}

}  // namespace mindahl::models
