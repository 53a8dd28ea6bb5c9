#include "mindahl/identification/mapping_validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/draws.h"
#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"

namespace mindahl::identification {

using loop::Record;

namespace {

constexpr std::array kCycles = {1.0, 1.25, 2.0, 2.5, 3.0, 4.0};
constexpr std::array<std::size_t, 3> kSamplesPerCycle = {100, 200, 400};

struct Case {
  double friction_coefficient = 0.0;
  double normal_load = 0.0;
  contact::MindlinContact contact;
  double lambda = 0.0;
  double direction = 1.0;
  models::ExcitationOptions excitation;
};

Case DrawCase(const ValidationOptions& options, std::size_t index, Draws& draws) {
  Case drawn;
  drawn.friction_coefficient = draws.Uniform(0.05, 1.2);
  drawn.normal_load = draws.LogUniform(1e-6, 1e5);
  drawn.contact.contact_radius = draws.LogUniform(1e-8, 3e-2);
  drawn.contact.tangential_compliance = draws.LogUniform(1e-12, 1e-8);
  drawn.contact.slip_force = contact::GrossSlipForce(drawn.friction_coefficient, drawn.normal_load);
  drawn.lambda = options.lambdas[index % options.lambdas.size()];
  const std::size_t round = index / options.lambdas.size();
  drawn.direction = round % 2 == 0 ? 1.0 : -1.0;
  drawn.excitation.waveform =
      round / 2 % 2 == 0 ? models::Waveform::kSine : models::Waveform::kTriangle;
  drawn.excitation.cycles = kCycles[round % kCycles.size()];
  drawn.excitation.samples_per_cycle = kSamplesPerCycle[index % kSamplesPerCycle.size()];
  drawn.excitation.amplitude = drawn.lambda * GrossSlipDisplacement(drawn.contact);
  return drawn;
}

/// Returns the loop by Mindlin's equations 13 to 15, phase by phase.
Record MindlinRecord(const Case& drawn) {
  const models::Excitation excitation = models::MakeExcitation(drawn.excitation);
  const double amplitude = drawn.excitation.amplitude;
  const double per_cycle = static_cast<double>(drawn.excitation.samples_per_cycle);
  Record record;
  record.time = excitation.time;
  for (std::size_t i = 0; i < excitation.displacement.size(); ++i) {
    const double x = excitation.displacement[i];
    const double phase = static_cast<double>(i) / per_cycle;
    double force = 0.0;
    if (phase <= 0.25) {
      force = contact::MindlinVirginForce(drawn.contact, x);
    } else {
      const bool unloading = std::fmod(phase - 0.25, 1.0) < 0.5;
      force = unloading ? contact::MindlinUnloadingForce(drawn.contact, x, amplitude)
                        : contact::MindlinReloadingForce(drawn.contact, x, amplitude);
    }
    record.displacement.push_back(drawn.direction * x);
    record.force.push_back(drawn.direction * force);
  }
  return record;
}

/// How far a fit is from the truth.
struct Errors {
  std::array<double, kValidatedParameters.size()> of_contact{};  // of σ, α and Tc
  double standardized = 0.0;
  bool undetermined = false;
  std::size_t intervals = 0;
  std::size_t covering = 0;
};

Errors Compare(const FitResult& fit, const models::BranchLaw& truth) {
  Errors errors;
  if (fit.parameters.empty()) return errors;
  errors.of_contact = {std::abs(fit.law.tangential_stiffness / truth.tangential_stiffness - 1),
                       std::abs(fit.law.shape_exponent - truth.shape_exponent),
                       std::abs(fit.law.slip_force / truth.slip_force - 1)};
  const std::array values = {truth.tangential_stiffness, truth.shape_exponent, truth.slip_force};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const ParameterEstimate& estimate = *fit.Find(kValidatedParameters[k]);
    if (!estimate.is_known()) {
      errors.undetermined = true;
      continue;
    }
    ++errors.intervals;
    if (estimate.lower95.value_or(values[k]) <= values[k] &&
        values[k] <= estimate.upper95.value_or(values[k])) {
      ++errors.covering;
    }
  }
  return errors;
}

/// Distance of the truth from the fit in standard errors, from the likelihood ratio of the two:
/// unlike an error over a standard error it also holds where the likelihood is not a parabola.
double StandardizedDistance(const Record& record, const models::BranchLaw& truth,
                            const FitResult& fit) {
  FitOptions options;
  options.initial_states = {fit.initial_state};
  options.fixed = {{"sigma", truth.tangential_stiffness},
                   {"alpha", truth.shape_exponent},
                   {"slip_force", truth.slip_force}};
  const FitResult at_truth = Fit({&record, 1}, options, Depth::kEstimate);
  const double ratio = at_truth.rms / fit.rms;
  return std::sqrt(std::max(ratio * ratio - 1, 0.0) * fit.residuals.degrees_of_freedom);
}

/// Adds a case to its row.
/// @returns whether it met the tolerance
bool Add(const Errors& errors, bool converged, ValidationRow& row) {
  ++row.cases;
  row.undetermined += errors.undetermined ? 1 : 0;
  row.worst_standardized = std::max(row.worst_standardized, errors.standardized);
  row.intervals += errors.intervals;
  row.covering += errors.covering;
  for (std::size_t k = 0; k < row.errors.size(); ++k) {
    row.errors[k] = std::max(row.errors[k], errors.of_contact[k]);
  }
  const bool has_noise = row.noise > 0;
  const double worst = has_noise ? errors.standardized : std::ranges::max(errors.of_contact);
  const bool met = converged && worst <= row.tolerance && (has_noise || !errors.undetermined);
  row.failures += met ? 0 : 1;
  return met;
}

void RequireValidation(const ValidationOptions& options) {
  if (options.cases < 1) ThrowInvalid("cases [-]", 0, "must be >= 1");
  if (options.lambdas.empty() || options.noise_levels.empty()) {
    throw InvalidArgument("amplitudes and noise levels must not be empty");
  }
  for (const double lambda : options.lambdas) RequirePositive("lambda [-]", lambda);
  for (const double noise : options.noise_levels) RequireNonNegative("noise level [-]", noise);
}

std::string Describe(const Case& drawn, std::size_t index, const ValidationRow& row,
                     const FitResult& fit, const Errors& errors) {
  return fmt::format(
      "case {}: lambda {}, noise {}, N {:.6g} N, a {:.6g} m, G* {:.6g} 1/Pa, mu {:.4g}, {} "
      "cycles: {}errors sigma {:.2e}, alpha {:.2e}, slip_force {:.2e}; {:.1f} standard errors",
      index, row.lambda, row.noise, drawn.normal_load, drawn.contact.contact_radius,
      drawn.contact.tangential_compliance, drawn.friction_coefficient, drawn.excitation.cycles,
      fit.converged ? "" : fmt::format("not converged ({}), ", fit.solver.message),
      errors.of_contact[0], errors.of_contact[1], errors.of_contact[2], errors.standardized);
}

}  // namespace

