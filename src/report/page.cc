#include "mindahl/report/page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "io/html.h"
#include "mindahl/report/units.h"
#include "report/adequacy.h"
#include "report/field_table.h"
#include "report/fields.h"
#include "report/names.h"
#include "report/page_parts.h"
#include "report/panels.h"
#include "report/statements.h"

namespace mindahl::report {

using contact::PropagatedValue;
using contact::UncertainValue;
using identification::AdequacyVerdict;
using identification::FitResult;
using identification::ParameterEstimate;

namespace {

constexpr const char* kNone = "–";

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

std::string VerdictSection(const Report& report) {
  // The sentence begins with the verdict itself.
  std::string sentence = VerdictSentence(report);
  const std::string word(VerdictWord(report));
  for (const char* end : {": ", ", "}) {
    if (sentence.starts_with(word + end)) sentence.erase(0, word.size() + 2);
  }
  if (!report.fit.converged) sentence = report.fit.solver.message;
  std::string html = VerdictBlock(CssClass(JudgementOf(word)), word, sentence);
  const std::string next = IsUnexplained(report) ? NextStep(report) : "";
  return next.empty() ? html : html + Paragraph("Next: " + next);
}

// --- parameters

std::string ParameterSection(const Report& report) {
  const std::string heading = ConfidenceWords(report.fit) + " interval";
  Table table("fitted and given parameters, with one standard error and the " + heading,
              {"parameter", "value", heading, "verdict"});
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
    table.Row(PlainName(estimate.name),
              {Number(value), Number(interval),
               Words(VerdictWords(estimate), CssClass(JudgementOf(estimate)))});
  }
  const FitResult& fit = report.fit;
  std::string about = fmt::format("{}; initial state {}", fit.model->title,
                                  fit.has_mixed_states() ? "mixed" : Name(fit.initial_state));
  if (fit.normal_load && fit.is_load_series()) {
    about += fmt::format("; sigma and slip_force are given at the mean load, {}",
                         Quantity(*fit.normal_load, "N"));
  }
  const std::string wide = WideIntervalStatement(fit, report.units);
  const std::string slip_forces = SlipForcesStatement(report);
  return Heading("Parameters") + Paragraph(about + ".") + table.Html() +
         (wide.empty() ? "" : Paragraph(wide + ".")) +
         (slip_forces.empty() ? "" : Paragraph(slip_forces + "."));
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
std::string NextSection(const Report& report, const Provenance& provenance) {
  const std::string command =
      provenance.command.empty() ? std::string("mindahl fit FILE") : provenance.command;
  std::string html;
  std::vector<std::string> said;
  const auto add = [&](std::string_view why, std::string_view option) {
    const std::string_view name = option.substr(0, option.find(' '));
    const bool is_given = std::ranges::any_of(
        provenance.options, [&](const auto& given) { return given.first == name; });
    if (is_given || std::ranges::find(said, option) != said.end()) return;
    said.emplace_back(option);
    html += Paragraph(why) + CommandBlock(fmt::format("{} {}", command, option));
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
  return html.empty() ? "" : SubHeading("What to try next") + html;
}

std::vector<std::string> MessagesOf(const std::vector<Warning>& warnings) {
  std::vector<std::string> messages;
  messages.reserve(warnings.size());
  for (const Warning& warning : warnings) {
    messages.push_back(fmt::format("{} [{}]", warning.message, warning.code));
  }
  return messages;
}

std::string WarningSection(const Report& report, const Provenance& provenance) {
  std::vector<std::string> warnings = MessagesOf(report.fit_warnings);
  if (!IsInadequate(report)) {
    for (std::string& message : MessagesOf(report.contact_warnings)) {
      warnings.push_back(std::move(message));
    }
  }
  const std::string next = NextSection(report, provenance);
  std::string html = Heading("Warnings and what to do");
  html += warnings.empty() ? Paragraph("No warning.") : SentenceList(warnings);
  std::vector<std::string> others;
  const std::vector<identification::Cause>& causes = report.fit.adequacy.causes;
  for (std::size_t i = 1; i < causes.size() && IsUnexplained(report); ++i) {
    others.push_back(Sentence(causes[i], report.fit.response));
  }
  if (!others.empty()) html += Paragraph("It may also be:") + SentenceList(others);
  html += next;
  if (!report.notes.empty()) html += SubHeading("Notes") + SentenceList(MessagesOf(report.notes));
  return html;
}

// --- what needs no model

/// Returns a value as people read it.
std::string TextOf(const DescribedValue& item) {
  if (item.value.is_number_float()) return Quantity(item.value.get<double>(), item.field.unit);
  if (item.value.is_boolean()) return item.value.get<bool>() ? "yes" : "no";
  return item.value.is_string() ? item.value.get<std::string>() : item.value.dump();
}

/// Adds the rows of the report's fields of one subject.
void AddFields(const Report& report, std::string_view prefix, Table& table,
               const std::vector<std::string_view>& without = {}) {
  for (const DescribedValue& item : ValuesUnder(report, prefix)) {
    const std::string text = TextOf(item);
    if (text.empty()) continue;
    if (std::ranges::find(without, item.field.path) != without.end()) continue;
    // "half_gap.value" of "measured.": what follows a subject is name enough in its table.
    const std::string name =
        prefix.ends_with('.') ? item.field.path.substr(prefix.size()) : item.field.path;
    table.Row(PlainName(name), {Number(text), Words(item.field.label)});
  }
}

std::string MeasuredSection(const Report& report) {
  std::string html = Heading("What the record says without a model");
  Table table("over the widest steady cycles", {"fact", "value", "what it is"});
  AddFields(report, "loop.amplitude", table);
  AddFields(report, "loop.peak_force", table);
  AddFields(report, "measured.", table, {"measured.closed"});
  html += table.Html();
  if (!report.fit.WidestRecord().facts.closed) {
    html += Paragraph("The record closes no cycle, so nothing was measured on one.");
  }
  html += SentenceList(TrendStatements(report.fit.WidestRecord().facts));
  const std::string memory = MemoryStatement(report);
  return memory.empty() ? html : html + Paragraph("Memory: " + memory + ".");
}

// --- figures

std::string Figure(const io::PlotPanel& panel, const char* id, std::string_view title,
                   std::string_view text) {
  return io::HtmlFigure(panel,
                        {.id = id, .title = std::string(title), .description = std::string(text)});
}

std::string Grid(const std::string& figures) {
  return figures.empty() ? "" : fmt::format("<div class=\"figures\">\n{}</div>\n", figures);
}

/// Makes what is seen first: the verdict and the parameters with the loop at their side.
std::string FirstScreen(const Report& report) {
  return "<div class=\"first\">\n<div>\n" + VerdictSection(report) + ParameterSection(report) +
         "</div>\n" +
         Figure(LoopPanel(report, PrefixedUnits(report), LoopColours::kByCycle), "loop",
                "Measured and fitted loop",
                "Where the line leaves the points, the model misses something; markers are where "
                "the motion was found to turn.") +
         "</div>\n";
}

std::string FigureSection(const Report& report) {
  const PanelUnits units = PrefixedUnits(report);
  std::string html = Heading("Residuals");
  std::string figures =
      Figure(ResidualAlongStroke(report, units, LoopColours::kByCycle), "residual-stroke",
             "Residual along the stroke",
             "A band without shape is noise; a shape that all cycles share is missing from the "
             "model.") +
      Figure(ResidualInTime(report, units), "residual-time", "Residual in time",
             "A slope is drift; a band that widens or narrows shows a contact that changes.") +
      Figure(ResidualDistribution(report, units), "residual-distribution",
             "Distribution of the residuals",
             "Bars outside the curve are readings far off: look for disturbances.");
  if (const auto panel = ResidualAutocorrelation(report)) {
    figures +=
        Figure(*panel, "residual-autocorrelation", "Autocorrelation of the residuals",
               "Values outside the band mean autocorrelated residuals and fewer effective samples; "
               "a peak a cycle apart is a shape that repeats.");
  }
  html += Grid(figures);
  Table table("residuals", {"figure", "value", "what it is"});
  std::vector<std::string_view> without;
  if (!IsShown(report.fit, "slip_force")) without.emplace_back("residuals.normalized_rms");
  AddFields(report, "residuals.", table, without);
  return html + table.Html();
}

std::string LikelihoodSection(const Report& report) {
  std::string figures;
  constexpr const char* kText =
      "The noise allows both parameters in this region; intervals may reach further, to include "
      "what the model misses. A long slanted region shows a combination that the record determines "
      "better.";
  if (const auto panel = RegionPanel(report, "sigma")) {
    figures += Figure(*panel, "region-sigma", "Stiffness and exponent together", kText);
  }
  if (const auto panel = RegionPanel(report, "slip_force")) {
    figures += Figure(*panel, "region-slip-force", "Slip force and exponent together", kText);
  }
  if (const auto panel = SlipForceLikelihood(report)) {
    figures +=
        Figure(*panel, "likelihood", "Likelihood of the slip force",
               "The record does not distinguish slip forces whose curve is below the line from the "
               "best one; on a side where the curve never rises the interval is open.");
  }
  return figures.empty() ? "" : Heading("Likelihood") + Grid(figures);
}

// --- the model's loop, the contact, the mapping

/// Returns "–" with why where the record leaves it open.
Cell ValueCell(const UncertainValue& value, std::string_view unit) {
  if (!std::isfinite(value.standard_error)) return Number("not identified");
  return Number(QuantityWithError(value.value, value.standard_error, unit));
}

std::string LoopSection(const Report& report) {
  const LoopDescription& loop = *report.loop;
  std::vector<std::string> sentences = {
      SlipStatement(loop, report.units),
      fmt::format("model energy per cycle {}", Quantity(loop.model_energy, "J"))};
  if (loop.gross_slip_energy_ratio) {
    sentences.back() +=
        fmt::format(", gross slip above an energy ratio of {:.4g}", *loop.gross_slip_energy_ratio);
  }
  const std::string law = LawStatement(report);
  if (!law.empty()) sentences.push_back("law: " + law);
  return Heading("Loop of the model") + SentenceList(sentences);
}

std::string HertzTable(const contact::HertzPrediction& hertz) {
  Table table("what Hertz and Mindlin predict from materials, radii and load",
              {"quantity", "predicted", "measured over predicted"});
  const auto row = [&](std::string_view name, const PropagatedValue& value, std::string_view unit,
                       const PropagatedValue& ratio) {
    table.Row(name, {ValueCell(value, unit), ValueCell(ratio, "-")});
  };
  row("contact radius a", hertz.contact_radius, "m", hertz.sigma_over_hertz_mindlin);
  row("tangential stiffness 8a/G*", hertz.tangential_stiffness, "N/m",
      hertz.sigma_over_hertz_mindlin);
  row("gross slip at α = 1/3", hertz.gross_slip_displacement, "m",
      hertz.gross_slip_displacement_ratio);
  return table.Html();
}

std::string ContactSection(const Report& report) {
  const contact::IdentifiedContact& contact = report.contact;
  std::string html = Heading("The contact");
  html += Paragraph(
      "By the Mindlin-Dahl mapping σ = 8a/G*, Tc = μN, with G* = (2−ν₁)/G₁ + (2−ν₂)/G₂ [1/Pa], a "
      "compliance: many texts write G* for its inverse.");
  Table table("the contact, from the fit and the known inputs",
              {"quantity", "value", "from", "contributions to its error"});
  for (const ContactField& field : ContactFields()) {
    const std::optional<PropagatedValue> value = field.get(report);
    if (!value) continue;
    if (!IsIdentified(report, field, *value)) {
      table.Row(field.label,
                {Number("not identified"), Number(std::string(field.formula)), Words("")});
      continue;
    }
    table.Row(field.label, {ValueCell(*value, field.unit), Number(std::string(field.formula)),
                            Words(VarianceStatement(*value))});
  }
  html += table.Html();
  const bool knows_stiffness = report.fit.Find("sigma")->is_known();
  if (contact.hertz && knows_stiffness) html += HertzTable(*contact.hertz);
  html += SentenceList(contact.redundant);
  std::vector<std::string> missing;
  missing.reserve(contact.unidentified.size());
  for (const std::string& sentence : contact.unidentified) {
    missing.push_back("not identified: " + sentence);
  }
  html += SentenceList(missing);

  html += SubHeading("Is it Mindlin's contact?");
  html += Paragraph(
      "Cattaneo and Mindlin's smooth spheres have α = 1/3 and σ = 8a/G*: each is a hypothesis, "
      "tested at the 5 % level.");
  std::vector<std::string> tests;
  if (IsShown(report.fit, "alpha")) tests = ExponentStatements(report);
  for (const StiffnessTest& test : report.stiffness) {
    if (!knows_stiffness || !std::isfinite(test.ratio.standard_error)) continue;
    for (std::string& statement : StiffnessStatements(test)) tests.push_back(std::move(statement));
  }
  if (tests.empty()) {
    tests.emplace_back(
        "not tested: alpha is fixed or not identified, and no radius is known apart from the fit");
  }
  return html + SentenceList(tests);
}

// --- comparisons

std::string SelectionSection(const Report& report) {
  if (!report.selection) return "";
  const identification::ModelSelection& selection = *report.selection;
  Table table(fmt::format("on {:.0f} effective samples; {}", selection.effective_samples,
                          selection.held_out_cycles > 0
                              ? fmt::format("and by predicting {} held-out cycles",
                                            selection.held_out_cycles)
                              : std::string("too few cycles to hold any out")),
              {"model", "free parameters", "rms", "ΔAICc", "weight", "held-out rms", "remark"});
  for (std::size_t i = 0; i < selection.scores.size(); ++i) {
    const identification::ModelScore& score = selection.scores[i];
    const bool is_listed =
        std::ranges::find(selection.indistinguishable, i) != selection.indistinguishable.end();
    std::string remark = score.remark;
    if (i == selection.chosen) {
      remark = remark.empty() ? "reported" : fmt::format("reported; {}", remark);
    } else if (is_listed) {
      remark = remark.empty() ? "not distinguished from it"
                              : fmt::format("not distinguished from it; {}", remark);
    }
    table.Row(fmt::format("{}{}", score.model->name, score.rig ? " + rig" : ""),
              {Number(std::to_string(score.free_parameters)),
               Number(Quantity(score.rms, report.units.force)),
               Number(std::isfinite(score.delta_aicc) ? fmt::format("{:.1f}", score.delta_aicc)
                                                      : std::string(kNone)),
               Number(fmt::format("{:.3f}", score.akaike_weight)),
               Number(score.held_out_rms
                          ? QuantityWithError(*score.held_out_rms, score.held_out_standard_error,
                                              report.units.force)
                          : std::string(kNone)),
               Words(remark)});
  }
  return Heading("Models compared") + table.Html() + Paragraph(selection.verdict);
}

std::string LoadSection(const Report& report) {
  if (!report.load_series || IsInadequate(report)) return "";
  const FitResult& fit = report.fit;
  const LoadSeries& series = *report.load_series;
  const auto known = [&](const UncertainValue& value, std::string_view parameter,
                         std::string_view unit) {
    return fit.Find(parameter)->is_known() ? ValueCell(value, unit) : Number(kNone);
  };
  Table table("σ ∝ N^p, Tc = μN, of the whole series",
              {"normal load", "σ", "Tc", "a = σG*/8", "a of Hertz"});
  for (const ContactUnderLoad& contact : series.contacts) {
    table.Row(
        Quantity(contact.normal_load, "N"),
        {known(contact.stiffness, "sigma", "N/m"), known(contact.slip_force, "slip_force", "N"),
         contact.contact_radius ? known(*contact.contact_radius, "sigma", "m") : Number(kNone),
         Number(contact.hertz_radius ? Quantity(*contact.hertz_radius, "m") : std::string(kNone))});
  }
  Table hypotheses("exponent of the load compared with theories",
                   {"theory", "p − predicted exponent", "standard errors", "p-value", ""});
  for (const LoadHypothesis& hypothesis : series.hypotheses) {
    if (!hypothesis.p_value) continue;
    const bool is_rejected = *hypothesis.p_value < kSignificance;
    hypotheses.Row(
        WordsOfHypothesis(hypothesis.name),
        {Number(fmt::format("{:.3g}", *hypothesis.difference)),
         Number(fmt::format("{:.2f}", *hypothesis.z)),
         Number(*hypothesis.p_value < 1e-12 ? std::string("< 1e-12")
                                            : fmt::format("{:.3g}", *hypothesis.p_value)),
         Words(is_rejected ? "rejected" : "tenable", is_rejected ? "bad" : "good")});
  }
  std::string laws;
  for (const LoadLaw& law : LawsToShow(series)) {
    Table table_of_law("the contact under this law",
                       {"quantity", "value", ConfidenceWords(report.fit) + " interval", "from",
                        "from the bodies", "contributions to its error"});
    for (const QuantityUnderLaw& quantity : law.quantities) {
      table_of_law.Row(quantity.label,
                       {ValueCell(quantity.value, quantity.unit), Number(IntervalWords(quantity)),
                        Number(std::string(quantity.formula)),
                        Number(quantity.predicted ? Quantity(*quantity.predicted, quantity.unit)
                                                  : std::string(kNone)),
                        Words(VarianceStatement(quantity.value))});
    }
    laws += Paragraph(LawHeading(law) + ".") + table_of_law.Html();
  }
  laws += SentenceList(LoadLawStatements(report));
  std::string figures;
  constexpr std::array kIds = {"load-stiffness", "load-slip-force"};
  const std::vector<io::PlotPanel> panels = LoadPanels(report, PrefixedUnits(report));
  for (std::size_t k = 0; k < panels.size(); ++k) {
    figures += Figure(
        panels[k], kIds.at(k), k == 0 ? "Stiffness and load" : "Slip force and load",
        "Each interval is of one file alone, fitted with the shape exponent of the whole series.");
  }
  return Heading("Under several loads") + table.Html() + hypotheses.Html() + laws + Grid(figures);
}

std::string BackboneSection(const Report& report) {
  const auto panel = BackbonePanel(report, PrefixedUnits(report));
  if (!panel) return "";
  return Heading("First loading without a law") +
         Grid(Figure(*panel, "backbone", "Force of first loading",
                     "Where the law leaves the band, the contact differs from it."));
}

std::string RecordSection(const Report& report) {
  Table table("the record as read", {"field", "value", "what it is"});
  AddFields(report, "input.", table);
  AddFields(report, "reversals.", table);
  return Heading("The record") + table.Html();
}

std::string FailedBody(const Report& report) {
  return VerdictBlock("bad", "failed", report.fit.solver.message) +
         Heading("Warnings and what to do") + SentenceList(MessagesOf(report.fit_warnings));
}

}  // namespace

std::string ToPage(const Report& report, const Provenance& provenance) {
  std::string body =
      fmt::format("<header><h1>{}</h1></header>\n<main>\n", io::HtmlText(TitleOf(report)));
  if (report.files.size() > 1) {
    body += Paragraph(fmt::format("{}", fmt::join(report.files, ", ")), "faint");
  }
  if (report.failed()) {
    body += FailedBody(report);
  } else {
    body += FirstScreen(report) + WarningSection(report, provenance) + MeasuredSection(report) +
            FigureSection(report);
    if (IsInadequate(report)) {
      body += Heading("The contact") +
              Paragraph("No contact is given: the model does not describe this record.");
    } else {
      body += LikelihoodSection(report) + LoopSection(report);
      body += report.is_torsional()
                  ? Heading("The contact") + Paragraph(std::string("No contact: ") + kWhyNoContact)
                  : ContactSection(report);
    }
    body += SelectionSection(report) + LoadSection(report) + BackboneSection(report) +
            RecordSection(report);
  }
  body += ReproduceSection(provenance) + "</main>\n";
  return io::HtmlPage(TitleOf(report), body);
}

}  // namespace mindahl::report
