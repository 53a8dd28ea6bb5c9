#include "mindahl/report/page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>
#include <utility>

#include "mindahl/report/units.h"
#include "report/adequacy.h"
#include "report/field_table.h"
#include "report/fields.h"
#include "report/names.h"
#include "report/panels.h"
#include "report/statements.h"
#include "report/template.h"

// Makes the data of templates/fit.html.
namespace mindahl::report {

using contact::PropagatedValue;
using contact::UncertainValue;
using identification::AdequacyVerdict;
using identification::FitResult;
using identification::ParameterEstimate;

namespace {

const std::string kNone = "–";

bool IsInadequate(const Report& report) {
  return report.fit.adequacy.verdict == AdequacyVerdict::kInadequate;
}

/// False for what is not known, of which no number is shown.
bool IsShown(const FitResult& fit, std::string_view parameter) {
  const ParameterEstimate* const estimate = fit.Find(parameter);
  return estimate != nullptr &&
         (WhatIsShown(*estimate) == Shown::kValue || WhatIsShown(*estimate) == Shown::kHeld);
}

/// True if the model misses something, whose causes were tried.
bool IsUnexplained(const Report& report) {
  return IsJudged(report) && report.fit.adequacy.verdict != AdequacyVerdict::kAdequate;
}

// --- the verdict

Json Verdict(const Report& report) {
  // The sentence begins with the verdict itself.
  const std::string word(VerdictWord(report));
  std::string sentence = report.fit.converged ? VerdictSentence(report) : report.fit.solver.message;
  for (const char* end : {": ", ", "}) {
    if (report.fit.converged && sentence.starts_with(word + end))
      sentence.erase(0, word.size() + 2);
  }
  return VerdictData(CssClass(JudgementOf(word)), word, sentence);
}

// --- parameters

Json ParameterRows(const Report& report) {
  Json rows = Json::array();
  for (const ParameterEstimate& estimate : report.fit.parameters) {
    const Shown shown = WhatIsShown(estimate);
    const double magnitude =
        shown == Shown::kLowerLimit
            ? estimate.lower95.value_or(0.0)
            : std::max(std::abs(estimate.value), estimate.standard_error.value_or(0.0));
    const ScaledUnit unit = UnitFor(estimate.unit, magnitude);
    std::string value = kNone;
    std::string interval = kNone;
    if (shown == Shown::kHeld) value = NumberWithError(estimate.value, std::nullopt, unit.factor);
    if (shown == Shown::kLowerLimit && estimate.lower95) {
      value = "> " + NumberWithError(*estimate.lower95, std::nullopt, unit.factor);
    }
    if (shown == Shown::kValue) {
      value = NumberWithError(estimate.value, estimate.standard_error, unit.factor);
      interval = IntervalText(estimate.lower95, estimate.upper95, unit.factor);
    }
    if (value != kNone && !unit.name.empty()) value += " " + unit.name;
    rows.push_back({{"name", PlainName(estimate.name)},
                    {"value", value},
                    {"interval", interval},
                    {"verdict", VerdictWords(estimate)},
                    {"class", CssClass(JudgementOf(estimate))}});
  }
  return rows;
}

// --- what to do

/// Pairs a finding with an option that it asks to be added to the command.
struct NextCommand {
  identification::FindingCode finding;
  std::string_view option;
  std::string_view why;
};

constexpr std::array kNextCommands = {
    NextCommand{"systematic_residual", "--model auto", "Compares the laws on this record:"},
    NextCommand{"no_model_fits", "--model auto", "Compares the laws on this record:"},
    NextCommand{"shape_or_rig", "--rig-stiffness fit", "Tests whether the rig is compliant:"},
};

/// Lists the commands to run next, each after its purpose.
Json Commands(const Report& report, const Provenance& provenance) {
  const std::string command =
      provenance.command.empty() ? std::string("mindahl fit FILE") : provenance.command;
  Json rows = Json::array();
  std::vector<std::string> said;
  const auto add = [&](std::string_view why, std::string_view option) {
    const std::string_view name = option.substr(0, option.find(' '));
    const bool is_given = std::ranges::any_of(
        provenance.options, [&](const auto& given) { return given.first == name; });
    if (is_given || std::ranges::find(said, option) != said.end()) return;
    said.emplace_back(option);
    rows.push_back({{"why", why}, {"command", fmt::format("{} {}", command, option)}});
  };
  const FitResult& fit = report.fit;
  if (IsUnexplained(report)) {
    for (const identification::Cause& cause : fit.adequacy.causes) {
      if (cause.option.empty()) continue;
      add(fmt::format("Adds a term that explains {:.0f} % of the misfit:", 100 * cause.explains),
          cause.option);
    }
  }
  for (const NextCommand& row : kNextCommands) {
    // Models and rigs are tried on forces.
    if (fit.response == loop::Channel::kDisplacement) break;
    if (fit.FindFinding(row.finding) != nullptr) add(row.why, row.option);
  }
  return rows;
}

std::vector<std::string> MessagesOf(const std::vector<Warning>& warnings) {
  std::vector<std::string> messages;
  messages.reserve(warnings.size());
  for (const Warning& warning : warnings) {
    messages.push_back(fmt::format("{} [{}]", warning.message, warning.code));
  }
  return messages;
}

std::vector<std::string> WarningsOf(const Report& report) {
  std::vector<std::string> warnings = MessagesOf(report.fit_warnings);
  if (report.failed() || IsInadequate(report)) return warnings;
  for (std::string& message : MessagesOf(report.contact_warnings)) {
    warnings.push_back(std::move(message));
  }
  return warnings;
}

/// Lists the causes after the first, which the verdict names.
std::vector<std::string> OtherCauses(const Report& report) {
  std::vector<std::string> others;
  const std::vector<identification::Cause>& causes = report.fit.adequacy.causes;
  for (std::size_t i = 1; i < causes.size() && IsUnexplained(report); ++i) {
    others.push_back(Sentence(causes[i], report.fit.response));
  }
  return others;
}

// --- what needs no model

/// Returns a value as people read it.
std::string TextOf(const DescribedValue& item) {
  if (item.value.is_number_float()) return Quantity(item.value.get<double>(), item.field.unit);
  if (item.value.is_boolean()) return item.value.get<bool>() ? "yes" : "no";
  return item.value.is_string() ? item.value.get<std::string>() : item.value.dump();
}

/// Lists the report's fields of one subject.
Json Fields(const Report& report, const Json& document, std::string_view prefix,
            std::string_view without = {}) {
  Json rows = Json::array();
  for (const DescribedValue& item : ValuesUnder(report, document, prefix)) {
    const std::string text = TextOf(item);
    if (text.empty() || item.field.path == without) continue;
    // "half_gap.value" of "measured.": what follows a subject is name enough in its table.
    const std::string name =
        prefix.ends_with('.') ? item.field.path.substr(prefix.size()) : item.field.path;
    rows.push_back({{"name", PlainName(name)}, {"value", text}, {"what", item.field.label}});
  }
  return rows;
}

/// Joins lists.
template <typename... Lists>
Json Joined(Json rows, const Lists&... more) {
  (rows.insert(rows.end(), more.begin(), more.end()), ...);
  return rows;
}

// --- figures

/// Returns a figure as a member of the page's data, by its id.
Json Figure(const std::string& id, const std::optional<io::PlotPanel>& panel) {
  return Json::array({id, FigureData(panel, id)});
}

Json Likelihoods(const Report& report) {
  auto sigma = RegionPanel(report, "sigma");
  auto slip_force = RegionPanel(report, "slip_force");
  auto likelihood = SlipForceLikelihood(report);
  if (!sigma && !slip_force && !likelihood) return {};
  return {Figure("region-sigma", sigma), Figure("region-slip-force", slip_force),
          Figure("likelihood", likelihood)};
}

// --- the model's loop, the contact, the mapping

/// Returns a value with its error, or that the record leaves it open.
std::string ValueText(const UncertainValue& value, std::string_view unit) {
  if (!std::isfinite(value.standard_error)) return "not identified";
  return QuantityWithError(value.value, value.standard_error, unit);
}

Json ModelLoop(const Report& report) {
  const LoopDescription& loop = *report.loop;
  return {
      {"slip", SlipStatement(loop, report.units)},
      {"energy", Quantity(loop.model_energy, "J")},
      {"gross_slip_ratio",
       loop.gross_slip_energy_ratio ? fmt::format("{:.4g}", *loop.gross_slip_energy_ratio) : ""},
      {"law", LawStatement(report)}};
}

Json Hertz(const contact::HertzPrediction& hertz) {
  return {{"contact_radius", ValueText(hertz.contact_radius, "m")},
          {"tangential_stiffness", ValueText(hertz.tangential_stiffness, "N/m")},
          {"stiffness_ratio", ValueText(hertz.sigma_over_hertz_mindlin, "-")},
          {"gross_slip_displacement", ValueText(hertz.gross_slip_displacement, "m")},
          {"displacement_ratio", ValueText(hertz.gross_slip_displacement_ratio, "-")}};
}

std::vector<std::string> ContactTests(const Report& report) {
  std::vector<std::string> tests;
  if (IsShown(report.fit, "alpha")) tests = ExponentStatements(report);
  for (const StiffnessTest& test : report.stiffness) {
    if (!report.fit.Find("sigma")->is_known() || !std::isfinite(test.ratio.standard_error))
      continue;
    for (std::string& statement : StiffnessStatements(test)) tests.push_back(std::move(statement));
  }
  return tests;
}

Json Contact(const Report& report) {
  const contact::IdentifiedContact& contact = report.contact;
  Json rows = Json::array();
  for (const ContactField& field : ContactFields()) {
    const std::optional<PropagatedValue> value = field.get(report);
    if (!value) continue;
    const bool is_identified = IsIdentified(report, field, *value);
    rows.push_back({{"name", field.label},
                    {"value", is_identified ? ValueText(*value, field.unit) : "not identified"},
                    {"formula", field.formula},
                    {"contributions", is_identified ? VarianceStatement(*value) : ""}});
  }
  const bool has_hertz = contact.hertz && report.fit.Find("sigma")->is_known();
  return {{"quantities", std::move(rows)},
          {"hertz", has_hertz ? Hertz(*contact.hertz) : Json()},
          {"redundant", contact.redundant},
          {"unidentified", contact.unidentified},
          {"tests", ContactTests(report)}};
}

// --- comparisons

Json Selection(const Report& report) {
  if (!report.selection) return {};
  const identification::ModelSelection& selection = *report.selection;
  Json rows = Json::array();
  for (std::size_t i = 0; i < selection.scores.size(); ++i) {
    const identification::ModelScore& score = selection.scores[i];
    const bool is_listed =
        std::ranges::find(selection.indistinguishable, i) != selection.indistinguishable.end();
    std::string remark = i == selection.chosen ? "reported"
                         : is_listed           ? "not distinguished from it"
                                               : "";
    if (!score.remark.empty()) remark += (remark.empty() ? "" : "; ") + score.remark;
    rows.push_back(
        {{"name", fmt::format("{}{}", score.model->name, score.rig ? " + rig" : "")},
         {"free_parameters", score.free_parameters},
         {"rms", Quantity(score.rms, report.units.force)},
         {"delta_aicc",
          std::isfinite(score.delta_aicc) ? fmt::format("{:.1f}", score.delta_aicc) : kNone},
         {"weight", fmt::format("{:.3f}", score.akaike_weight)},
         {"held_out_rms", score.held_out_rms
                              ? QuantityWithError(*score.held_out_rms,
                                                  score.held_out_standard_error, report.units.force)
                              : kNone},
         {"remark", remark}});
  }
  const auto cycles = selection.held_out_cycles;
  return {{"effective_samples", fmt::format("{:.0f}", selection.effective_samples)},
          {"held_out_cycles", cycles > 0 ? Json(cycles) : Json()},
          {"models", std::move(rows)},
          {"conclusion", selection.verdict}};
}

Json Loads(const Report& report) {
  if (!report.load_series || IsInadequate(report)) return {};
  const LoadSeries& series = *report.load_series;
  const auto known = [&](const UncertainValue& value, std::string_view parameter,
                         std::string_view unit) {
    return report.fit.Find(parameter)->is_known() ? ValueText(value, unit) : kNone;
  };
  Json contacts = Json::array();
  for (const ContactUnderLoad& contact : series.contacts) {
    contacts.push_back(
        {{"load", Quantity(contact.normal_load, "N")},
         {"stiffness", known(contact.stiffness, "sigma", "N/m")},
         {"slip_force", known(contact.slip_force, "slip_force", "N")},
         {"radius", contact.contact_radius ? known(*contact.contact_radius, "sigma", "m") : kNone},
         {"hertz_radius", contact.hertz_radius ? Quantity(*contact.hertz_radius, "m") : kNone}});
  }
  Json hypotheses = Json::array();
  for (const LoadHypothesis& hypothesis : series.hypotheses) {
    if (!hypothesis.p_value) continue;
    const double p = *hypothesis.p_value;
    hypotheses.push_back({{"theory", WordsOfHypothesis(hypothesis.name)},
                          {"difference", fmt::format("{:.3g}", *hypothesis.difference)},
                          {"z", fmt::format("{:.2f}", *hypothesis.z)},
                          {"p_value", p < 1e-12 ? "< 1e-12" : fmt::format("{:.3g}", p)},
                          {"is_rejected", p < kSignificance}});
  }
  Json laws = Json::array();
  for (const LoadLaw& law : LawsToShow(series)) {
    Json rows = Json::array();
    for (const QuantityUnderLaw& quantity : law.quantities) {
      rows.push_back(
          {{"name", quantity.label},
           {"value", ValueText(quantity.value, quantity.unit)},
           {"interval", IntervalWords(quantity)},
           {"formula", quantity.formula},
           {"predicted", quantity.predicted ? Quantity(*quantity.predicted, quantity.unit) : kNone},
           {"contributions", VarianceStatement(quantity.value)}});
    }
    laws.push_back({{"heading", LawHeading(law)}, {"quantities", std::move(rows)}});
  }
  const PanelUnits units = PrefixedUnits(report);
  return {{"contacts", std::move(contacts)},
          {"hypotheses", std::move(hypotheses)},
          {"laws", std::move(laws)},
          {"statements", LoadLawStatements(report)},
          Figure("load-stiffness", LoadPanel(report, units, OverLoad::kStiffness)),
          Figure("load-slip-force", LoadPanel(report, units, OverLoad::kSlipForce))};
}

Json Fitted(const Report& report, const Provenance& provenance) {
  const FitResult& fit = report.fit;
  const PanelUnits units = PrefixedUnits(report);
  const loop::LoopFacts& facts = fit.WidestRecord().facts;
  const bool inadequate = IsInadequate(report);
  const Json document = JsonDocument(report);
  const auto fields = [&](std::string_view prefix, std::string_view without = {}) {
    return Fields(report, document, prefix, without);
  };
  const bool has_contact = !inadequate && !report.is_torsional();
  return {
      {"next", IsUnexplained(report) ? NextStep(report) : ""},
      {"model", fit.model->title},
      {"initial_state", fit.has_mixed_states() ? "mixed" : Name(fit.initial_state)},
      {"mean_load", fit.normal_load && fit.is_load_series() ? Quantity(*fit.normal_load, "N") : ""},
      {"confidence", ConfidenceWords(fit)},
      {"parameters", ParameterRows(report)},
      {"wide_interval", WideIntervalStatement(fit, report.units)},
      {"slip_forces", SlipForcesStatement(report)},
      Figure("loop", LoopPanel(report, units, LoopColours::kByCycle)),
      {"other_causes", OtherCauses(report)},
      {"commands", Commands(report, provenance)},
      {"notes", MessagesOf(report.notes)},
      {"measured", Joined(fields("loop.amplitude"), fields("loop.peak_force"),
                          fields("measured.", "measured.closed"))},
      {"closed", facts.closed},
      {"trends", TrendStatements(facts)},
      Figure("residual-stroke", ResidualAlongStroke(report, units, LoopColours::kByCycle)),
      Figure("residual-time", ResidualInTime(report, units)),
      Figure("residual-distribution", ResidualDistribution(report, units)),
      Figure("residual-autocorrelation", ResidualAutocorrelation(report)),
      {"residuals",
       fields("residuals.", IsShown(fit, "slip_force") ? "" : "residuals.normalized_rms")},
      {"inadequate", inadequate},
      {"likelihoods", inadequate ? Json() : Likelihoods(report)},
      {"model_loop", inadequate ? Json() : ModelLoop(report)},
      {"why_no_contact", !inadequate && report.is_torsional() ? kWhyNoContact : ""},
      {"contact", has_contact ? Contact(report) : Json()},
      {"selection", Selection(report)},
      {"loads", Loads(report)},
      {"record", Joined(fields("input."), fields("reversals."))}};
}

}  // namespace

std::string ToPage(const Report& report, const Provenance& provenance) {
  const bool has_many = report.files.size() > 1;
  return RenderPage("fit",
                    {{"title", TitleOf(report)},
                     {"files", has_many ? fmt::format("{}", fmt::join(report.files, ", ")) : ""},
                     {"verdict", Verdict(report)},
                     {"warnings", WarningsOf(report)},
                     {"fitted", report.failed() ? Json() : Fitted(report, provenance)},
                     {"provenance", ProvenanceData(provenance)}});
}

}  // namespace mindahl::report
