#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/io/plot.h"

namespace mindahl::campaign {

/// A quantity over the cycles of a test, in memory that the number of cycles does not change:
/// weighted means over bins of equally many values, at most kMostBins of them.
class Course {
 public:
  struct Bin {
    std::size_t first_cycle = 0;
    std::size_t last_cycle = 0;
    double cycle = 0.0;  ///< mean number
    double value = 0.0;  ///< mean, weighted
    double weight = 0.0;
    double least = 0.0;     ///< smallest of its values
    double greatest = 0.0;  ///< likewise
    std::size_t count = 0;
  };

  static constexpr std::size_t kMostBins = 512;

  /// @param cycle  its number, larger than the last
  /// @param value   finite
  /// @param weight  > 0: one over its variance, in any unit
  void Add(std::size_t cycle, double value, double weight = 1.0);

  [[nodiscard]] std::span<const Bin> bins() const { return bins_; }

 private:
  std::vector<Bin> bins_;
  std::size_t width_ = 1;  // values to a bin
};

/// Sets which changes and trends of a time history are reported.
struct ChangeThresholds {
  /// Chance [-] of a change, or of a trend, where there is none: one test in a hundred.
  double chance = 0.01;
  /// Smallest trend that is reported: change over a segment [-] of the segment's mean.
  double trend = 0.01;
  /// Smallest step [-] of the mean before it that is a transition; a smaller one is a bend.
  double step = 0.02;
  /// Fraction [-] of the first segment's initial slope at which the running-in has ended.
  double settled = 0.2;
};

/// Describes a straight segment of a time history; the first may settle exponentially.
struct Stretch {
  std::size_t first_cycle = 0;
  std::size_t last_cycle = 0;
  double at_start = 0.0;  ///< the line there, within what values there were
  double at_end = 0.0;
  double slope = 0.0;          ///< a cycle; of the line through what settles
  double slope_p_value = 1.0;  ///< probability of such a slope under the hypothesis of none
  bool trends = false;         ///< beyond chance and large enough to matter
  /// τ [cycles] of a + b·exp(−n/τ) in place of a line.
  std::optional<double> time_constant = std::nullopt;

  /// Returns its line at a cycle between the first and the last.
  [[nodiscard]] double At(double cycle) const;
};

enum class ChangeKind {
  kEndOfRunningIn,  ///< the initial exponential settling has ended
  kTransition,      ///< a step
  kBend,            ///< the rate changes
};

/// Returns "end_of_running_in", "transition", "bend".
std::string_view NameOf(ChangeKind kind);

struct Change {
  ChangeKind kind = ChangeKind::kBend;
  std::size_t cycle = 0;    ///< the first after it
  std::size_t lower95 = 0;  ///< 95 % interval of `cycle`
  std::size_t upper95 = 0;
  double before = 0.0;   ///< the quantity there, on the line before, within what values there were
  double after = 0.0;    ///< and on the line after
  double p_value = 1.0;  ///< probability under no change, corrected for the choice of the place
};

/// Divides a time history into segments, one more than changes.
struct CourseDescription {
  std::vector<Stretch> stretches;
  std::vector<Change> changes;
};

/// Divides a time history into straight segments. The first may settle instead, a + b·exp(−n/τ),
/// and a bin within which something changes may be left out between two. Of all cuts that are made
/// of k such things (places, bins left out, a curve), eight at the most, that of the least squares
/// S_k (dynamic programming; Bellman & Roth 1969); and as many as are beyond chance,
///   n_eff ln(S_k/S_l) > 2 (l − k) ln(n/chance)
/// for any l > k, n bins, n_eff of them independent by the residuals' lag-one correlation: beyond
/// the likelihood ratio that a level and a slope more reach by chance at any of the n places. What
/// settles has ended its running-in where its rate has fallen to `settled`. Positions have the
/// interval in which n_eff ln(S/S_min) < 3.84, the quantile of χ²₁.
/// @returns nothing for fewer than two bins; one segment for fewer than sixteen
/// Cost: n² a change, 3 ms for 512 bins where there is none, 7 ms where there are some.
CourseDescription FindChanges(const Course& course, const ChangeThresholds& thresholds = {});

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

/// Describes a quantity whose time history is reported.
struct TrackedQuantity {
  std::string_view name;       ///< column of the table of cycles
  std::string_view unit;       ///< in a record of forces; "-" for a pure number
  std::string_view open_flag;  ///< flag of cycles that do not determine it; "" if none
  std::optional<double> (*of)(const CycleFit&) = nullptr;
  std::optional<double> (*error)(const CycleFit&) = nullptr;  ///< in proportion to its standard one
  bool is_drawn = false;
  /// True if that is the standard error of the value itself, without a factor.
  bool has_standard_error = false;
};

/// Returns all of them, in the order of the report.
std::span<const TrackedQuantity> TrackedQuantities();

/// Collects the time histories of all of them, in memory that their number does not change.
class TrackedCourses {
 public:
  TrackedCourses();

  /// A cycle that did not converge, or leaves a quantity open, is not in its time history.
  void Add(const CycleFit& fit);

  /// Returns them in the order of TrackedQuantities().
  [[nodiscard]] std::span<const Course> courses() const { return courses_; }

  /// True, likewise, where any value of one had an error: what is held has none.
  [[nodiscard]] const std::vector<bool>& have_errors() const { return have_errors_; }

  /// Returns FindChanges() of each, likewise.
  [[nodiscard]] std::vector<CourseDescription> Describe() const;

 private:
  std::vector<Course> courses_;
  std::vector<bool> have_errors_;
};

/// Returns a sentence for each change, in order, without the quantity's name; a running-in, which
/// bends gradually, is one change. Numbers in SI.
std::vector<std::string> ChangeStatements(const CourseDescription& course);

/// Returns the trends that are beyond chance but too small to matter, likewise.
std::vector<std::string> SmallTrendStatements(const CourseDescription& course,
                                              const ChangeThresholds& thresholds = {});

/// Statement if ChangeStatements() returns none for any quantity.
inline constexpr std::string_view kNothingChanged = "nothing changed beyond chance by 1 % or more";

}  // namespace mindahl::campaign
