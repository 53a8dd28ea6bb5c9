#include "cli/fit_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <limits>

#include "cli/json_output.h"
#include "mindahl/contact/cattaneo_mindlin.h"
#include "mindahl/core/version.h"
#include "mindahl/io/csv_writer.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::cli {

using contact::IdentifiedContact;
using contact::PropagatedValue;
using contact::UncertainValue;
using identification::FitResult;
using identification::Identifiability;
using identification::ParameterEstimate;
using identification::ParameterStatus;
using identification::RecordFit;
using io::PlotStyle;
using io::RecordFile;
using loop::LoopMeasures;
using loop::Record;

namespace {

/// As the contact module takes it: infinite where the fit leaves a parameter open.
UncertainValue Uncertain(const ParameterEstimate& estimate) {
  const bool known = estimate.status == ParameterStatus::kFixed;
  return {estimate.value,
          estimate.standard_error.value_or(known ? 0.0 : std::numeric_limits<double>::infinity())};
}

/// The contact's part of an amplitude that the rig shares in: X_c = X − T*(X_c)/k_r, the right side
/// falling in X_c.
double ContactAmplitude(const FitResult& fit, double amplitude) {
  if (std::isinf(fit.rig.stiffness)) return amplitude;
  double low = 0.0;
  double high = amplitude;
  constexpr int kBisections = 200;
  for (int i = 0; i < kBisections && high - low > 1e-15 * amplitude; ++i) {
    const double middle = low + (high - low) / 2;
    const double whole =
        middle + models::SteadyPeakForce(*fit.model, fit.law, middle) / fit.rig.stiffness;
    (whole < amplitude ? low : high) = middle;
  }
  return low + (high - low) / 2;
}

void DescribeLoop(FitReport& report) {
  const models::BranchLaw& law = report.fit.law;
  const LoopMeasures& measures = report.fit.WidestRecord().measures;
  const double contact_amplitude = ContactAmplitude(report.fit, measures.amplitude);
  report.model_energy = models::SteadyLoopEnergy(*report.fit.model, law, contact_amplitude);
  const double energy = measures.energy_per_cycle.value_or(*report.model_energy);
  if (measures.amplitude > 0 && measures.peak_force > 0) {
    report.energy_ratio = energy / (4 * measures.amplitude * measures.peak_force);
  }
  const double gross_slip = GrossSlipDisplacement(law);
  if (std::isfinite(gross_slip)) report.gross_slip_displacement = gross_slip;
  const double peak = models::SteadyPeakForce(*report.fit.model, law, contact_amplitude);
  // A law with α >= 1 never slips as a whole; within 1 % of Tc no record tells the difference.
  constexpr double kAsGoodAsSlip = 0.99;
  report.gross_slip = std::isfinite(gross_slip) ? contact_amplitude >= gross_slip
                                                : peak >= kAsGoodAsSlip * law.slip_force;
  report.stick_radius_ratio =
      report.gross_slip ? 0.0
                        : contact::StickRadiusRatio(std::min(peak, law.slip_force), law.slip_force);
}

void TestMapping(FitReport& report) {
  const ParameterEstimate& alpha = *report.fit.Find("alpha");
  if (alpha.status == ParameterStatus::kFixed) {
    report.warnings.push_back({"alpha_not_tested",
                               "mapping: alpha was held fixed, so alpha = 1/3 is not tested and "
                               "alpha_minus_third, z and p_value are null; use --model "
                               "mindlin-dahl without --fix alpha"});
    return;
  }
  report.alpha_minus_third = alpha.value - contact::kMindlinShapeExponent;
  if (!alpha.standard_error || !(*alpha.standard_error > 0)) {
    report.warnings.push_back(
        {"alpha_not_tested",
         "mapping: alpha has no standard error (at a bound or undetermined), so alpha = 1/3 is not "
         "tested and z and p_value are null"});
    return;
  }
  report.alpha_z = *report.alpha_minus_third / *alpha.standard_error;
  const boost::math::students_t distribution(report.fit.residuals.degrees_of_freedom);
  report.alpha_p_value =
      2 * boost::math::cdf(boost::math::complement(distribution, std::abs(*report.alpha_z)));
}

/// Of the errors of two parameters; 0 where the fit does not say.
double Correlation(const FitResult& fit, std::string_view first, std::string_view second) {
  const std::size_t count = fit.parameters.size();
  const auto place = [&](std::string_view name) {
    return static_cast<std::size_t>(fit.Find(name) - fit.parameters.data());
  };
  const double correlation = fit.correlation[place(first) * count + place(second)];
  return std::isfinite(correlation) ? std::clamp(correlation, -1.0, 1.0) : 0.0;
}

/// Measured against predicted σ: 1 where the theory holds.
struct StiffnessTest {
  std::string_view radius;  // whence the a of 8a/G*
  PropagatedValue ratio;
  std::optional<identification::Interval> interval95;
  std::optional<double> z;        // (ratio − 1)/SE
  std::optional<double> p_value;  // two-sided
};

StiffnessTest TestStiffness(std::string_view radius, const PropagatedValue& ratio,
                            double degrees_of_freedom) {
  StiffnessTest test;
  test.radius = radius;
  test.ratio = ratio;
  if (!(ratio.standard_error > 0) || std::isinf(ratio.standard_error)) return test;
  // Welch-Satterthwaite (GUM G.4.1): the inputs' uncertainties are taken as known for certain.
  const double share = ratio.FitShare();
  const boost::math::students_t distribution(share > 0 ? degrees_of_freedom / (share * share)
                                                       : std::numeric_limits<double>::infinity());
  constexpr double kUpperEnd = 0.975;
  const double half_width = boost::math::quantile(distribution, kUpperEnd) * ratio.standard_error;
  test.interval95 = {ratio.value - half_width, ratio.value + half_width};
  test.z = (ratio.value - 1) / ratio.standard_error;
  test.p_value = 2 * boost::math::cdf(boost::math::complement(distribution, std::abs(*test.z)));
  return test;
}

/// One for each radius that is known besides the fit, where G* is known too.
std::vector<StiffnessTest> TestStiffness(const FitReport& report) {
  std::vector<StiffnessTest> tests;
  const double degrees_of_freedom = report.fit.residuals.degrees_of_freedom;
  if (report.contact.hertz) {
    tests.push_back(
        TestStiffness("hertz", report.contact.hertz->sigma_over_hertz_mindlin, degrees_of_freedom));
  }
  if (report.contact.sigma_over_mindlin) {
    tests.push_back(TestStiffness("given", *report.contact.sigma_over_mindlin, degrees_of_freedom));
  }
  return tests;
}

void AddName(std::string& list, std::string_view name) {
  list += list.empty() ? "" : ", ";
  list += name;
}

/// A sentence for each standard error and interval that is null, and why.
void ExplainMissingErrors(FitReport& report) {
  const auto warn = [&](const char* code, std::string message) {
    report.warnings.push_back({code, std::move(message)});
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
  for (const StiffnessTest& test : TestStiffness(report)) {
    if (test.z) continue;
    warn("stiffness_not_tested",
         fmt::format("mapping: stiffness_tests: z, p_value and ci95 of the {} radius are null{}",
                     test.radius,
                     test.ratio.standard_error > 0
                         ? " and so is standard_error: the fit leaves sigma open"
                         : ": neither sigma nor an input is uncertain"));
  }
  if (!report.sigma_over_hertz_mindlin ||
      !std::isfinite(report.sigma_over_hertz_mindlin->standard_error)) {
    warn("no_standard_error",
         "mapping: sigma_over_hertz_mindlin_standard_error is null, as sigma has no standard error "
         "or there is no ratio");
  }
}

std::string_view Name(ParameterStatus status) {
  switch (status) {
    case ParameterStatus::kFree:
      return "free";
    case ParameterStatus::kFixed:
      return "fixed";
    case ParameterStatus::kAtLowerBound:
      return "at_lower_bound";
    case ParameterStatus::kAtUpperBound:
      return "at_upper_bound";
  }
  return "";
}

std::string_view Name(Identifiability identifiability) {
  switch (identifiability) {
    case Identifiability::kIdentifiable:
      return "identifiable";
    case Identifiability::kBoundedBelow:
      return "bounded_below";
    case Identifiability::kBoundedAbove:
      return "bounded_above";
    case Identifiability::kNotIdentifiable:
      return "not_identifiable";
  }
  return "";
}

std::string_view Name(models::InitialState state) {
  return state == models::InitialState::kVirgin ? "virgin" : "steady";
}

nlohmann::ordered_json ParametersJson(const FitResult& fit) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  if (fit.parameters.empty()) {  // the fit failed
    for (const auto& [name, unit] :
         {std::pair{"sigma", "N/m"}, {"alpha", "-"}, {"slip_force", "N"}}) {
      json[name] = {{"value", nullptr},
                    {"unit", unit},
                    {"standard_error", nullptr},
                    {"ci95", {nullptr, nullptr}},
                    {"status", Name(ParameterStatus::kFree)},
                    {"identifiability", Name(Identifiability::kNotIdentifiable)}};
    }
  }
  for (const ParameterEstimate& estimate : fit.parameters) {
    json[estimate.name] = {
        {"value", NumberOrNull(estimate.value)},
        {"unit", estimate.unit},
        {"standard_error", NumberOrNull(estimate.standard_error)},
        {"ci95", {NumberOrNull(estimate.lower95), NumberOrNull(estimate.upper95)}},
        {"status", Name(estimate.status)},
        {"identifiability", Name(estimate.identifiability)}};
  }
  return json;
}

nlohmann::ordered_json CorrelationJson(const FitResult& fit) {
  nlohmann::ordered_json json = nlohmann::ordered_json::object();
  const std::size_t count = fit.parameters.size();
  for (std::size_t i = 0; i < count; ++i) {
    if (fit.parameters[i].status == ParameterStatus::kFixed) continue;
    for (std::size_t j = 0; j < count; ++j) {
      if (fit.parameters[j].status == ParameterStatus::kFixed) continue;
      json[fit.parameters[i].name][fit.parameters[j].name] =
          NumberOrNull(fit.correlation[i * count + j]);
    }
  }
  return json;
}

nlohmann::ordered_json LawJson(const models::BranchLaw& law) {
  return {{"sigma", law.tangential_stiffness},
          {"alpha", law.shape_exponent},
          {"slip_force", law.slip_force}};
}

nlohmann::ordered_json SolverJson(const FitResult& fit) {
  nlohmann::ordered_json starts = nlohmann::ordered_json::array();
  for (const identification::StartReport& start : fit.starts) {
    starts.push_back({{"from", start.drawn ? "seed" : "grid"},
                      {"start", LawJson(start.start)},
                      {"initial_rms", NumberOrNull(start.initial_rms)},
                      {"reached", LawJson(start.reached)},
                      {"final_rms", NumberOrNull(start.final_rms)},
                      {"converged", start.converged}});
  }
  return {{"converged", fit.converged},
          {"iterations", fit.iterations},
          {"termination", fit.termination},
          {"starts", std::move(starts)}};
}

nlohmann::ordered_json InputJson(const FitReport& report) {
  std::size_t samples = 0;
  std::size_t cycles = 0;
  std::size_t reversals = 0;
  std::size_t left_out = 0;
  nlohmann::ordered_json gates = nlohmann::ordered_json::array();
  nlohmann::ordered_json noises = nlohmann::ordered_json::array();
  for (const RecordFile& input : report.inputs) samples += input.record.size();
  for (const RecordFit& record : report.fit.records) {
    cycles += record.measures.cycles;
    reversals += record.reversals.size();
    left_out += record.left_out;
    gates.push_back(record.reversal_gate);
    noises.push_back(record.displacement_noise);
  }
  const RecordFile& first = report.inputs.front();
  nlohmann::ordered_json units = {{"displacement", first.displacement.unit},
                                  {"force", first.force.unit}};
  if (first.time) units["time"] = first.time->unit;
  if (first.normal_load) units["normal_load"] = first.normal_load->unit;
  return {{"files", report.files},
          {"samples", samples},
          {"cycles", cycles},
          {"reversals", reversals},
          {"units", std::move(units)},
          {"left_out", left_out},
          {"reversal_gate", std::move(gates)},
          {"displacement_noise", std::move(noises)},
          {"force_sign", report.fit.force_sense > 0 ? "same" : "opposite"}};
}

nlohmann::ordered_json StructureJson(const FitResult& fit) {
  nlohmann::ordered_json records = nlohmann::ordered_json::array();
  for (const RecordFit& record : fit.records) {
    nlohmann::ordered_json directions = nlohmann::ordered_json::array();
    for (const identification::StrokeResiduals& direction : record.structure.directions) {
      nlohmann::ordered_json bins = nlohmann::ordered_json::array();
      for (const identification::StrokeBin& bin : direction.bins) {
        bins.push_back({{"position", bin.position},
                        {"mean", NumberOrNull(bin.mean)},
                        {"standard_error", NumberOrNull(bin.standard_error)}});
      }
      directions.push_back({{"direction", direction.direction > 0 ? "up" : "down"},
                            {"strokes", direction.strokes},
                            {"mean", NumberOrNull(direction.mean)},
                            {"rms", NumberOrNull(direction.rms)},
                            {"along_stroke", std::move(bins)}});
    }
    records.push_back({{"repeatable_share", record.structure.repeatable_share},
                       {"directions", std::move(directions)}});
  }
  return records;
}

nlohmann::ordered_json SelectionJson(const identification::ModelSelection& selection) {
  nlohmann::ordered_json scores = nlohmann::ordered_json::array();
  for (const identification::ModelScore& score : selection.scores) {
    scores.push_back({{"model", score.model->name},
                      {"rig", score.rig},
                      {"free_parameters", score.free_parameters},
                      {"rms", NumberOrNull(score.rms)},
                      {"aicc", NumberOrNull(score.aicc)},
                      {"delta_aicc", NumberOrNull(score.delta_aicc)},
                      {"akaike_weight", NumberOrNull(score.akaike_weight)},
                      {"held_out_rms", NumberOrNull(score.held_out_rms)},
                      {"held_out_standard_error", NumberOrNull(score.held_out_standard_error)},
                      {"converged", score.converged},
                      {"at_bound", score.at_bound},
                      {"redundant", score.redundant},
                      {"remark", score.remark}});
  }
  return {{"chosen", selection.chosen},
          {"indistinguishable", selection.indistinguishable},
          {"effective_samples", NumberOrNull(selection.effective_samples)},
          {"held_out_cycles", selection.held_out_cycles},
          {"verdict", selection.verdict},
          {"models", std::move(scores)}};
}

nlohmann::ordered_json BranchShapesJson(const FitResult& fit) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const identification::BranchShape& shape : fit.branch_shapes) {
    json.push_back({{"branch", shape.branch},
                    {"samples", shape.samples},
                    {"alpha", NumberOrNull(shape.shape_exponent)},
                    {"standard_error", NumberOrNull(shape.standard_error)}});
  }
  return json;
}

