#include "mindahl/models/excitation.h"

#include <boost/math/special_functions/sin_pi.hpp>
#include <cmath>

#include "mindahl/core/error.h"

namespace mindahl::models {
namespace {

/// Returns the wave in units of the amplitude, at `phase` in [0, 1).
double UnitWave(Waveform waveform, double phase) {
  if (waveform != Waveform::kTriangle) return boost::math::sin_pi(2 * phase);
  if (phase <= 0.25) return 4 * phase;
  if (phase <= 0.75) return 2 - 4 * phase;
  return 4 * phase - 4;
}

}  // namespace

Excitation MakeExcitation(const ExcitationOptions& options) {
  RequirePositive("amplitude [m]", options.amplitude);
  RequirePositive("cycles [-]", options.cycles);
  RequirePositive("frequency [Hz]", options.frequency);
  RequireFinite("growth [-]", options.growth);
  if (options.growth < 1) ThrowInvalid("growth [-]", options.growth, "must be >= 1");
  const auto per_cycle = static_cast<double>(options.samples_per_cycle);
  if (per_cycle < 4) ThrowInvalid("samples per cycle [-]", per_cycle, "must be >= 4");
  constexpr double kMostSamples = 1e9;
  const double samples = options.cycles * per_cycle;
  if (samples < 0.5 || samples > kMostSamples) {
    ThrowInvalid("cycles times samples per cycle [-]", samples, "must be >= 1/2 and <= 1e9");
  }
  const auto steps = static_cast<std::size_t>(std::llround(samples));
  Excitation excitation;
  for (std::size_t i = 0; i <= steps; ++i) {
    excitation.time.push_back(static_cast<double>(i) / per_cycle / options.frequency);
    const double phase = static_cast<double>(i % options.samples_per_cycle) / per_cycle;
    const double progress = static_cast<double>(i) / static_cast<double>(steps);
    const double envelope = options.waveform == Waveform::kGrowingSine
                                ? options.amplitude * std::pow(options.growth, progress - 1)
                                : options.amplitude;
    excitation.displacement.push_back(envelope * UnitWave(options.waveform, phase));
    excitation.envelope.push_back(envelope);
  }
  return excitation;
}

}  // namespace mindahl::models
