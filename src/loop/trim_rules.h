#pragma once

#include <cstddef>

namespace mindahl::loop {

/// What makes the ends of a record no part of its test.
struct TrimRules {
  /// [of half the range] A displacement rests within so much: the elastic creep of a rig at rest.
  double rest = 0.01;
  /// [usual strokes] It rests for longer: a dwell at a turning point is a part of the motion, and a
  /// sine is within `rest` of its extreme for 0.05 of a stroke to either side.
  double longest_dwell = 0.5;
  /// [of the widest amplitude] A ramp steps back by less: amplitudes in turn are no ramp.
  double step_back = 0.05;
  /// [of the cycles] So many are of the test's amplitude, or there is no test but the ramp.
  double share = 0.6;
  /// [of the level] A fact has settled within it: less is not worth cycles, as identification says
  /// no trend in words that is smaller.
  double settled = 0.01;
  /// [-] Or within what the scatter of the cycles makes: beyond it one is by this chance, of two
  /// facts one record in five hundred.
  double chance = 0.001;
  /// [-] A slope of the last half of the cycles is none where chance makes it more often: as
  /// identification's trend.
  double trend_chance = 0.01;
  /// [cycles] Fewer have no last half of which to tell level, slope and scatter: four are the least
  /// about whose line there is a scatter that two do not make zero.
  std::size_t fewest = 8;
};

}  // namespace mindahl::loop
