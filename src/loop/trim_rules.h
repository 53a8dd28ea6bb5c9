#pragma once

#include <cstddef>

namespace mindahl::loop {

/// Sets the limits by which the ends of a record are not part of its test.
struct TrimRules {
  /// [of half the range] Largest change of a resting displacement: elastic creep of a rig at rest.
  double rest = 0.01;
  /// [usual strokes] It rests for longer: a dwell at a turning point is a part of the motion, and a
  /// sine is within `rest` of its extreme for 0.05 of a stroke to either side.
  double longest_dwell = 0.5;
  /// [of the widest amplitude] Largest step back of a ramp: alternating amplitudes are no ramp.
  double step_back = 0.05;
  /// [of the cycles] Least fraction of the test's amplitude, or there is no test but the ramp.
  double share = 0.6;
  /// [of the level] Largest distance of a settled fact: less is not worth cycles, as identification
  /// reports no smaller trend.
  double settled = 0.01;
  /// [-] Chance at which the scatter of the cycles makes a fact seem unsettled: of two
  /// facts one record in five hundred.
  double chance = 0.001;
  /// [-] A slope of the last half of the cycles is none where chance makes it more often: as
  /// identification's trend.
  double trend_chance = 0.01;
  /// [cycles] Fewer have no last half to determine level, slope and scatter: four are the least
  /// about whose line there is a scatter that two do not make zero.
  std::size_t fewest = 8;
};

}  // namespace mindahl::loop
