#pragma once

#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "mindahl/models/steady_loop.h"
#include "mindahl/report/report.h"

/// Fits made by hand, so that a report can be compared with what was put in.
namespace mindahl::testing {

// Mindlin's contact of the loops here: δc = 3Tc/(2σ) = 1.5 µm.
inline constexpr double kSigma = 4e7;       // [N/m]
inline constexpr double kSlipForce = 40.0;  // [N]

inline identification::ParameterEstimate MadeParameter(const char* name, const char* unit,
                                                       double value, double standard_error) {
  identification::ParameterEstimate estimate;
  estimate.name = name;
  estimate.unit = unit;
  estimate.value = value;
  estimate.standard_error = standard_error;
  estimate.lower95 = value - 2 * standard_error;
  estimate.upper95 = value + 2 * standard_error;
  estimate.status = identification::ParameterStatus::kFree;
  estimate.identifiability = identification::Identifiability::kIdentifiable;
  return estimate;
}

/// A record of one steady cycle between ±amplitude [m], samples of one made force.
inline loop::Record MadeRecord(double amplitude, std::size_t samples = 9) {
  loop::Record record;
  for (std::size_t i = 0; i < samples; ++i) {
    const double phase = 2 * M_PI * static_cast<double>(i) / static_cast<double>(samples - 1);
    record.displacement.push_back(amplitude * std::cos(phase));
    record.force.push_back(10 * std::cos(phase - 0.3));
    record.time.push_back(0.25 * static_cast<double>(i));
  }
  return record;
}

inline identification::RecordFit MadeRecordFit(const loop::Record& record, double amplitude) {
  identification::RecordFit fit;
  fit.facts.amplitude = amplitude;
  fit.facts.peak_force = 10.0;
  fit.facts.complete_cycles = 1;
  fit.reversals = {record.size() / 2};
  for (std::size_t i = 0; i < record.size(); ++i) {
    fit.residual.push_back(0.125 * static_cast<double>(i));
    fit.fitted_force.push_back(record.force[i] + fit.residual.back());
  }
  return fit;
}

/// σ, α and Tc are known to 1 %, and their errors are uncorrelated.
inline identification::FitResult MadeFit(const std::vector<loop::Record>& records, double amplitude,
                                         const models::BranchLaw& law = {kSigma, 1.0 / 3,
                                                                         kSlipForce}) {
  identification::FitResult fit;
  fit.converged = true;
  fit.solver.message = "made by hand";
  fit.model = models::FindFrictionModel("mindlin-dahl");
  fit.law = law;
  fit.parameters = {
      MadeParameter("sigma", "N/m", law.tangential_stiffness, 0.01 * law.tangential_stiffness),
      MadeParameter("alpha", "-", law.shape_exponent, 0.01),
      MadeParameter("slip_force", "N", law.slip_force, 0.01 * law.slip_force)};
  fit.correlation = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  fit.adequacy.tried = 12;
  fit.residuals.samples = 9;
  fit.degrees_of_freedom = 6;
  for (const loop::Record& record : records)
    fit.records.push_back(MadeRecordFit(record, amplitude));
  return fit;
}

/// Adds one that is not correlated with others.
inline identification::ParameterEstimate& AddParameter(identification::FitResult& fit,
                                                       const char* name, const char* unit,
                                                       double value, double standard_error) {
  fit.parameters.push_back(MadeParameter(name, unit, value, standard_error));
  fit.correlation.assign(fit.parameters.size() * fit.parameters.size(), 0.0);
  return fit.parameters.back();
}

/// A steel ball on a steel plane.
inline const contact::KnownContact kSphereOnPlane = [] {
  contact::KnownContact known{.normal_load = 50.0};
  known.body_1 = {.youngs_modulus = 210e9, .poisson_ratio = 0.3, .radius = 0.01};
  known.body_2 = known.body_1;
  known.body_2.radius = std::numeric_limits<double>::infinity();
  return known;
}();

inline report::ReportInput MadeInput(const std::vector<loop::Record>& records, double amplitude) {
  report::ReportInput input;
  for (const loop::Record& record : records) {
    io::RecordFile file;
    file.name = "loop_" + std::to_string(input.records.size() + 1) + ".csv";
    file.record = record;
    file.displacement.unit = "m";
    file.force.unit = "N";
    input.records.push_back(std::move(file));
  }
  input.fit = MadeFit(records, amplitude);
  return input;
}

/// A step that was tried and halves the misfit.
inline report::NextStep MadeStep(std::string options, std::string text = "") {
  return {.text = std::move(text),
          .options = std::move(options),
          .misfit_before = 0.2,
          .misfit_after = 0.1};
}

inline constexpr double kMadeAmplitude = 2e-6;  // [m]

inline report::ReportInput MadeInput() {
  return MadeInput({MadeRecord(kMadeAmplitude)}, kMadeAmplitude);
}

/// A fit without a solution, as Fit() returns it.
inline report::ReportInput FailedInput() {
  report::ReportInput input = MadeInput();
  input.fit.converged = false;
  input.fit.solver.message = "no start led anywhere";
  input.fit.parameters.clear();
  input.fit.correlation.clear();
  input.fit.residuals = {};
  input.fit.records[0].residual.clear();
  input.fit.records[0].fitted_force.clear();
  input.fit.findings = {
      {.code = "not_converged", .severity = identification::Severity::kFailure, .kind = "failed"}};
  return input;
}

}  // namespace mindahl::testing
