#include "mindahl/identification/plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <ranges>
#include <utility>

#include "core/extremes.h"
#include "core/refuse.h"
#include "identification/inference/estimates.h"
#include "identification/inference/reweighting.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/excitation.h"

namespace mindahl::identification {
namespace {

/// The loop as it would be measured without noise.
loop::Record LoopOf(const Expectation& expected, const Protocol& protocol) {
  models::Excitation excitation =
      models::MakeExcitation({.amplitude = protocol.amplitude,
                              .cycles = protocol.cycles,
                              .samples_per_cycle = protocol.samples_per_cycle});
  loop::Record record{.displacement = std::move(excitation.displacement),
                      .force = std::vector<double>(excitation.time.size()),
                      .time = std::move(excitation.time)};
  const std::vector<std::size_t> reversals = loop::FindReversals(record.displacement, 0.0);
  const models::LoadingPath path =
      models::MakeLoadingPath(record.displacement, reversals, expected.model->memory,
                              {.state = models::InitialState::kSteady});
  models::EvaluateForce(*expected.model, expected.law, path, record.displacement, record.force,
                        expected.rig);
  return record;
}

/// Returns the options of a fit of the loop, from the values that are expected.
FitOptions OptionsOf(const Expectation& expected) {
  FitOptions options{.model = expected.model,
                     .initial_state = models::InitialState::kSteady,
                     .force_noise = expected.force_noise,
                     .start = {{"sigma", expected.law.tangential_stiffness},
                               {"alpha", expected.law.shape_exponent},
                               {"slip_force", expected.law.slip_force}}};
  options.preparation.force_sense = 1;
  options.preparation.displacement_noise = expected.displacement_noise;
  if (std::isfinite(expected.rig.stiffness)) {
    options.fixed["rig_stiffness"] = expected.rig.stiffness;
  }
  return options;
}

}  // namespace

ExpectedFit ExpectFit(const Expectation& expected, const Protocol& protocol) {
  models::Validate(expected.rig);
  RequirePositive("force noise [N]", expected.force_noise);
  RequireNonNegative("displacement noise [m]", expected.displacement_noise);
  if (!(protocol.cycles >= 1)) ThrowInvalid("cycles [-]", protocol.cycles, "must be >= 1");
  const loop::Record record = LoopOf(expected, protocol);
  FitOptions options = OptionsOf(expected);
  const loop::RecordView view = record;
  loop::PreparedRecords prepared = loop::Prepare({&view, 1}, options.preparation);
  options.preparation.drawn = loop::DrawReadings(prepared);
  ScaledRecords data = Scale(prepared, options);
  const Problem problem(data, options, models::InitialState::kSteady);
  const std::vector<double> theta = problem.parameters.Theta();
  Solution solution{.theta = theta};
  Noise noise;
  FitWithWeights(problem, data, options, solution, noise);
  solution.theta = theta;
  const Estimates estimates(problem, solution, noise, options,
                            Response(problem).LinearizeAt(theta, problem.parameters.free()));
  ExpectedFit result;
  result.protocol = protocol;
  result.peak_force = ExtremesOf(record.force).largest_magnitude();
  result.parameters = ValuesOf(problem, solution);
  for (std::size_t k = 0; k < result.parameters.size(); ++k) {
    estimates.Fill(problem.parameters.reported()[k], result.parameters[k]);
  }
  return result;
}

double CyclesFactor(const ExpectedFit& fit, const WantedPrecision& wanted) {
  double factor = 0.0;
  for (const auto& [name, precision] : wanted) {
    RequirePositive(fmt::format("wanted precision of {}", name), precision.value);
    const ParameterEstimate* estimate = fit.Find(name);
    if (estimate == nullptr) {
      const auto names = fit.parameters | std::views::transform(&ParameterEstimate::name);
      Refuse<InvalidArgument>("parameter {}", UnknownAmong(name, names));
    }
    if (estimate->status == ParameterStatus::kFixed) continue;
    if (!estimate->standard_error) return std::numeric_limits<double>::infinity();
    const double allowed =
        precision.is_relative ? precision.value * std::abs(estimate->value) : precision.value;
    factor = std::max(factor, std::pow(*estimate->standard_error / allowed, 2));
  }
  return factor;
}

}  // namespace mindahl::identification