nlohmann::ordered_json ResidualsJson(const identification::ResidualStatistics& residuals) {
  const bool computed = residuals.samples > 0;
  const auto number = [computed](double value) -> nlohmann::ordered_json {
    return computed ? NumberOrNull(value) : nullptr;
  };
  return {{"rms", number(residuals.rms)},
          {"max_abs", number(residuals.max_abs)},
          {"normalized_rms", number(residuals.normalized_rms)},
          {"r_squared", number(residuals.r_squared)},
          {"durbin_watson", number(residuals.durbin_watson)},
          {"effective_samples", number(residuals.effective_samples)},
          {"degrees_of_freedom", number(residuals.degrees_of_freedom)}};
}

nlohmann::ordered_json PropagatedJson(const std::optional<PropagatedValue>& value,
                                      std::string_view unit) {
  if (!value) return nullptr;
  nlohmann::ordered_json json = {{"value", NumberOrNull(value->value)},
                                 {"standard_error", NumberOrNull(value->standard_error)},
                                 {"unit", unit},
                                 {"from_fit", value->FitShare()},
                                 {"from_inputs", value->InputShare()}};
  if (!value->largest_input.empty()) json["largest_input"] = value->largest_input;
  return json;
}

nlohmann::ordered_json SlipRegimeJson(const FitReport& report) {
  if (!report.model_energy) return nullptr;  // the fit failed
  return report.gross_slip ? "gross" : "partial";
}

