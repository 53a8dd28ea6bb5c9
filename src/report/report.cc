#include "mindahl/report/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/report/contact.h"

namespace mindahl::report {
namespace {

void Require(const ReportInput& input) {
  const std::size_t records = input.fit.records.size();
  if (records == 0 || input.fit.model == nullptr) {
    throw InvalidArgument("there is nothing to report: the fit has no record or no model");
  }
  RequireSameSize("names of files", input.files.size(), "records of the fit", records);
  RequireSameSize("records", input.records.size(), "records of the fit", records);
  for (std::size_t r = 0; r < records; ++r) {
    const Record& record = input.records[r].record;
    if (!input.fit.parameters.empty()) {
      RequireSameSize("samples", record.size(), "residuals of the fit",
                      input.fit.records[r].residual.size());
    }
    if (input.load_window) {
      RequireSameSize("normal loads, for the load window,", record.normal_load.size(), "samples",
                      record.size());
    }
  }
}

void AddName(std::string& list, std::string_view name) {
  list += list.empty() ? "" : ", ";
  list += name;
}

/// A sentence for each standard error and interval that is null, and why.
void ExplainMissingErrors(Report& report) {
  const auto warn = [&](const char* code, std::string message) {
    report.contact_warnings.push_back({code, std::move(message)});
  };
  std::string held;
  std::string uncorrelated;
  for (const ParameterEstimate& estimate : report.fit.parameters) {
    if (estimate.status == ParameterStatus::kFixed) {
      AddName(held, estimate.name);
      continue;
    }
    if (!estimate.standard_error) {
      const bool at_bound = estimate.status != ParameterStatus::kFree;
      warn("no_standard_error",
           fmt::format("{}: standard_error is null: {}", estimate.name,
                       at_bound ? "it lies at its bound, where the interval is one-sided"
                                : "the record leaves it open"));
    }
    if (!estimate.lower95 || !estimate.upper95) {
      warn("open_interval",
           fmt::format("{}: ci95 is open {}: the record sets no limit there", estimate.name,
                       estimate.lower95   ? "above"
                       : estimate.upper95 ? "below"
                                          : "on both sides"));
    }
  }
  if (!held.empty()) {
    warn("held_fixed", fmt::format("{}: not fitted, so standard_error and ci95 are null", held));
  }
  const std::size_t count = report.fit.parameters.size();
  for (std::size_t i = 0; i < count; ++i) {
    const ParameterEstimate& estimate = report.fit.parameters[i];
    const bool defined = std::isfinite(report.fit.correlation[i * count + i]);
    if (estimate.status != ParameterStatus::kFixed && !defined) {
      AddName(uncorrelated, estimate.name);
    }
  }
  if (!uncorrelated.empty()) {
    warn("no_correlation",
         fmt::format("correlation: null with {}: at a bound or undetermined", uncorrelated));
  }
  if (!report.fit.mindlin_test) {
    warn("alpha_not_tested",
         "mapping: likelihood_ratio, likelihood_ratio_p_value and tenable_with_rig_stiffness are "
         "null: alpha is held or not determined");
  } else if (!report.fit.mindlin_test->rig_stiffness) {
    warn("no_rig_found",
         "mapping: tenable_with_rig_stiffness is null: alpha = 1/3 is not rejected, alpha is the "
         "larger one, a rig is fitted, or none helps");
  }
  const IdentifiedContact& contact = report.contact;
  const auto explain = [&](const char* name, const std::optional<UncertainValue>& value) {
    if (!value || std::isfinite(value->standard_error)) return;
    warn("no_standard_error",
         fmt::format("contact: {}: standard_error is null, as that of the parameter it rests on",
                     name));
  };
  explain("friction_coefficient", contact.friction_coefficient);
  explain("contact_radius", contact.contact_radius);
  explain("compliance", contact.tangential_compliance);
  explain("equivalent_radius", contact.equivalent_radius);
  explain("maximum_pressure", contact.maximum_pressure);
  explain("mindlin_gross_slip_displacement", contact.gross_slip_displacement);
  if (contact.hertz) {
    explain("hertz_mindlin: gross_slip_displacement", contact.hertz->gross_slip_displacement);
    explain(
        "hertz_mindlin: measured_over_predicted: contact_radius, sigma and "
        "gross_slip_displacement",
        contact.hertz->sigma_over_hertz_mindlin);
  }
  for (const StiffnessTest& test : report.stiffness) {
    if (test.z) continue;
    warn("stiffness_not_tested",
         fmt::format("mapping: stiffness_tests: z, p_value and ci95 of the {} radius are null{}",
                     test.radius,
                     test.ratio.standard_error > 0
                         ? " and so is standard_error: the fit leaves sigma open"
                         : ": neither sigma nor an input is uncertain"));
  }
  if (report.stiffness.empty() || !std::isfinite(report.stiffness.front().ratio.standard_error)) {
    warn("no_standard_error",
         "mapping: sigma_over_hertz_mindlin_standard_error is null, as sigma has no standard error "
         "or there is no ratio");
  }
}

}  // namespace

Report MakeReport(ReportInput input) {
  Require(input);
  Report report;
  static_cast<ReportInput&>(report) = std::move(input);
  for (const FitWarning& warning : report.fit.warnings) {
    report.fit_warnings.push_back({warning.code, warning.message});
  }
  if (report.failed()) {
    report.fit_warnings.push_back(
        {"fit_failed", fmt::format("the fit failed, so no parameter, residual, loop, contact or "
                                   "mapping value was computed: {}",
                                   report.fit.termination)});
    return report;
  }
  report.loop = DescribeLoop(report.fit);
  report.alpha = TestAlpha(report.fit);
  const ParameterEstimate& alpha = *report.fit.Find("alpha");
  if (alpha.status == ParameterStatus::kFixed) {
    report.contact_warnings.push_back(
        {"alpha_not_tested",
         "mapping: alpha was held fixed, so alpha = 1/3 is not tested and "
         "alpha_minus_third, z and p_value are null; use --model "
         "mindlin-dahl without --fix alpha"});
  } else if (!report.alpha.z) {
    report.contact_warnings.push_back(
        {"alpha_not_tested",
         "mapping: alpha has no standard error (at a bound or undetermined), so alpha = 1/3 is not "
         "tested and z and p_value are null"});
  }
  report.contact = IdentifyFittedContact(report.fit, report.known);
  report.stiffness = TestStiffness(report.fit, report.contact);
  const bool compliance_is_missing = std::ranges::any_of(
      report.contact.unidentified,
      [](const std::string& sentence) { return sentence.starts_with("tangential compliance"); });
  if (!report.contact.tangential_compliance && !compliance_is_missing) {
    report.contact_warnings.push_back(
        {"compliance_taken_as_known",
         "contact: compliance is null: it is taken as known, and measured "
         "only where --contact-radius gives the radius"});
  }
  for (const std::string& sentence : report.contact.unidentified) {
    report.contact_warnings.push_back({"contact_not_identified", "contact: " + sentence});
  }
  for (const std::string& sentence : report.contact.redundant) {
    report.contact_warnings.push_back({"contact_redundant", "contact: " + sentence});
  }
  if (report.stiffness.empty()) {
    report.contact_warnings.push_back(
        {"stiffness_not_tested",
         "mapping: sigma_over_hertz_mindlin needs a contact radius known besides the fit: "
         "materials, "
         "radii and load of both bodies, or --contact-radius with --compliance or materials"});
  }
  if (!report.fit.WidestRecord().measures.energy_per_cycle) {
    report.contact_warnings.push_back(
        {"energy_not_measured",
         "loop: the record closes no cycle, so energy_per_cycle_measured is null and energy_ratio "
         "is the model's"});
  }
  if (!report.loop->gross_slip_displacement) {
    report.contact_warnings.push_back(
        {"no_gross_slip",
         "loop: with alpha >= 1 the force only approaches slip_force, so "
         "gross_slip_displacement is null"});
  }
  if (!report.loop->energy_ratio) {
    report.contact_warnings.push_back(
        {"no_energy_ratio",
         "loop: energy_ratio needs a force that differs between the extremes of the displacement"});
  }
  ExplainMissingErrors(report);
  return report;
}

}  // namespace mindahl::report
