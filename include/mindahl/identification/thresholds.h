#pragma once

#include <span>
#include <string_view>

namespace mindahl::identification {

/// Holds every number on which a verdict, a finding or the choice of a method depends.
/// ThresholdTable() has the unit and the reason of each, and a test that notices when one is
/// changed by a factor of two. Limits on the work of a solver are not here.
struct Thresholds {
  double shape_effect = 0.05;
  double indistinguishable = 4.0;
  double rigid_beside_rig = 30.0;
  double poor_misfit = 0.02;
  double quantitative_misfit = 0.05;
  double failing_misfit = 0.15;
  double repeat_chance = 1e-3;
  double noise_differs = 0.01;
  double main_stroke = 0.75;
  double path_excess = 0.25;
  double widest_ratio = 9.0;
  double widest_shape = 1.0;
  double open_slip_force = 25.0;
  double far_slip_force = 20.0;
  double parabola_error = 0.1;
  double parabola_departure = 0.15;
  double parabola_mobilised = 0.9;
  double turning_point_shift = 0.2;
  double most_absorbed = 0.5;
  double jenkins_shape = 0.01;
  double doubt = 0.005;
  double above_noise = 1.5;
  double samples_a_column = 8.0;
  double cause = 1e-3;
  double rival_cause = 0.5;
  double noise_memory = 0.5;
  double undecided = 10.0;
  double fewest_places = 16.0;
  double same_place = 0.01;
  double one_cycle = 0.02;
  double starts_inside = 0.1;
  double starts_unloaded = 0.02;
  double starts_without_force = 0.1;
  double hopeless_past = 4.0;
  double similar_misfit = 1.5;
  double mobilised_by_asymptote = 0.9;
  double one_amplitude = 0.01;
  double seen_loop = 0.1;
  double load_difference = 0.01;
  double load_variation = 0.01;
  double never_slips = 0.01;
  double prior_distance = 3.0;
};

struct ThresholdRow {
  std::string_view name;
  double Thresholds::*value;
  std::string_view unit;
  std::string_view meaning;
  std::string_view reason;
};

/// Returns one row a member of Thresholds, in their order.
std::span<const ThresholdRow> ThresholdTable();

}  // namespace mindahl::identification
