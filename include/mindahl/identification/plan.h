#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/identification/fit_result.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/response.h"

/// Predicts the errors that a fit of a loop would have, before it is measured.
namespace mindahl::identification {

/// Holds the assumed properties of the contact and the noise of the channels.
struct Expectation {
  models::BranchLaw law{};
  /// Has the law's memory: Masing's ("mindlin-dahl") or Dahl's own ("dahl").
  const models::FrictionModel* model = models::FindFrictionModel("mindlin-dahl");
  models::SeriesSpring rig{};       ///< in series; its stiffness is known
  double force_noise = 0.0;         ///< standard deviation [N], finite, > 0
  double displacement_noise = 0.0;  ///< standard deviation [m], white, finite, >= 0
};

/// A loop that may be measured: a sine of one amplitude, of a contact that was cycled before.
struct Protocol {
  double amplitude = 0.0;               ///< X [m], finite, > 0
  double cycles = 3.0;                  ///< finite, >= 1
  std::size_t samples_per_cycle = 200;  ///< >= 4
};

/// Holds the expected result of a fit of the planned loop.
struct ExpectedFit {
  Protocol protocol;
  double peak_force = 0.0;  ///< T* [N]
  /// σ, α, Tc and all else that is fitted or reported: values that are expected, standard errors,
  /// 95 % intervals; without errors what the loop does not determine. No verdicts.
  std::vector<ParameterEstimate> parameters;

  /// Returns nullptr when there is none of that name.
  [[nodiscard]] const ParameterEstimate* Find(std::string_view name) const {
    return FindEstimate(parameters, name);
  }
};

/// Computes the Cramér–Rao bound from the exact derivatives at the values that are expected: what
/// unbiased estimates cannot better, and what those of the fit attain where the likelihood is a
/// parabola over their errors. Offsets are unknown, a rig that is given is known.
/// @throws InvalidArgument for values out of range, naming them
/// Accuracy: standard errors of simulated fits scatter about these by what their number leaves
/// (plan_test.cc: 150 loops, 17 %), unless an error is of the order of its parameter.
ExpectedFit ExpectFit(const Expectation& expected, const Protocol& protocol);

/// A standard error that is wanted.
struct Precision {
  double value = 0.0;  ///< in the parameter's unit, or as a fraction of it; > 0
  bool is_relative = false;
};

/// Maps a parameter ("sigma", "alpha", "slip_force" …) to its wanted precision.
using WantedPrecision = std::map<std::string, Precision>;

/// Returns the factor on the number of cycles that reaches the wanted precision, errors falling
/// with its root: <= 1 where it is reached; infinite where the loop leaves a parameter open.
/// @throws InvalidArgument for a name that the fit does not have, or a precision that is not > 0
double CyclesFactor(const ExpectedFit& fit, const WantedPrecision& wanted);

}  // namespace mindahl::identification
