#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/identification/plan.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/request/contact_request.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::request {

/// Holds the contact and the loops to plan: docs/contract.md, `mindahl plan`.
struct PlanRequest {
  LawRequest law{};
  /// Reads a record whose fit gives law and noise; then of the law only α may be given.
  std::function<io::RecordFile()> record{};
  std::string record_name{};
  std::optional<double> rig_stiffness{};  ///< [N/m]
  std::optional<double> force_noise{};    ///< [N]
  double displacement_noise = 0.0;        ///< [m]
  double autocorrelation = 0.0;
  std::vector<double> amplitudes{};  ///< [m]; empty: 13 about slip
  std::vector<double> load_ratios{};
  std::optional<double> load_exponent{};
  std::size_t samples_per_cycle = 200;
  double cycles = 3.0;
  std::optional<models::InitialState> initial_state{};  ///< empty: both
  std::vector<std::string> with{};                      ///< names of terms that are fitted too
  identification::WantedPrecision wanted{};
};

/// The loops that start from one initial state, in the order of their amplitudes.
struct PlannedLoops {
  std::string_view initial_state;
  std::vector<identification::ExpectedFit> loops;
  std::optional<identification::ExpectedFit> reached;  ///< at the least amplitude that suffices
  identification::Protocol fewest;                     ///< sufficient, with the fewest cycles
};

struct Plan {
  PlanRequest request;
  identification::Expectation expected;
  double slip = 0.0;  ///< displacement [m] of λ = 1
  std::vector<PlannedLoops> columns = {};

  /// True if what is wanted, if anything, is reached.
  [[nodiscard]] bool established() const;
};

/// Computes the standard errors that loops of each amplitude would give, and the least amplitude
/// that reaches what is wanted.
/// @throws InputError or InvalidArgument naming the option
Plan MakePlan(const PlanRequest& request, const Tell& warn);

/// Returns the JSON of schema mindahl.plan/1, as `mindahl plan --json` writes it.
std::string ToJson(const Plan& plan);

/// Returns the table that `mindahl plan` prints.
std::string ToText(const Plan& plan);

/// Returns the expected standard errors against the amplitude, one panel per initial state.
/// @throws InputError where no amplitude determines a parameter
io::Plot ToPlot(const Plan& plan);

}  // namespace mindahl::request