nlohmann::ordered_json HertzJson(const contact::HertzPrediction& hertz) {
  nlohmann::ordered_json json;
  // All uncertainty of these is that of inputs.
  const auto add = [&](const std::string& name, const PropagatedValue& value) {
    json[name] = value.value;
    json[name + "_standard_error"] = NumberOrNull(value.standard_error);
  };
  add("contact_radius", hertz.contact_radius);
  add("sigma", hertz.tangential_stiffness);
  json["gross_slip_displacement"] = PropagatedJson(hertz.gross_slip_displacement, "m");
  add("equivalent_radius", hertz.equivalent_radius);
  add("maximum_pressure", hertz.maximum_pressure);
  json["measured_over_predicted"] = {
      {"contact_radius", PropagatedJson(hertz.sigma_over_hertz_mindlin, "-")},
      {"sigma", PropagatedJson(hertz.sigma_over_hertz_mindlin, "-")},
      {"gross_slip_displacement", PropagatedJson(hertz.gross_slip_displacement_ratio, "-")}};
  return json;
}

nlohmann::ordered_json ContactJson(const FitReport& report) {
  const IdentifiedContact& contact = report.contact;
  const bool failed = report.fit.parameters.empty();
  nlohmann::ordered_json json = {
      {"friction_coefficient", PropagatedJson(contact.friction_coefficient, "-")},
      {"contact_radius", PropagatedJson(contact.contact_radius, "m")},
      {"compliance", PropagatedJson(contact.tangential_compliance, "1/Pa")},
      {"compliance_definition", kComplianceDefinition},
      {"compliance_unit", kComplianceUnit},
      {"equivalent_radius", PropagatedJson(contact.equivalent_radius, "m")},
      {"maximum_pressure", PropagatedJson(contact.maximum_pressure, "Pa")},
      {"mindlin_gross_slip_displacement",
       failed ? nullptr : PropagatedJson(contact.gross_slip_displacement, "m")},
      {"normal_load", NumberOrNull(report.given_normal_load)}};
  if (contact.hertz) json["hertz_mindlin"] = HertzJson(*contact.hertz);
  return json;
}

