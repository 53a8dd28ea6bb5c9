#pragma once

#include <cstddef>

namespace mindahl::loop {

/// Sets when an excursion of the displacement looks like noise, and when a gate is certain.
struct ReversalRules {
  /// [of the main strokes' duration] Longest noise; a nested loop of few samples is not shorter.
  static constexpr double kBrief = 1.0 / 3;
  /// [of the main strokes' duration] Longest jump of the gauge beyond the white noise: an inner
  /// loop that the drive makes on its way may last longer.
  static constexpr double kSudden = 1.0 / 8;
  /// [of the excursion's range] Least fraction in one step between samples of a jump: a drive that
  /// turns twice takes more samples to do so, while noise and an encoder's last digit take one.
  static constexpr double kJump = 0.4;
  /// [-] Over the likely reach of n samples' normal noise, 2√(2 ln n) standard deviations, which a
  /// twentieth of records exceed, and whose deviation is an estimate.
  static constexpr double kBeyond = 1.25;
  /// [of the full range] Largest noise; more is a rough drive, a sequence of unrelated places.
  static constexpr double kRough = 0.05;
  /// [of the excursions that look like noise] Largest fraction classified otherwise.
  static constexpr double kExceptions = 0.05;
  /// [-] Ratio of a plateau's ends below which it is narrow.
  static constexpr double kClear = 2.5;
  /// [-] Under a narrow plateau the noise is believed where there is so much more of it than of the
  /// drive: of random walks, whose excursions are of all ranges, it is not.
  static constexpr double kOutnumber = 20.0;
  /// So many wider ones that are as brief make a turn just before an end of the record unclear.
  static constexpr std::size_t kMany = 8;
};

/// Sets the limits beyond which a sample is a glitch.
struct GlitchRules {
  /// [steps about it and of the record] Least height of a spike over both neighbours. Noise of
  /// standard deviation s has steps of 2.2 s at the third of 24 and would have to stand out by 6.6.
  static constexpr double kSpike = 3.0;
  /// [samples] Longer ones are as well a pulse of the drive or an inner loop.
  static constexpr std::size_t kLongestSpike = 3;
  /// [samples] So many to either side of a spike are looked at: the edges of a square wave of six
  /// samples a cycle come often enough within them to be distinguished from spikes.
  static constexpr std::size_t kAbout = 12;
  /// [usual steps] Least distance of 0 from the range of a dropout's neighbours.
  static constexpr double kDropout = 2.0;
  /// [of the samples] Largest fraction that may be glitches; more of them are the record.
  static constexpr double kMost = 0.25;
};

/// Sets the limits by which cycles are counted and compared.
struct CycleRules {
  /// [of the range] Farthest from an extreme that an end of a record is a turning point; [cycles]
  /// the most that one which counts is short of a whole one.
  static constexpr double kAtExtreme = 0.02;
  /// [of the widest cycle's amplitude] Least amplitude of a cycle that is one of the widest.
  static constexpr double kSteady = 0.95;
  /// [of its width] Farthest that a cycle ends from where it began: then it loses what a closed one
  /// does, but for twice that fraction.
  static constexpr double kReturns = 0.05;
  /// [energy of the rectangle round the loop, 4XT*] Least energy that decides the force's sign.
  static constexpr double kThin = 0.01;
  /// [standard deviations of what noise makes of it] The same: one record in 3.5 million.
  static constexpr double kDeviations = 5.0;
  /// [of half the range] Least step of an encoder that is a noise: the rounding of a file, or of a
  /// fine encoder, is not worth it.
  static constexpr double kCoarse = 1e-3;
};

/// Sets the limits beyond which a measured loop slides over most of its stroke.
struct SlidingRules {
  /// [W/(4XT*)] Least energy ratio: Mindlin's contact has it at twice its gross-slip displacement,
  /// beyond which the gap at mid-stroke is that of the slip force.
  static constexpr double kEnergyRatio = 0.6;
  /// [T*] Least half gap; less is no plateau: the strokes were not separated.
  static constexpr double kGap = 0.5;
  /// [-] Largest distance of the energy from that of a gap that is the same over the stroke.
  static constexpr double kUneven = 0.1;
  /// [4·T*·sliding amplitude] Least energy of a loop that reaches its slip force.
  static constexpr double kFull = 0.85;
};

}  // namespace mindahl::loop
