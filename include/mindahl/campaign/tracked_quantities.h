#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/campaign/changes.h"
#include "mindahl/campaign/cycle_fit.h"

namespace mindahl::campaign {

/// Describes a quantity whose time history is reported.
struct TrackedQuantity {
  std::string_view name;       ///< column of the table of cycles
  std::string_view unit;       ///< in a record of forces; "-" for a pure number
  std::string_view open_flag;  ///< flag of cycles that do not determine it; "" if none
  std::optional<double> (*of)(const CycleFit&) = nullptr;
  std::optional<double> (*error)(const CycleFit&) = nullptr;  ///< in proportion to its standard one
  bool is_drawn = false;
  /// Whether that is the standard error of the value, without a factor.
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

/// The statement where ChangeStatements() has none of any quantity.
inline constexpr std::string_view kNothingChanged = "nothing changed beyond chance by 1 % or more";

}  // namespace mindahl::campaign