nlohmann::ordered_json StiffnessTestsJson(const FitReport& report) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const StiffnessTest& test : TestStiffness(report)) {
    nlohmann::ordered_json one = {{"radius", test.radius}};
    one.update(PropagatedJson(test.ratio, "-"));
    one["ci95"] = {nullptr, nullptr};
    if (test.interval95) one["ci95"] = {test.interval95->lower, test.interval95->upper};
    one["z"] = NumberOrNull(test.z);
    one["p_value"] = NumberOrNull(test.p_value);
    json.push_back(std::move(one));
  }
  return json;
}

std::string Significant(double value) { return fmt::format("{:.6g}", value); }

std::string Bound(const std::optional<double>& value) {
  return value ? fmt::format("{:.5g}", *value) : "open";
}

/// Breaks a sentence between words at 100 columns; lines after the first are indented.
std::string Wrapped(std::string_view text, std::size_t indent) {
  constexpr std::size_t kColumns = 100;
  const auto width = [](std::string_view part) {
    return static_cast<std::size_t>(std::ranges::count_if(part, [](char byte) {
      return (static_cast<unsigned char>(byte) & 0xC0) != 0x80;  // of UTF-8: not a continuation
    }));
  };
  std::string wrapped;
  std::size_t column = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    // A word takes the blanks before it along.
    const std::size_t letter = std::min(text.find_first_not_of(' ', begin), text.size());
    const std::size_t end = std::min(text.find(' ', letter), text.size());
    const std::string_view word = text.substr(begin, end - begin);
    if (column > indent && column + width(word) > kColumns) {
      wrapped += '\n' + std::string(indent, ' ') + std::string(text.substr(letter, end - letter));
      column = indent + width(text.substr(letter, end - letter));
    } else {
      wrapped += word;
      column += width(word);
    }
    begin = end;
  }
  return wrapped + '\n';
}

std::string Words(Identifiability identifiability) {
  std::string words(Name(identifiability));
  std::ranges::replace(words, '_', ' ');
  return words;
}

std::string ParameterTable(const FitResult& fit) {
  std::string text;
  const auto row = [&](std::string_view name, std::string_view unit, std::string_view value,
                       std::string_view error, std::string_view interval,
                       std::string_view verdict) {
    text += fmt::format("{:<19} {:<4} {:>12} {:>9}  {:<24} {}\n", name, unit, value, error,
                        interval, verdict);
  };
  row("parameter", "unit", "value", "std error", "95 % interval", "verdict");
  for (const ParameterEstimate& estimate : fit.parameters) {
    if (estimate.status == ParameterStatus::kFixed) {
      row(estimate.name, estimate.unit, Significant(estimate.value), "-", "-", "fixed");
      continue;
    }
    std::string verdict = Words(estimate.identifiability);
    if (estimate.status != ParameterStatus::kFree) verdict += ", at bound";
    row(estimate.name, estimate.unit, Significant(estimate.value),
        estimate.standard_error ? fmt::format("{:.2g}", *estimate.standard_error) : "-",
        fmt::format("{} … {}", Bound(estimate.lower95), Bound(estimate.upper95)), verdict);
  }
  return text;
}