double NoiseFreeTolerance(double lambda) {
  // Below λ = 1/2 the loop's deviation from a straight line, which alone distinguishes α from Tc,
  // shrinks as λ² and magnifies rounding errors likewise.
  return lambda >= 0.5 ? 1e-8 : 1e-6;
}

ValidationReport ValidateMapping(const ValidationOptions& options) {
  RequireValidation(options);
  ValidationReport report;
  for (const double noise : options.noise_levels) {
    for (const double lambda : options.lambdas) {
      report.rows.push_back(
          {.lambda = lambda,
           .noise = noise,
           .tolerance = noise == 0 ? NoiseFreeTolerance(lambda) : kStandardErrorsTolerated});
    }
  }
  Draws draws(options.seed);
  for (std::size_t index = 0; index < options.cases; ++index) {
    const Case drawn = DrawCase(options, index, draws);
    const Record clean = MindlinRecord(drawn);
    const models::BranchLaw truth = contact::MapMindlinToDahl(drawn.contact);
    const double peak =
        *std::ranges::max_element(clean.force, {}, [](double force) { return std::abs(force); });
    for (std::size_t level = 0; level < options.noise_levels.size(); ++level) {
      Record noisy = clean;
      const double noise = options.noise_levels[level];
      for (double& force : noisy.force) force += noise * std::abs(peak) * draws.Normal();
      const FitResult fit = Fit({&noisy, 1});
      Errors errors = Compare(fit, truth);
      if (noise > 0 && fit.converged) errors.standardized = StandardizedDistance(noisy, truth, fit);
      ++report.fits;
      const std::size_t place = level * options.lambdas.size() + index % options.lambdas.size();
      ValidationRow& row = report.rows[place];
      if (Add(errors, fit.converged, row)) continue;
      ++report.failures;
      report.failed_cases.push_back(Describe(drawn, index, row, fit, errors));
    }
  }
  return report;
}

}  // namespace mindahl::identification
