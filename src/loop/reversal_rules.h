#pragma once

#include <cstddef>

namespace mindahl::loop {

/// Sets when an excursion of the displacement looks like noise, and when a gate is certain.
struct ReversalRules {
  /// [of the main strokes' duration] Longest noise; a nested loop of few samples is not shorter.
  double brief = 1.0 / 3;
  /// [of the main strokes' duration] Longest jump of the gauge beyond the white noise: an inner
  /// loop that the drive makes on its way may last longer.
  double sudden = 1.0 / 8;
  /// [of the excursion's range] Least fraction in one step between samples of a jump: a drive that
  /// turns twice takes more samples to do so.
  double jump = 0.4;
  /// [-] Over the likely reach of n samples' normal noise, 2√(2 ln n) standard deviations, which a
  /// twentieth of records exceed, and whose deviation is an estimate.
  double beyond = 1.25;
  /// [of the full range] Largest noise; more is a rough drive, a sequence of unrelated places.
  double rough = 0.05;
  /// [of the excursions that look like noise] Largest fraction classified otherwise.
  double exceptions = 0.05;
  /// [-] Ratio of a plateau's ends below which it is narrow.
  double clear = 2.5;
  /// [-] Under a narrow plateau the noise is believed where there is so much more of it than of the
  /// drive: of random walks, whose excursions are of all ranges, it is not.
  double outnumber = 20.0;
  /// [of the plateau's width in log(gate)] Least width of a second plateau that competes.
  double rival = 0.5;
  /// Smooth disturbances are distinguished from nested loops by their number,
  std::size_t many = 8;
  /// [-] the ratio of their ranges, which lie as densely as those of noise,
  double spread = 10.0;
  /// [-] and the ratio of the plateau's ends above them.
  double far = 10.0;
};

}  // namespace mindahl::loop