std::string ErrorText(const UncertainValue& value) {
  return std::isfinite(value.standard_error) ? fmt::format("± {:.2g}", value.standard_error)
                                             : "± open";
}

/// What to measure better; nothing where the inputs are exact and the fit alone is uncertain.
std::string SharesText(const PropagatedValue& value) {
  if (value.largest_input.empty()) return "";
  return fmt::format("  {:<22} variance: fit {:.0f} %, inputs {:.0f} %, mostly the {}\n", "",
                     100 * value.FitShare(), 100 * value.InputShare(), value.largest_input);
}

std::string HertzText(const contact::HertzPrediction& hertz) {
  std::string text = "  Hertz and Mindlin predict from materials, radii and load:\n";
  const auto line = [&](const char* name, const PropagatedValue& value, const char* unit,
                        const PropagatedValue& ratio) {
    text += fmt::format("  {:<22} {:>14} {:<10} {:<5} measured/predicted {} {}\n", name,
                        Significant(value.value), ErrorText(value), unit, Significant(ratio.value),
                        ErrorText(ratio));
  };
  line("contact radius", hertz.contact_radius, "m", hertz.sigma_over_hertz_mindlin);
  line("tangential stiffness", hertz.tangential_stiffness, "N/m", hertz.sigma_over_hertz_mindlin);
  line("gross slip (α = 1/3)", hertz.gross_slip_displacement, "m",
       hertz.gross_slip_displacement_ratio);
  return text;
}

std::string ContactText(const IdentifiedContact& contact) {
  std::string text =
      "  G* = (2−ν₁)/G₁ + (2−ν₂)/G₂ [1/Pa], a compliance: many texts write G* for its inverse\n";
  const auto line = [&](const char* name, const std::optional<PropagatedValue>& value,
                        const char* unit, const char* formula) {
    if (!value) return;
    text += fmt::format("  {:<22} {:>14} {:<10} {:<5} {}\n", name, Significant(value->value),
                        ErrorText(*value), unit, formula);
    text += SharesText(*value);
  };
  line("friction coefficient", contact.friction_coefficient, "", "μ = Tc/N");
  line("contact radius", contact.contact_radius, "m", "a = σG*/8");
  line("tangential compliance", contact.tangential_compliance, "1/Pa", "G* = 8a/σ");
  line("equivalent radius", contact.equivalent_radius, "m", "ρ = 4E*a³/(3N)");
  line("maximum pressure", contact.maximum_pressure, "Pa", "p₀ = 3N/(2πa²)");
  line("gross slip (α = 1/3)", contact.gross_slip_displacement, "m", "δc = 3Tc/(2σ)");
  if (contact.hertz) text += HertzText(*contact.hertz);
  for (const std::string& sentence : contact.redundant) {
    text += Wrapped(fmt::format("  {}", sentence), 4);
  }
  for (const std::string& sentence : contact.unidentified) {
    text += Wrapped(fmt::format("  not identified: {}", sentence), 18);
  }
  return text;
}

std::string BranchShapesText(const FitResult& fit) {
  std::string text;
  for (const identification::BranchShape& shape : fit.branch_shapes) {
    text += fmt::format("{}{} {:.4g} ± {:.2g}", text.empty() ? "  α branch by branch: " : ", ",
                        shape.branch, shape.shape_exponent, shape.standard_error);
  }
  return text.empty() ? text : Wrapped(text, 4);
}

std::string SelectionText(const identification::ModelSelection& selection) {
  std::string text =
      fmt::format("models compared on {:.0f} effective samples", selection.effective_samples);
  text += selection.held_out_cycles > 0
              ? fmt::format(", and by predicting {} held-out cycles:\n", selection.held_out_cycles)
              : "; too few cycles to hold any out:\n";
  text += fmt::format("  {:<22} {:>4} {:>11} {:>8} {:>7} {:>22}\n", "model", "free", "rms [N]",
                      "dAICc", "weight", "held-out rms [N]");
  for (std::size_t i = 0; i < selection.scores.size(); ++i) {
    const identification::ModelScore& score = selection.scores[i];
    const bool listed =
        std::ranges::find(selection.indistinguishable, i) != selection.indistinguishable.end();
    const std::string name = fmt::format("{}{}", score.model->name, score.rig ? " + rig" : "");
    text +=
        fmt::format("{} {:<22} {:>4} {:>11} {:>8} {:>7} {:>22}{}\n",
                    i == selection.chosen ? "*"
                    : listed              ? "="
                                          : " ",
                    name, score.free_parameters, fmt::format("{:.4g}", score.rms),
                    std::isfinite(score.delta_aicc) ? fmt::format("{:.1f}", score.delta_aicc) : "-",
                    fmt::format("{:.3f}", score.akaike_weight),
                    score.held_out_rms ? fmt::format("{:.4g} ± {:.2g}", *score.held_out_rms,
                                                     score.held_out_standard_error.value_or(0.0))
                                       : "-",
                    score.remark.empty() ? "" : "\n      " + score.remark);
  }
  return text + "  * reported, = not told from it\n" + Wrapped("  " + selection.verdict, 2) + "\n";
}

