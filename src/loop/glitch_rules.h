#pragma once

#include <cstddef>

namespace mindahl::loop {

/// Sets the limits beyond which a sample is a glitch.
struct GlitchRules {
  /// [steps about it and of the record] Least height of a spike over both neighbours. Noise of
  /// standard deviation s has steps of 2.2 s at the third of 24 and would have to stand out by 6.6.
  double spike = 3.0;
  /// [samples] Longer ones are as well a pulse of the drive or an inner loop.
  std::size_t longest_spike = 3;
  /// [samples] So many to either side of a spike are looked at: the edges of a square wave of six
  /// samples a cycle come often enough within them to be distinguished from spikes.
  std::size_t about = 12;
  /// [usual steps] Least distance of 0 from the range of a dropout's neighbours.
  double dropout = 2.0;
  /// [usual steps of the displacement] The same at an end: a record may begin at 0 and 0.
  double end_dropout = 4.0;
  /// [samples] Fewer equal readings are common where a file has few digits.
  std::size_t shortest_held = 5;
  /// [steps about it and of the record] Least jump from a held value to the next, and there and
  /// back of a dropout of one channel.
  double held_jump = 3.0;
  /// [of the samples] Largest fraction that may be glitches; more of them are the record.
  double most = 0.25;
};

}  // namespace mindahl::loop
