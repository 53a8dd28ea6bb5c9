#include "mindahl/identification/mapping_validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <boost/math/statistics/univariate_statistics.hpp>
#include <cmath>

#include "core/draws.h"
#include "core/probability.h"
#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/fit.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/steady_loop.h"

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

struct Errors {
  std::array<double, kValidatedParameters.size()> of_contact{};  // of σ, α and Tc
  double standardized = 0.0;
  bool undetermined = false;
  bool converged = false;
  std::string termination;
  std::array<IntervalCount, kValidatedParameters.size()> intervals;
};

/// Holds a loop, the fit to it, and the expected result.
struct Trial {
  const Record& record;
  FitOptions options;
  models::BranchLaw contact;  // by Masing's law
  models::BranchLaw truth;    // of the law that is fitted
  double amplitude;           // [m]

  [[nodiscard]] bool IsDahl() const { return options.model->memory == models::Memory::kNone; }
};

/// The whole loop by Masing's law.
Trial ByMasing(const Record& record, const Case& drawn) {
  const models::BranchLaw law = contact::MapMindlinToDahl(drawn.contact);
  return {record, {}, law, law, drawn.excitation.amplitude};
}

/// Its steady part by Dahl's own law.
Trial ByDahl(const Record& steady, const Case& drawn) {
  FitOptions options;
  options.model = models::FindFrictionModel("dahl");
  options.initial_state = models::InitialState::kSteady;
  const double amplitude = drawn.excitation.amplitude;
  const models::BranchLaw law = contact::MapMindlinToDahl(drawn.contact);
  return {steady, options, law, models::DahlEquivalent(law, amplitude), amplitude};
}

/// Returns the record from the first extreme on.
Record SteadyPart(Record record, const Case& drawn) {
  const auto first = static_cast<std::ptrdiff_t>(drawn.excitation.samples_per_cycle / 4);
  for (auto* column : {&record.time, &record.displacement, &record.force}) {
    column->erase(column->begin(), column->begin() + first);
  }
  return record;
}

Errors Compare(const Trial& trial, const FitResult& fit) {
  Errors errors;
  errors.converged = fit.converged;
  errors.termination = fit.solver.message;
  if (fit.parameters.empty()) return errors;
  // A fit of Dahl's law is compared with the contact through the Masing law of the same loop.
  const models::BranchLaw found =
      trial.IsDahl() ? models::MasingEquivalent(fit.law, trial.amplitude) : fit.law;
  errors.of_contact = {
      std::abs(found.tangential_stiffness / trial.contact.tangential_stiffness - 1),
      std::abs(found.shape_exponent - trial.contact.shape_exponent),
      std::abs(found.slip_force / trial.contact.slip_force - 1)};
  const models::BranchLaw& truth = trial.truth;
  const std::array values = {truth.tangential_stiffness, truth.shape_exponent, truth.slip_force};
  for (std::size_t k = 0; k < values.size(); ++k) {
    const ParameterEstimate& estimate = *fit.Find(kValidatedParameters[k]);
    if (!estimate.is_known()) {
      errors.undetermined = true;
      continue;
    }
    const bool covers = (!estimate.lower95 || *estimate.lower95 <= values[k]) &&
                        (!estimate.upper95 || values[k] <= *estimate.upper95);
    errors.intervals[k] = {.intervals = 1, .covering = covers ? 1U : 0U};
  }
  return errors;
}

ErrorSpread SpreadOf(std::vector<double> errors) {
  if (errors.empty()) return {};
  const double worst = std::ranges::max(errors);
  return {boost::math::statistics::median(errors.begin(), errors.end()), worst};
}

/// Distance of the truth from the fit in standard errors, from the likelihood ratio of the two:
/// unlike an error over a standard error it also holds where the likelihood is not a parabola.
double StandardizedDistance(const Trial& trial, const FitResult& fit) {
  FitOptions options = trial.options;
  options.initial_state = fit.initial_state;
  options.fixed = {{"sigma", trial.truth.tangential_stiffness},
                   {"alpha", trial.truth.shape_exponent},
                   {"slip_force", trial.truth.slip_force}};
  const FitResult at_truth = Fit({&trial.record, 1}, options, Depth::kEstimate);
  const double ratio = at_truth.rms / fit.rms;
  return std::sqrt(std::max(ratio * ratio - 1, 0.0) * fit.residuals.degrees_of_freedom);
}

/// Collects one row of the table.
struct RowBuilder {
  ValidationRow row;
  std::array<std::vector<double>, kValidatedParameters.size()> of_contact;

  /// @returns whether the case met the tolerance
  bool Add(const Errors& errors) {
    ++row.cases;
    row.undetermined += errors.undetermined ? 1 : 0;
    row.worst_standardized = std::max(row.worst_standardized, errors.standardized);
    for (std::size_t k = 0; k < errors.intervals.size(); ++k) {
      of_contact[k].push_back(errors.of_contact[k]);
      row.intervals[k].Add(errors.intervals[k]);
    }
    const double worst = row.noise == 0 ? std::ranges::max(errors.of_contact) : errors.standardized;
    const bool met =
        errors.converged && worst <= row.tolerance && (row.noise > 0 || !errors.undetermined);
    row.failures += met ? 0 : 1;
    return met;
  }

  ValidationRow Finish() {
    IntervalCount all;
    for (std::size_t k = 0; k < of_contact.size(); ++k) {
      row.errors[k] = SpreadOf(std::move(of_contact[k]));
      all.Add(row.intervals[k]);
    }
    row.coverage = all.fraction();
    return row;
  }
};