std::string SlipText(const FitReport& report) {
  if (report.gross_slip_displacement) {
    return fmt::format("{} slip (gross-slip displacement {:.5g} m)",
                       report.gross_slip ? "gross" : "partial", *report.gross_slip_displacement);
  }
  const double peak = models::SteadyPeakForce(
      *report.fit.model, report.fit.law,
      ContactAmplitude(report.fit, report.fit.WidestRecord().measures.amplitude));
  return fmt::format("{:.3g} % of Tc reached: with α >= 1 the force only approaches it",
                     100 * peak / report.fit.law.slip_force);
}

std::string MappingText(const FitReport& report) {
  std::string text;
  // Two-sided 5 %: the usual convention.
  constexpr double kSignificance = 0.05;
  const auto verdict = [](double p_value) {
    return p_value < kSignificance ? "rejected" : "tenable";
  };
  const auto& mindlin = report.fit.mindlin_test;
  // Of the two tests the likelihood ratio has the say: it needs no parabola.
  if (report.alpha_z) {
    text += fmt::format(
        "  α − 1/3 = {:.3g}, {:.2f} standard errors, p = {:.3g}{}\n", *report.alpha_minus_third,
        *report.alpha_z, *report.alpha_p_value,
        mindlin ? "" : fmt::format(": Mindlin's exponent is {}", verdict(*report.alpha_p_value)));
  }
  if (mindlin) {
    const std::string rig = mindlin->rig_stiffness
                                ? fmt::format(
                                      " for a rigid rig, but tenable with a rig of {:.4g} "
                                      "N/m in series: the record does not tell which",
                                      *mindlin->rig_stiffness)
                                : "";
    text += Wrapped(
        fmt::format("  likelihood ratio of α = 1/3: {:.3g}, p = {:.3g}: Mindlin's exponent is {}{}",
                    mindlin->likelihood_ratio, mindlin->p_value, verdict(mindlin->p_value), rig),
        6);
  }
  text += BranchShapesText(report.fit);
  for (const StiffnessTest& test : TestStiffness(report)) {
    text += fmt::format("  σ/(8a/G*) = {:.6g} {}: 1 where Hertz and Mindlin hold\n",
                        test.ratio.value, ErrorText(test.ratio));
    if (test.z) {
      text += fmt::format(
          "      with the a {}: 95 % {:.5g} … {:.5g}, {:.2f} standard errors from 1, p = {:.3g}: "
          "{}\n",
          test.radius == "hertz" ? "of Hertz" : "given", test.interval95->lower,
          test.interval95->upper, *test.z, *test.p_value, verdict(*test.p_value));
    }
    text += SharesText(test.ratio);
  }
  return text.empty() ? "  not tested: alpha is held, and no radius is known besides the fit\n"
                      : text;
}

bool IsUnderLoad(const FitReport& report, const Record& record, std::size_t sample) {
  if (!report.load_window) return true;
  const double load = record.normal_load[sample];
  return load >= report.load_window->lower && load <= report.load_window->upper;
}

}  // namespace

FitReport MakeFitReport(std::vector<std::string> files, std::vector<RecordFile> inputs,
                        FitResult fit, const contact::KnownContact& known) {
  FitReport report;
  report.files = std::move(files);
  report.inputs = std::move(inputs);
  report.fit = std::move(fit);
  report.warnings = report.fit.warnings;
  if (known.normal_load) report.given_normal_load = known.normal_load->value;
  if (report.fit.parameters.empty()) {
    report.warnings.push_back(
        {"fit_failed", fmt::format("the fit failed, so no parameter, residual, loop, contact or "
                                   "mapping value was computed: {}",
                                   report.fit.termination)});
    return report;
  }

  DescribeLoop(report);
  TestMapping(report);
  const ParameterEstimate& slip_force = *report.fit.Find("slip_force");
  report.contact =
      contact::IdentifyContact(Uncertain(*report.fit.Find("sigma")), Uncertain(slip_force), known,
                               Correlation(report.fit, "sigma", "slip_force"));
  if (slip_force.identifiability != Identifiability::kIdentifiable && known.normal_load) {
    report.contact.friction_coefficient.reset();
    report.contact.unidentified.push_back(fmt::format(
        "friction coefficient needs an identifiable slip force; from this loop it is at "
        "least {:.3g}",
        slip_force.lower95.value_or(0.0) / known.normal_load->value));
  }
  const bool compliance_is_missing = std::ranges::any_of(
      report.contact.unidentified,
      [](const std::string& sentence) { return sentence.starts_with("tangential compliance"); });
  if (!report.contact.tangential_compliance && !compliance_is_missing) {
    report.warnings.push_back({"compliance_taken_as_known",
                               "contact: compliance is null: it is taken as known, and measured "
                               "only where --contact-radius gives the radius"});
  }
  for (const std::string& sentence : report.contact.unidentified) {
    report.warnings.push_back({"contact_not_identified", "contact: " + sentence});
  }
  for (const std::string& sentence : report.contact.redundant) {
    report.warnings.push_back({"contact_redundant", "contact: " + sentence});
  }
  report.sigma_over_hertz_mindlin = report.contact.hertz
                                        ? report.contact.hertz->sigma_over_hertz_mindlin
                                        : report.contact.sigma_over_mindlin;
  if (!report.sigma_over_hertz_mindlin) {
    report.warnings.push_back(
        {"stiffness_not_tested",
         "mapping: sigma_over_hertz_mindlin needs a contact radius known besides the fit: "
         "materials, "
         "radii and load of both bodies, or --contact-radius with --compliance or materials"});
  }
  if (!report.fit.WidestRecord().measures.energy_per_cycle) {
    report.warnings.push_back(
        {"energy_not_measured",
         "loop: the record closes no cycle, so energy_per_cycle_measured is null and energy_ratio "
         "is the model's"});
  }
  if (!report.gross_slip_displacement) {
    report.warnings.push_back({"no_gross_slip",
                               "loop: with alpha >= 1 the force only approaches slip_force, so "
                               "gross_slip_displacement is null"});
  }
  if (!report.energy_ratio) {
    report.warnings.push_back(
        {"no_energy_ratio",
         "loop: energy_ratio needs a force that differs between the extremes of the displacement"});
  }
  ExplainMissingErrors(report);
  return report;
}

