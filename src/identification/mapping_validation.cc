#include "mindahl/identification/mapping_validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/draws.h"
#include "core/extremes.h"
#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"

namespace mindahl::identification {

namespace {

constexpr std::array kCycles = {1.0, 1.25, 2.0, 2.5, 3.0, 4.0};
constexpr std::array<std::size_t, 3> kSamplesPerCycle = {100, 200, 400};

struct Case {
  double friction_coefficient = 0.0;
  double normal_load = 0.0;
  contact::MindlinContact contact;
  double lambda = 0.0;
  double direction = 1.0;
  models::ExcitationOptions excitation = {};
};

Case DrawCase(std::size_t index, Draws& draws) {
  const std::size_t round = index / kLambdas.size();
  Case drawn{.friction_coefficient = draws.Uniform(0.05, 1.2),
             .normal_load = draws.LogUniform(1e-6, 1e5),
             .contact = {.contact_radius = draws.LogUniform(1e-8, 3e-2),
                         .tangential_compliance = draws.LogUniform(1e-12, 1e-8)},
             .lambda = kLambdas[index % kLambdas.size()],
             .direction = round % 2 == 0 ? 1.0 : -1.0};
  drawn.contact.slip_force = contact::GrossSlipForce(drawn.friction_coefficient, drawn.normal_load);
  drawn.excitation = {
      .waveform = round / 2 % 2 == 0 ? models::Waveform::kSine : models::Waveform::kTriangle,
      .amplitude = drawn.lambda * GrossSlipDisplacement(drawn.contact),
      .cycles = kCycles[round % kCycles.size()],
      .samples_per_cycle = kSamplesPerCycle[index % kSamplesPerCycle.size()]};
  return drawn;
}

/// Returns the loop by Mindlin's equations 13 to 15, phase by phase.
loop::Record MindlinRecord(const Case& drawn) {
  const models::Excitation excitation = models::MakeExcitation(drawn.excitation);
  const double amplitude = drawn.excitation.amplitude;
  const double per_cycle = static_cast<double>(drawn.excitation.samples_per_cycle);
  loop::Record record;
  record.time = excitation.time;
  for (const double x : excitation.displacement) {
    const double phase = static_cast<double>(record.size()) / per_cycle;
    const bool unloading = std::fmod(phase - 0.25, 1.0) < 0.5;
    const double force = phase <= 0.25 ? contact::MindlinVirginForce(drawn.contact, x)
                         : unloading   ? contact::MindlinUnloadingForce(drawn.contact, x, amplitude)
                                     : contact::MindlinReloadingForce(drawn.contact, x, amplitude);
    record.displacement.push_back(drawn.direction * x);
    record.force.push_back(drawn.direction * force);
  }
  return record;
}

/// Adds a fit to its row, and returns what misses the tolerance; empty where nothing does.
std::string Add(const loop::Record& record, const models::BranchLaw& law, const FitResult& fit,
                ValidationRow& row) {
  using Value = std::pair<const char*, double>;
  const std::array truth = {Value{"sigma", law.tangential_stiffness},
                            Value{"alpha", law.shape_exponent},
                            Value{"slip_force", law.slip_force}};
  std::array<double, truth.size()> errors{};
  bool is_undetermined = false;
  for (std::size_t k = 0; k < truth.size() && !fit.parameters.empty(); ++k) {
    const auto& [name, value] = truth[k];
    const ParameterEstimate& estimate = *fit.Find(name);
    errors[k] = estimate.name == "alpha" ? std::abs(estimate.value - value)
                                         : std::abs(estimate.value / value - 1);
    row.errors[k] = std::max(row.errors[k], errors[k]);
    is_undetermined |= !estimate.is_known();
    if (!estimate.is_known()) continue;
    ++row.intervals;
    const bool covers =
        estimate.lower95.value_or(value) <= value && value <= estimate.upper95.value_or(value);
    row.covering += covers ? 1 : 0;
  }
  const bool has_noise = row.noise > 0;
  // Distance of the truth from the fit in standard errors, from the likelihood ratio of the two:
  // unlike an error over a standard error it also holds where the likelihood is not a parabola.
  double standardized = 0.0;
  if (has_noise && fit.converged) {
    const FitOptions options{.initial_state = fit.initial_state,
                             .fixed = {truth.begin(), truth.end()}};
    const double ratio = Fit({&record, 1}, options, Depth::kEstimate).rms / fit.rms;
    standardized = std::sqrt(std::max(ratio * ratio - 1, 0.0) * fit.degrees_of_freedom);
  }
  ++row.cases;
  row.undetermined += is_undetermined ? 1 : 0;
  row.worst_standardized = std::max(row.worst_standardized, standardized);
  const double worst = has_noise ? standardized : std::ranges::max(errors);
  if (fit.converged && worst <= row.tolerance && (has_noise || !is_undetermined)) return {};
  ++row.failures;
  return fmt::format(
      "{}errors sigma {:.2e}, alpha {:.2e}, slip_force {:.2e}; {:.1f} standard errors",
      fit.converged ? "" : fmt::format("not converged ({}), ", fit.solver.message), errors[0],
      errors[1], errors[2], standardized);
}

}  // namespace

ValidationReport ValidateMapping(const ValidationOptions& options) {
  if (options.cases < 1) ThrowInvalid("cases [-]", 0, "must be >= 1");
  ValidationReport report;
  // Below λ = 1/2 the loop's deviation from a straight line, which alone distinguishes α from Tc,
  // shrinks as λ² and magnifies rounding errors likewise. With noise χ² of three degrees of freedom
  // exceeds six squared once in 10⁷.
  for (const double noise : kNoiseLevels) {
    for (const double lambda : kLambdas) {
      const double tolerance = noise > 0 ? 6.0 : lambda >= 0.5 ? 1e-8 : 1e-6;
      report.rows.push_back({.lambda = lambda, .noise = noise, .tolerance = tolerance});
    }
  }
  Draws draws(options.seed);
  for (std::size_t index = 0; index < options.cases; ++index) {
    const Case drawn = DrawCase(index, draws);
    const loop::Record clean = MindlinRecord(drawn);
    const models::BranchLaw truth = contact::MapMindlinToDahl(drawn.contact);
    const double peak = ExtremesOf(clean.force).largest_magnitude();
    for (std::size_t place = index % kLambdas.size(); place < report.rows.size();
         place += kLambdas.size()) {
      ValidationRow& row = report.rows[place];
      loop::Record noisy = clean;
      for (double& force : noisy.force) force += row.noise * peak * draws.Normal();
      const std::string missed = Add(noisy, truth, Fit({&noisy, 1}), row);
      if (missed.empty()) continue;
      report.failed_cases.push_back(fmt::format(
          "case {}: lambda {}, noise {}, N {:.6g} N, a {:.6g} m, G* {:.6g} 1/Pa, mu {:.4g}: {}",
          index, drawn.lambda, row.noise, drawn.normal_load, drawn.contact.contact_radius,
          drawn.contact.tangential_compliance, drawn.friction_coefficient, missed));
    }
  }
  return report;
}

}  // namespace mindahl::identification