void RequireValidation(const ValidationOptions& options) {
  if (options.cases < 1) ThrowInvalid("cases [-]", 0, "must be >= 1");
  if (options.lambdas.empty() || options.noise_levels.empty()) {
    throw InvalidArgument("amplitudes and noise levels must not be empty");
  }
  for (const double lambda : options.lambdas) RequirePositive("lambda [-]", lambda);
  for (const double noise : options.noise_levels) RequireNonNegative("noise level [-]", noise);
}

std::string Describe(const Case& drawn, std::size_t index, double noise, const Trial& trial,
                     const Errors& errors) {
  return fmt::format(
      "case {}{}: lambda {}, noise {}, N {:.6g} N, a {:.6g} m, G* {:.6g} 1/Pa, mu {:.4g}, {} "
      "cycles: "
      "{}errors sigma {:.2e}, alpha {:.2e}, slip_force {:.2e}; {:.1f} standard errors",
      index, trial.IsDahl() ? " by Dahl's own law" : "", drawn.lambda, noise, drawn.normal_load,
      drawn.contact.contact_radius, drawn.contact.tangential_compliance, drawn.friction_coefficient,
      drawn.excitation.cycles,
      errors.converged ? "" : fmt::format("not converged ({}), ", errors.termination),
      errors.of_contact[0], errors.of_contact[1], errors.of_contact[2], errors.standardized);
}

/// Judges the coverage of every parameter and law, over all rows with noise.
void JudgeCoverage(ValidationReport& report) {
  constexpr auto kTests = 4.0 * static_cast<double>(kValidatedParameters.size());  // laws and sides
  for (const bool by_dahl : {false, true}) {
    for (std::size_t k = 0; k < kValidatedParameters.size(); ++k) {
      CoverageVerdict verdict{.parameter = kValidatedParameters[k], .by_dahl = by_dahl};
      for (const ValidationRow& row : by_dahl ? report.dahl_rows : report.rows) {
        if (!(row.noise > 0)) continue;
        verdict.all.Add(row.intervals[k]);
        if (row.lambda > 1) verdict.sliding.Add(row.intervals[k]);
      }
      if (verdict.all.intervals == 0) continue;
      const double few = verdict.all.ChanceOfSoFew();
      const double many = verdict.sliding.ChanceOfSoMany();
      verdict.chance = std::min(few, many);
      verdict.passed = verdict.chance >= kCoverageFalseAlarm / kTests;
      report.coverage.push_back(verdict);
      if (verdict.passed) continue;
      const IntervalCount& count = few <= many ? verdict.all : verdict.sliding;
      report.failed_coverages.push_back(fmt::format(
          "coverage of {}{}{}: {} of {} intervals, {:.1f} %, of 95 % stated and {:g} to {:g} % "
          "promised (p = {:.1e})",
          verdict.parameter, by_dahl ? " by Dahl's own law" : "",
          few <= many ? "" : " at lambda > 1", count.covering, count.intervals,
          100 * count.fraction(), 100 * kLowestCoverage, 100 * kHighestCoverage, verdict.chance));
    }
  }
}

}  // namespace

double IntervalCount::ChanceOfSoFew() const {
  if (intervals == 0) return 1.0;
  return BinomialAtMost(static_cast<double>(covering), static_cast<double>(intervals),
                        kLowestCoverage);
}

double IntervalCount::ChanceOfSoMany() const {
  if (intervals == 0 || covering == 0) return 1.0;
  return BinomialAbove(static_cast<double>(covering - 1), static_cast<double>(intervals),
                       kHighestCoverage);
}

double NoiseFreeTolerance(double lambda) {
  // Below λ = 1/2 the loop's deviation from a straight line, which alone distinguishes α from Tc,
  // shrinks as λ² and magnifies rounding errors likewise.
  return lambda >= 0.5 ? 1e-8 : 1e-6;
}

ValidationReport ValidateMapping(const ValidationOptions& options) {
  RequireValidation(options);
  std::array<std::vector<RowBuilder>, 2> rows;  // by Masing's law, and by Dahl's own
  for (const double noise : options.noise_levels) {
    for (const double lambda : options.lambdas) {
      RowBuilder& builder = rows[0].emplace_back();
      builder.row.noise = noise;
      builder.row.lambda = lambda;
      builder.row.tolerance = noise == 0 ? NoiseFreeTolerance(lambda) : kStandardErrorsTolerated;
    }
  }
  rows[1] = rows[0];
  ValidationReport report;
  Draws draws(options.seed);
  for (std::size_t index = 0; index < options.cases; ++index) {
    const Case drawn = DrawCase(options, index, draws);
    const Record clean = MindlinRecord(drawn);
    const double peak =
        *std::ranges::max_element(clean.force, {}, [](double force) { return std::abs(force); });
    for (std::size_t level = 0; level < options.noise_levels.size(); ++level) {
      Record noisy = clean;
      const double noise = options.noise_levels[level];
      for (double& force : noisy.force) force += noise * std::abs(peak) * draws.Normal();
      const Record steady = SteadyPart(noisy, drawn);
      const std::size_t place = level * options.lambdas.size() + index % options.lambdas.size();
      for (const Trial& trial : {ByMasing(noisy, drawn), ByDahl(steady, drawn)}) {
        const FitResult fit = Fit({&trial.record, 1}, trial.options);
        Errors errors = Compare(trial, fit);
        if (noise > 0 && errors.converged) errors.standardized = StandardizedDistance(trial, fit);
        ++report.fits;
        if (!rows[trial.IsDahl() ? 1 : 0][place].Add(errors)) {
          ++report.failures;
          report.failed_cases.push_back(Describe(drawn, index, noise, trial, errors));
        }
      }
    }
  }
  for (RowBuilder& row : rows[0]) report.rows.push_back(row.Finish());
  for (RowBuilder& row : rows[1]) report.dahl_rows.push_back(row.Finish());
  JudgeCoverage(report);
  return report;
}

}  // namespace mindahl::identification
