#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/identification/fit.h"

namespace mindahl::campaign {

/// A column of numbers of the table of cycles.
struct CycleNumber {
  std::string_view name;
  std::string_view unit = "-";  ///< in a record of forces
};

/// All of them, in the order of the table.
inline constexpr auto kCycleNumbers = std::to_array<CycleNumber>({
    {"start_time", "s"},
    // Facts, of no model; empty where the record closes no cycle.
    {"amplitude", "m"},
    {"peak_force", "N"},
    {"sliding_amplitude", "m"},
    {"half_gap", "N"},
    {"energy", "J"},  // a cycle
    {"energy_ratio"},
    {"energy_friction_coefficient"},
    {"normal_load", "N"},  // mean, given or of the column
    // The fit, with standard errors; empty where it failed.
    {"sigma", "N/m"},
    {"sigma_error", "N/m"},
    {"alpha"},
    {"alpha_error"},
    {"slip_force", "N"},
    {"slip_force_error", "N"},
    {"force_offset", "N"},
    {"force_offset_error", "N"},
    {"rms", "N"},
    {"friction_coefficient"},  // Tc/N, where the load is known and Tc identifiable
    {"contact_radius", "m"},   // σG*/8, where the compliance is known; never of a torque
});

/// Returns the place of a column among them; their number for a name that no column has.
inline std::size_t PlaceOf(std::string_view column) {
  const auto row = std::ranges::find(kCycleNumbers, column, &CycleNumber::name);
  return static_cast<std::size_t>(row - kCycleNumbers.begin());
}

/// Holds the results of one cycle, or of several fitted together, in the units of loop::LoopFacts
/// and FitResult; of several the energy is the mean, the other facts are those of the widest.
struct CycleFit {
  std::size_t number = 1;
  std::size_t first_line = 0;
  std::size_t samples = 0;
  std::size_t cycles = 1;
  /// Numbers of the table's columns, each empty where it is not known.
  std::array<std::optional<double>, kCycleNumbers.size()> numbers{};
  /// Holds the warnings about this cycle, each one of kCycleFlags.
  std::vector<std::string> flags{};

  /// Return the number of a column: fit["sigma"].
  /// @throws std::out_of_range for a name that no column has
  [[nodiscard]] auto& operator[](std::string_view column) { return numbers.at(PlaceOf(column)); }
  [[nodiscard]] auto& operator[](std::string_view column) const {
    return numbers.at(PlaceOf(column));
  }

  [[nodiscard]] bool HasFlag(std::string_view flag) const {
    return std::ranges::find(flags, flag) != flags.end();
  }
};

/// Names a flag of a cycle and explains it in a sentence.
struct CycleFlag {
  std::string_view name;
  std::string_view meaning;
};

/// Every flag that a cycle may have.
inline constexpr auto kCycleFlags = std::to_array<CycleFlag>({
    {"not_converged", "the fit failed or did not converge; its values are not to be used"},
    {"sigma_open", "the cycle does not determine sigma"},
    {"alpha_open", "the cycle does not determine alpha"},
    {"slip_force_open", "the cycle does not determine Tc"},
    {"not_closed", "the cycle does not end where it began, to 5 % of its width"},
    {"rows_missing", "time jumps by a quarter of a cycle or more: what turned there is not seen"},
    {"no_loop", "the cycle is no loop: it dissipates nothing"},
    {"glitches", "spikes or dropouts were left out or interpolated"},
});

/// Refuses options that no fit of the record takes: a cycle that cannot be fitted is flagged only.
/// @param head  its first cycles; of one without a force nothing is said
/// @throws InvalidArgument as Fitter::Fit()
void RequireFit(const loop::RecordView& head, const identification::FitOptions& options);

/// Fits one cycle after the other, each from where the last one ended (Fitter::Continue() at
/// Depth::kErrors): each has the minimum that a fit of it alone has, to the solver's tolerance, and
/// the standard errors of its noise.
class CycleFitter {
 public:
  /// @param options  of each cycle: steady unless another state is given; with the splitting gate
  /// @throws InvalidArgument as Fitter
  /// @param compliance  G* [1/Pa], where it is known
  explicit CycleFitter(identification::FitOptions options,
                       std::optional<double> compliance = std::nullopt);

  /// A cycle that cannot be fitted is one with the flag not_converged.
  CycleFit Fit(const Cycle& cycle);

 private:
  identification::Fitter fitter_;
  std::optional<double> compliance_;
};

/// Returns the first line of a table of cycles: the columns with their units.
/// @param is_torsional  of torques against angles
std::string CycleTableHeader(bool is_torsional);

/// Returns one line of it (RFC 4180, LF): numbers with as many digits as read back the same double,
/// an empty cell for what is not known, flags separated by blanks.
/// @param accumulated_energy  [J] dissipated up to the end of the cycle
std::string CycleTableRow(const CycleFit& fit, double accumulated_energy,
                          bool is_torsional = false);

/// Returns what a line of the table has of a fit: the inverse of CycleTableRow().
/// @param line  without its end
/// @throws InputError where it is no line of such a table, saying why
CycleFit ReadCycleTableRow(std::string_view line, bool is_torsional = false);

}  // namespace mindahl::campaign
