#pragma once

#include <span>
#include <string>
#include <vector>

#include "mindahl/campaign/changes.h"
#include "mindahl/io/plot.h"

namespace mindahl::campaign {

/// Holds the time history of a quantity over a test.
struct Evolution {
  std::string name;  ///< column of the table of cycles
  std::string unit;  ///< "-" for a pure number
  /// Weights of the time history are 1/error², so that a bin has the standard error of a cycle.
  bool has_errors = false;
  Course course = {};
  CourseDescription description = {};
};

/// Returns a panel for each quantity that has two bins or more, over the number of the cycle: a
/// line, around it what a single cycle leaves open (95 % by its standard error; of what has none
/// the least and the greatest of the cycles that a point stands for), the straight segments, and
/// the changes as marks. Unknown values of a cycle are in no time history, and so in no panel.
std::vector<io::PlotPanel> EvolutionPanels(std::span<const Evolution> evolutions);

/// Returns the panels, one below the other.
/// @throws InvalidArgument where there is no panel: of a test of one cycle
io::Plot EvolutionPlot(std::span<const Evolution> evolutions, const std::string& title,
                       const std::string& subtitle);

}  // namespace mindahl::campaign
