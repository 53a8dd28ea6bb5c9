#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/identification/fit.h"

namespace mindahl::campaign {

/// A fitted value and one standard error; empty where there is none.
struct FittedValue {
  std::optional<double> value;
  std::optional<double> standard_error;
};

/// Holds the results of one cycle, or of several fitted together, in the units of loop::LoopFacts
/// and identification::FitResult; facts are the means of the cycles fitted together.
struct CycleFit {
  std::size_t number = 1;
  std::size_t first_line = 0;
  std::optional<double> start_time;  ///< [s]
  std::size_t samples = 0;
  // Facts, of no model; empty where the record closes no cycle.
  std::optional<double> amplitude;
  std::optional<double> peak_force;
  std::optional<double> sliding_amplitude;
  std::optional<double> half_gap;
  std::optional<double> energy;  ///< a cycle
  std::optional<double> energy_ratio;
  std::optional<double> energy_friction_coefficient;
  std::optional<double> normal_load;  ///< mean, given or of the column
  // The fit; empty where it failed.
  FittedValue sigma;
  FittedValue alpha;
  FittedValue slip_force;
  FittedValue force_offset;
  std::optional<double> rms;
  /// Tc/N, where the load is known and Tc identifiable.
  std::optional<double> friction_coefficient;
  /// σG*/8 [m], where the compliance is known.
  std::optional<double> contact_radius;
  std::optional<bool> slips_grossly;  ///< the fitted law at the cycle's amplitude
  std::uint64_t checksum = 0;         ///< like Cycle::checksum, up to the cycle's last sample
  /// Holds the warnings about this cycle, each one of CycleFlags().
  std::vector<std::string> flags;

  [[nodiscard]] bool HasFlag(std::string_view flag) const {
    return std::ranges::find(flags, flag) != flags.end();
  }
};

/// Names a flag of a cycle and explains it in a sentence.
struct CycleFlag {
  std::string_view name;
  std::string_view meaning;
};

/// Returns every flag that a cycle may have: not_converged, sigma_open, …
std::span<const CycleFlag> CycleFlags();

/// Fits one cycle after the other, each from where the last one ended: by Fitter::Continue() at
/// Depth::kErrors, so that each has the minimum that a fit of it alone has, to the solver's
/// tolerance, and the standard errors of its noise.
class CycleFitter {
 public:
  /// @param options  of each cycle: steady unless another state is given; with the splitting gate
  /// @throws InvalidArgument as Fitter
  /// @param compliance  G* [1/Pa], where it is known
  explicit CycleFitter(identification::FitOptions options,
                       std::optional<double> compliance = std::nullopt);

  /// A cycle that cannot be fitted is one with the flag not_converged. Every number is finite: one
  /// that overflows is empty.
  CycleFit Fit(const Cycle& cycle);

 private:
  CycleFit FitAlone(const Cycle& cycle);

  identification::Fitter fitter_;
  std::optional<double> compliance_;
};

/// Describes a column of numbers of the table, and how to get it from a fit.
struct CycleNumber {
  std::string_view name;
  std::string_view unit;  ///< in a record of forces; "" for a pure number
  std::optional<double>& (*of)(CycleFit&) = nullptr;
};

/// Returns all of them, in the order of the table; of a torque about the contact no contact radius.
std::span<const CycleNumber> CycleNumbers(bool is_torsional = false);

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