nlohmann::ordered_json ToJson(const FitReport& report) {
  const FitResult& fit = report.fit;
  nlohmann::ordered_json json = {{"schema", "mindahl.fit/1"},
                                 {"version", Version()},
                                 {"input", InputJson(report)},
                                 {"model", fit.model->name},
                                 {"initial_state", Name(fit.initial_state)},
                                 {"parameters", ParametersJson(fit)},
                                 {"correlation", CorrelationJson(fit)}};
  json["residuals"] = ResidualsJson(fit.residuals);
  json["residuals"]["force_noise"] = NumberOrNull(fit.force_noise);
  json["residuals"]["outliers"] = fit.outliers;
  json["residual_structure"] = StructureJson(fit);
  if (report.selection) json["model_selection"] = SelectionJson(*report.selection);
  json["solver"] = SolverJson(fit);
  const LoopMeasures& measures = fit.WidestRecord().measures;
  json["loop"] = {{"amplitude", measures.amplitude},
                  {"centre", measures.centre},
                  {"peak_force", measures.peak_force},
                  {"energy_per_cycle_measured", NumberOrNull(measures.energy_per_cycle)},
                  {"energy_per_cycle_model", NumberOrNull(report.model_energy)},
                  {"energy_ratio", NumberOrNull(report.energy_ratio)},
                  {"slip_regime", SlipRegimeJson(report)},
                  {"gross_slip_displacement", NumberOrNull(report.gross_slip_displacement)},
                  {"stick_radius_ratio", NumberOrNull(report.stick_radius_ratio)}};
  json["contact"] = ContactJson(report);
  json["mapping"] = {
      {"alpha_minus_third", NumberOrNull(report.alpha_minus_third)},
      {"z", NumberOrNull(report.alpha_z)},
      {"p_value", NumberOrNull(report.alpha_p_value)},
      {"likelihood_ratio",
       fit.mindlin_test ? NumberOrNull(fit.mindlin_test->likelihood_ratio) : nullptr},
      {"likelihood_ratio_p_value",
       fit.mindlin_test ? NumberOrNull(fit.mindlin_test->p_value) : nullptr},
      {"tenable_with_rig_stiffness",
       fit.mindlin_test ? NumberOrNull(fit.mindlin_test->rig_stiffness) : nullptr},
      {"alpha_by_branch", BranchShapesJson(fit)},
      {"sigma_over_hertz_mindlin", report.sigma_over_hertz_mindlin
                                       ? NumberOrNull(report.sigma_over_hertz_mindlin->value)
                                       : nullptr},
      {"sigma_over_hertz_mindlin_standard_error",
       report.sigma_over_hertz_mindlin
           ? NumberOrNull(report.sigma_over_hertz_mindlin->standard_error)
           : nullptr},
      {"stiffness_tests", StiffnessTestsJson(report)}};
  json["warnings"] = nlohmann::ordered_json::array();
  for (const identification::FitWarning& warning : report.warnings) {
    json["warnings"].push_back({{"code", warning.code}, {"message", warning.message}});
  }
  return json;
}

