#pragma once

#include <cstddef>
#include <vector>

namespace mindahl::models {

enum class Waveform { kSine, kTriangle, kGrowingSine };

struct ExcitationOptions {
  Waveform waveform = Waveform::kSine;
  double amplitude = 0.0;               ///< [m], > 0; the largest, of a growing sine at its end
  double cycles = 1.0;                  ///< finite, > 0, multiples of 1/samples_per_cycle
  std::size_t samples_per_cycle = 200;  ///< >= 4; a multiple of 4 puts samples on the extremes
  double frequency = 1.0;               ///< [Hz], finite, > 0
  double growth = 10.0;  ///< last over first envelope of a growing sine, finite, >= 1
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
/// The envelope is A·g^{t/t_end − 1} of the growing sine, and A of the others.
///
/// The sine is exact at its zeros and extremes and repeats bit for bit.
/// @throws InvalidArgument for values out of range or more than 1e9 samples
/// Error below 4 ε = 9e-16 of the amplitude; of a growing sine 4 ε·(1 + ln g).
Excitation MakeExcitation(const ExcitationOptions& options);

}  // namespace mindahl::models
