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
/// means over bins of equally many values, at most kMostBins of them.
class Course {
 public:
  struct Bin {
    std::size_t first_cycle = 0;
    std::size_t last_cycle = 0;
    double cycle = 0.0;     ///< mean number
    double value = 0.0;     ///< mean
    double least = 0.0;     ///< smallest of its values
    double greatest = 0.0;  ///< likewise
    double count = 0.0;
    double squared_error = 0.0;  ///< mean square of their standard errors

    /// Takes in the bin that comes after it.
    void Merge(const Bin& next);
  };

  static constexpr std::size_t kMostBins = 512;

  /// @param cycle   its number, larger than the last
  /// @param value   finite
  /// @param cycles  that the value is of, from that one on
  /// @param error   standard error of the value, >= 0; 0 where it has none
  void Add(std::size_t cycle, double value, std::size_t cycles = 1, double error = 0.0);

  [[nodiscard]] std::span<const Bin> bins() const { return bins_; }
  // The first and the last value that was added; of at least one.
  [[nodiscard]] double first() const { return first_; }
  [[nodiscard]] double last() const { return last_; }

 private:
  std::vector<Bin> bins_;
  double width_ = 1;  // values to a bin
  double first_ = 0.0;
  double last_ = 0.0;
};

/// A change of a quantity: a trend along straight segments in a row that go the same way, of 1 % or
/// more each, or a step between two, of 2 % or more; or of four times the scatter.
struct Change {
  std::size_t first_cycle = 0;  ///< a step has the first cycle after it in both
  std::size_t last_cycle = 0;
  double from = 0.0;
  double to = 0.0;
  /// Probability of such a slope or step without a change; a step's is corrected for its place.
  double p_value = 1.0;

  [[nodiscard]] bool is_step() const { return first_cycle == last_cycle; }
};

struct CourseDescription {
  /// The first and the last value, on the segment's line if it lies within the scatter. Without a
  /// change both are the weighted mean, if it varies the least and the greatest value.
  double from = 0.0;
  double to = 0.0;
  /// First cycle from which on the quantity stays within 5 % of its whole change around where it
  /// ends; empty where it has no step and no trend, or until the last tenth of the test.
  std::optional<std::size_t> settled_at = std::nullopt;
  std::vector<Change> changes = {};  ///< in their order
  /// True if residuals about the segments are large and alike in neighbouring bins: periodic.
  bool varies = false;

  [[nodiscard]] bool changed() const { return !changes.empty(); }
};

/// Divides a time history into at most eight straight segments with the least sum of squares; F
/// tests, with a chance below 1 %, corrected for the number of places, choose how many. The bin
/// between two may hold the values of both, and is in neither line. Bins weigh by their standard
/// errors, the scatter beyond these, and that of their neighbours. The noise is that of neighbours,
/// whatever the lines miss, but no less than 0.1 % of the values. Steps are between segments,
/// trends along one by Student's test of its slope; no value is stated that no cycle had. It
/// varies, without changes, where residuals have a quarter of the variance and ten times that of
/// neighbours. Cost: with the square of the number of bins, and with the number of cycles.
CourseDescription Describe(const Course& course);

/// Describes a quantity whose time history is reported.
struct TrackedQuantity {
  std::string_view name;    ///< column of the table of cycles
  std::string_view symbol;  ///< "μ"; "" where the headline does not name it
  /// Column of the fitted parameter that determines it; "" if none.
  std::string_view parameter;
};

/// The time history of a quantity and what is said of it.
struct Evolution {
  const TrackedQuantity* quantity = nullptr;
  std::string unit = {};  ///< in the record
  Course course = {};
  CourseDescription description = {};
  std::size_t known = 0;  ///< number of fits that determine it
  /// True if one of the last three cycles determines the quantity, and at least half as many cycles
  /// as determine the best-determined one. After a specimen broke, no cycle determines Tc.
  bool is_of_whole_test = true;
};

/// Returns the evolutions of all of them before the first cycle.
std::vector<Evolution> BeginEvolutions(bool is_torsional);

/// Adds a cycle to the time histories, if it converged, of quantities that it does not leave open.
void AddTo(std::span<Evolution> evolutions, const CycleFit& fit);

/// Describes those that have a value, those of the whole test first, and removes the others; no
/// changes of one that fewer than half as many cycles determine as the best-determined one.
void Describe(std::vector<Evolution>& evolutions);

/// Returns the whole test in one line: "μ 0.352 → 0.600, settled at cycle 480; σ +60 %; a 250 → 400
/// µm"; of μ, Tc and half gap the first of the whole test, then σ and contact radius.
std::string Headline(std::span<const Evolution> evolutions);

/// Returns a sentence for each step and trend with the quantity's name, the largest first; of more
/// than ten nine, and how many more there are.
std::vector<std::string> ChangeStatements(std::span<const Evolution> evolutions);

/// Returns a panel for each quantity with two bins or more, over the cycle, logarithmic from a
/// hundred on: a line within the range of the cycles that a point stands for, steps as marks.
std::vector<io::PlotPanel> EvolutionPanels(std::span<const Evolution> evolutions);

/// Returns loops over each other, each named by its cycle.
/// @param cycles  records [m], [N]
io::PlotPanel FrettingLog(std::span<const Cycle> cycles, bool is_torsional);

}  // namespace mindahl::campaign