std::string ToText(const FitReport& report) {
  const FitResult& fit = report.fit;
  const RecordFit& widest = fit.WidestRecord();
  std::size_t samples = 0;
  std::size_t reversals = 0;
  std::size_t cycles = 0;
  std::size_t left_out = 0;
  for (const RecordFit& record : fit.records) {
    samples += record.residual.size();
    reversals += record.reversals.size();
    cycles += record.measures.cycles;
    left_out += record.left_out;
  }
  std::string text = report.selection ? SelectionText(*report.selection) : std::string();
  text += fmt::format(
      "{}, {} initial state: {}\n{} samples, {} reversals (gate {:.3g} m), {} cycles; force {} the "
      "displacement's sense\n",
      fit.model->title, Name(fit.initial_state), fit.converged ? "converged" : "NOT CONVERGED",
      samples, reversals, widest.reversal_gate, cycles, fit.force_sense > 0 ? "in" : "against");
  if (!fit.converged) text += Wrapped("not converged: " + fit.termination, 2);
  if (left_out > 0) text += fmt::format("{} samples left out of the fit\n", left_out);
  text += "\n" + ParameterTable(fit);
  for (const identification::FitWarning& warning : fit.warnings) {
    if (warning.code == "no_model_fits") text += "\n" + Wrapped(warning.message, 2);
  }
  const identification::ResidualStatistics& residuals = fit.residuals;
  text += fmt::format(
      "\nresiduals: rms {:.4g} N ({:.3g} % of Tc), largest {:.4g} N, R² {:.6f}, Durbin-Watson "
      "{:.2f},\n           {:.0f} effective samples of {}\n",
      residuals.rms, 100 * residuals.normalized_rms, residuals.max_abs, residuals.r_squared,
      residuals.durbin_watson, residuals.effective_samples, samples - left_out);
  double repeatable = 0.0;
  for (const RecordFit& record : fit.records) {
    repeatable = std::max(repeatable, record.structure.repeatable_share);
  }
  if (repeatable > 0) {
    text += fmt::format("           {:.0f} % of their variance comes back in every stroke\n",
                        100 * repeatable);
  }
  if (widest.displacement_noise > 0) {
    text += fmt::format("           noise of the displacement {:.3g} m, weighed in\n",
                        widest.displacement_noise);
  }
  if (fit.outliers > 0) {
    text += fmt::format("           {} outliers count less than half\n", fit.outliers);
  }
  const LoopMeasures& measures = widest.measures;
  text += fmt::format("\nloop: X = {:.5g} m, T* = {:.5g} N, {}\n", measures.amplitude,
                      measures.peak_force, SlipText(report));
  text += fmt::format(
      "      energy per cycle {} J measured, {:.5g} J model\n",
      measures.energy_per_cycle ? fmt::format("{:.5g}", *measures.energy_per_cycle) : "not",
      *report.model_energy);
  if (report.energy_ratio) {
    text += fmt::format("      energy ratio {:.4g}{}\n", *report.energy_ratio,
                        report.gross_slip_displacement
                            ? fmt::format(", gross slip from {:.4g}",
                                          models::GrossSlipEnergyRatio(fit.law.shape_exponent))
                            : "");
  }
  text += "\ncontact (Mindlin-Dahl mapping σ = 8a/G*, Tc = μN):\n" + ContactText(report.contact);
  text += "\nis it Mindlin's contact?\n" + MappingText(report);
  return text;
}

io::Plot ToPlot(const FitReport& report) {
  io::Plot plot;
  const ParameterEstimate& sigma = *report.fit.Find("sigma");
  const ParameterEstimate& alpha = *report.fit.Find("alpha");
  const ParameterEstimate& slip_force = *report.fit.Find("slip_force");
  plot.title = fmt::format("{}: σ = {:.4g} N/m, α = {:.4g}, Tc = {:.4g} N", report.fit.model->name,
                           sigma.value, alpha.value, slip_force.value);
  double extent = 0.0;
  for (const RecordFit& fit : report.fit.records) {
    extent = std::max(extent, std::abs(fit.measures.centre) + fit.measures.amplitude);
  }
  const auto [unit, per_unit] = extent < 1e-6   ? std::pair{"nm", 1e9}
                                : extent < 1e-3 ? std::pair{"µm", 1e6}
                                : extent < 1    ? std::pair{"mm", 1e3}
                                                : std::pair{"m", 1.0};
  const double factor = per_unit;
  const auto scaled = [factor](std::vector<double> values) {
    for (double& value : values) value *= factor;
    return values;
  };
  io::PlotPanel loop{.x_label = "", .y_label = "force [N]", .series = {}, .height = 2.5};
  io::PlotPanel residual{.x_label = fmt::format("displacement [{}]", unit),
                         .y_label = "fitted − measured [N]",
                         .series = {}};
  for (std::size_t r = 0; r < report.fit.records.size(); ++r) {
    const RecordFit& fit = report.fit.records[r];
    const Record& record = report.inputs[r].record;
    const std::string suffix =
        report.files.size() > 1 ? fmt::format(" {}", report.files[r]) : std::string();
    loop.series.push_back(
        {"measured" + suffix, scaled(record.displacement), record.force, PlotStyle::kPoints});
    loop.series.push_back(
        {"fitted" + suffix, scaled(record.displacement), fit.fitted_force, PlotStyle::kLine});
    // What the load window leaves out would squeeze the rest together.
    io::PlotSeries& shown =
        residual.series.emplace_back(io::PlotSeries{"", {}, {}, PlotStyle::kPoints});
    for (std::size_t i = 0; i < record.size(); ++i) {
      if (!IsUnderLoad(report, record, i)) continue;
      shown.x.push_back(factor * record.displacement[i]);
      shown.y.push_back(fit.residual[i]);
    }
  }
  plot.panels = {std::move(loop), std::move(residual)};
  return plot;
}

std::string ResidualsCsv(const FitReport& report) {
  std::vector<double> file;
  std::vector<double> time;
  std::vector<double> displacement;
  std::vector<double> force;
  std::vector<double> fitted;
  std::vector<double> residual;
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  bool timed = true;
  for (std::size_t r = 0; r < report.inputs.size(); ++r) {
    const Record& record = report.inputs[r].record;
    timed = timed && !record.time.empty();
    file.insert(file.end(), record.size(), static_cast<double>(r + 1));
    append(time, record.time);
    append(displacement, record.displacement);
    append(force, record.force);
    append(fitted, report.fit.records[r].fitted_force);
    append(residual, report.fit.records[r].residual);
  }
  std::vector<io::CsvColumn> columns;
  if (report.inputs.size() > 1) columns.push_back({"file", file});
  if (timed) columns.push_back({"time [s]", time});
  columns.push_back({"displacement [m]", displacement});
  columns.push_back({"force [N]", force});
  columns.push_back({"fitted_force [N]", fitted});
  columns.push_back({"residual [N]", residual});
  return io::CsvText(columns);
}

}  // namespace mindahl::cli
