#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace mindahl::models {

enum class Waveform { kSine, kTriangle, kGrowingSine, kRandom, kNested };

/// Returns "sine", "triangle", "growing-sine", "random", "nested": in the order of Waveform.
std::span<const std::string_view> WaveformNames();

/// Returns the waveform of one of these names; empty for any other.
std::optional<Waveform> FindWaveform(std::string_view name);

struct ExcitationOptions {
  Waveform waveform = Waveform::kSine;
  double amplitude = 0.0;  ///< [m], > 0, <= 1e307; the largest, of a growing sine at its end
  double cycles = 1.0;     ///< finite, > 0, multiples of 1/samples_per_cycle
  std::size_t samples_per_cycle = 200;  ///< 4 to 1e9; a multiple of 4 puts samples on the extremes
  double frequency = 1.0;               ///< [Hz], finite, > 0
  double growth = 10.0;    ///< last over first envelope of a growing sine, finite, >= 1
  std::uint64_t seed = 1;  ///< seed of a random waveform
};

/// Imposed displacement, from 0 at time 0; Peyret et al. (2017) eq. 22 and fig. 7.
struct Excitation {
  std::vector<double> time;          ///< [s]
  std::vector<double> displacement;  ///< [m]
  std::vector<double> envelope;      ///< amplitude [m] at each sample
};

/// Makes the displacement imposed on a contact.
///   sine          A·sin(2πft)
///   triangle      the same extremes and zeros joined by straight lines
///   growing sine  A·g^{t/t_end − 1}·sin(2πft)
///   random, nested: extremes x_k at the times (2k + 1)/4f of the sine's, joined by half-cosines
///   random        each x_k uniform between ±A, drawn again until it turns back from the last one;
///                 all scaled so that the largest that is reached is ±A
///   nested        x_k = (−1)^k·A·|4(k − c) + 1| over the largest of these numbers, with c = n/2
///                 rounded down of the n extremes reached
/// The extremes of `nested` fall and grow by equal steps, 7 3 1 5 9 about the innermost: each loop
/// lies inside the one before, and x_{c+j} on the way back passes x_{c−j} and so closes its loop.
///
/// The envelope is A·g^{t/t_end − 1} of the growing sine, and A of the others.
///
/// The sine is exact at its zeros and extremes and repeats bit for bit. Random and nested waveforms
/// are exact at time 0 and reach A to the last digit where samples fall on the extremes. A seed
/// gives the same waveform everywhere, to rounding.
/// @throws InvalidArgument for values out of range, more than 1e9 samples or longer than 1e300 s
/// Error below 4 ε = 9e-16 of the amplitude; of a growing sine 4 ε·(1 + ln g), and of random and
/// nested ones 6 ε for given extremes.
Excitation MakeExcitation(const ExcitationOptions& options);

}  // namespace mindahl::models
