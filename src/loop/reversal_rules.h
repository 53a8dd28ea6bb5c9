#pragma once

#include <cstddef>

namespace mindahl::loop {

/// What makes an excursion of the displacement look like noise, and a gate certain.
struct ReversalRules {
  /// [of the main strokes' duration] Noise is over sooner; a nested loop of few samples is not.
  double brief = 1.0 / 3;
  /// [of the main strokes' duration] A jump of the gauge beyond the white noise is over sooner
  /// still: an inner loop that the drive makes on its way may last longer.
  double sudden = 1.0 / 8;
  /// [of the excursion's range] Least share in one step between samples of what is a jump: a drive
  /// that turns twice takes more samples to do so.
  double jump = 0.4;
  /// [-] Over the likely reach of n samples' normal noise, 2√(2 ln n) standard deviations, which a
  /// twentieth of records exceed, and whose deviation is an estimate.
  double beyond = 1.25;
  /// [of the full range] More noise than this is a rough drive: a sequence of unrelated places.
  double rough = 0.05;
  /// [of the excursions that look like noise] So many may look otherwise than they are taken.
  double exceptions = 0.05;
  /// [-] Ratio of a plateau's ends below which it is narrow.
  double clear = 2.5;
  /// [-] Under a narrow plateau the noise is believed where there is so much more of it than of the
  /// drive: of random walks, whose excursions are of all ranges, it is not.
  double outnumber = 20.0;
  /// [of the plateau's width in log(gate)] So wide a second one competes.
  double rival = 0.5;
  /// Smooth disturbances are told from nested loops by their number,
  std::size_t many = 8;
  /// [-] the ratio of their ranges, which lie as densely as those of noise,
  double spread = 10.0;
  /// [-] and the ratio of the plateau's ends above them.
  double far = 10.0;
};

}  // namespace mindahl::loop
