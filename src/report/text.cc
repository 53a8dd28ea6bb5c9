#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include "mindahl/identification/terms.h"
#include "mindahl/report/contact.h"
#include "mindahl/report/report.h"
#include "mindahl/report/units.h"
#include "report/adequacy.h"
#include "report/field_table.h"
#include "report/fields.h"
#include "report/names.h"
#include "report/statements.h"
#include "report/style.h"

namespace mindahl::report {

using contact::PropagatedValue;
using contact::UncertainValue;
using identification::FitResult;

namespace {

/// Breaks a statement with its label before it, below which its other lines begin; nothing of an
/// empty one.
std::string Labelled(std::string_view label, std::string_view statement) {
  return statement.empty() ? "" : Wrapped(fmt::format("{}{}", label, statement), label.size());
}

std::string ValueAndError(const UncertainValue& value, std::string_view unit) {
  return QuantityWithError(value.value, value.standard_error, unit);
}

std::string SharesText(const PropagatedValue& value) {
  const std::string statement = VarianceStatement(value);
  return statement.empty() ? "" : fmt::format("{:<23}{}\n", "", statement);
}

/// Names the inputs that more knowledge of the contact needs.
std::string MissingText(const Report& report) {
  const std::vector<std::string> inputs =
      contact::MissingInputs(report.known, contact::ContactQuantity::kEquivalentRadius);
  std::string text;
  if (const auto why = WhyFrictionIsWithheld(report.fit, report.known)) {
    text += Wrapped("not identified: friction coefficient " + *why, 16);
  }
  if (!report.fit.Find("sigma")->is_known()) {
    return text + Wrapped("not identified: everything that follows from sigma", 16);
  }
  if (inputs.empty()) {
    if (report.contact.hertz) return text;
    return text + Wrapped("the comparison with Hertz needs the radii of both bodies", 2);
  }
  std::vector<std::string> more;
  for (const ContactField& field : ContactFields()) {
    const bool is_friction = field.key == "friction_coefficient";
    if (is_friction && report.known.normal_load) continue;  // withheld, as said
    // Radius and compliance follow from each other.
    if (field.key == "compliance" && !report.known.contact_radius) continue;
    const bool is_of_sphere = field.key == "equivalent_radius" || field.key == "maximum_pressure";
    if (is_of_sphere && DeniesHertz(report.fit)) continue;
    if (!field.get(report)) more.emplace_back(field.label);
  }
  if (!report.contact.hertz) more.emplace_back("Hertz's prediction");
  return text + Wrapped(fmt::format("with {} given, more would be known: {}",
                                    fmt::join(inputs, ", "), fmt::join(more, ", ")),
                        2);
}

/// Lists the quantities of the contact under the laws that a load series does not reject.
std::string LoadLawText(const Report& report) {
  std::string text;
  for (const LoadLaw& law : LawsToShow(*report.load_series)) {
    text += Wrapped("  " + LawHeading(law), 4);
    for (const QuantityUnderLaw& quantity : law.quantities) {
      if (quantity.key == "contact_radius") continue;  // at every load above
      text += fmt::format("    {:<21} {:<25} {} {:<26} {}\n", quantity.label,
                          ValueAndError(quantity.value, quantity.unit), ConfidenceWords(report.fit),
                          IntervalWords(quantity), quantity.formula);
      if (quantity.predicted) {
        text += fmt::format("    {:<21} {}\n", "  from the two radii",
                            Quantity(*quantity.predicted, quantity.unit));
      }
      const std::string shares = VarianceStatement(quantity.value);
      if (!shares.empty()) text += fmt::format("    {:<21} {}\n", "", shares);
    }
  }
  for (const std::string& statement : LoadLawStatements(report)) {
    text += Wrapped("  " + statement, 4);
  }
  return text;
}

/// Returns no number of what is not known.
std::string IfKnown(const UncertainValue& value, std::string_view unit, const FitResult& fit,
                    std::string_view parameter) {
  return fit.Find(parameter)->is_known() ? ValueAndError(value, unit) : "-";
}

/// Lists the identified quantities with their formulas, and the inputs that the rest needs.
std::string ContactText(const Report& report) {
  std::string text;
  bool has_compliance = false;
  for (const ContactField& field : ContactFields()) {
    const std::optional<PropagatedValue> value = field.get(report);
    if (!value || !IsIdentified(report, field, *value)) continue;
    text += fmt::format("{:<22} {:<27} {}\n", field.label, ValueAndError(*value, field.unit),
                        field.formula);
    text += SharesText(*value);
    has_compliance = has_compliance || field.formula.find("G*") != std::string_view::npos;
  }
  if (has_compliance) {
    text +=
        "G* = (2−ν₁)/G₁ + (2−ν₂)/G₂ [1/Pa], a compliance: many texts write G* for its inverse\n";
  }
  for (const std::string& sentence : report.contact.redundant) text += Wrapped(sentence, 2);
  return text + MissingText(report);
}

/// Lists what Hertz and Mindlin predict; empty where load, materials or radii are not known.
std::string HertzText(const Report& report) {
  if (!report.contact.hertz || !report.fit.Find("sigma")->is_known()) return "";
  const contact::HertzPrediction& hertz = *report.contact.hertz;
  std::string text = "Hertz and Mindlin predict from materials, radii and load:\n";
  const auto line = [&](const char* name, const PropagatedValue& value, const char* unit,
                        const PropagatedValue& ratio) {
    if (!std::isfinite(ratio.standard_error)) return;
    text += fmt::format("  {:<21} {:<22} measured/predicted {}\n", name, ValueAndError(value, unit),
                        ValueAndError(ratio, "-"));
  };
  line("contact radius", hertz.contact_radius, "m", hertz.sigma_over_hertz_mindlin);
  line("tangential stiffness", hertz.tangential_stiffness, "N/m", hertz.sigma_over_hertz_mindlin);
  line("gross slip (α = 1/3)", hertz.gross_slip_displacement, "m",
       hertz.gross_slip_displacement_ratio);
  return text;
}

/// Returns the contact under each load of a series, and the theories of the load's exponent; empty
/// without a series.
std::string LoadSeriesText(const Report& report) {
  if (!report.load_series) return "";
  const LoadSeries& series = *report.load_series;
  const FitResult& fit = report.fit;
  std::string text = fmt::format(
      "under several loads (σ ∝ N^p, Tc = μN; the parameters above are at the mean, {}):\n",
      Quantity(*fit.normal_load, "N", 6));
  const bool has_radius = series.contacts.front().contact_radius.has_value();
  const bool has_hertz = series.contacts.front().hertz_radius.has_value();
  text += fmt::format("  {:<10} {:<23} {:<20}{}{}\n", "N", "σ", "Tc",
                      has_radius ? fmt::format(" {:<19}", "a = σG*/8") : "",
                      has_hertz ? " a of Hertz" : "");
  for (const ContactUnderLoad& contact : series.contacts) {
    text += fmt::format("  {:<10} {:<23} {:<20}", Quantity(contact.normal_load, "N", 5),
                        IfKnown(contact.stiffness, "N/m", fit, "sigma"),
                        IfKnown(contact.slip_force, "N", fit, "slip_force"));
    if (has_radius)
      text += fmt::format(" {:<19}", IfKnown(*contact.contact_radius, "m", fit, "sigma"));
    if (has_hertz) text += " " + Quantity(*contact.hertz_radius, "m", 5);
    text += "\n";
  }
  for (const LoadHypothesis& hypothesis : series.hypotheses) {
    if (!hypothesis.p_value) continue;
    const double p_value = *hypothesis.p_value;
    text += fmt::format("  {:<28} p − {:<6.4g} = {:>8.3g}, {:>6.2f} standard errors, {}{}\n",
                        WordsOfHypothesis(hypothesis.name), hypothesis.exponent,
                        *hypothesis.difference, *hypothesis.z, ChanceText(p_value),
                        p_value < kSignificance ? ": rejected" : "");
  }
  return text + LoadLawText(report);
}

/// Tests whether it is Mindlin's contact: α against 1/3 and σ against 8a/G*.
std::string MappingText(const Report& report) {
  std::string text;
  for (const std::string& statement : ExponentStatements(report)) {
    text += Wrapped("  " + statement, 6);
  }
  for (const StiffnessTest& test : report.stiffness) {
    const std::vector<std::string> statements = StiffnessStatements(test);
    for (std::size_t k = 0; k < statements.size(); ++k) {
      text += Wrapped((k == 0 ? "  " : "      ") + statements[k], 6);
    }
    text += SharesText(test.ratio);
  }
  return text.empty() ? "  not tested: alpha is fixed, and no radius is known apart from the fit\n"
                      : text;
}

using identification::ParameterEstimate;
using identification::ParameterStatus;
using identification::RecordFit;

/// A parameter with its error, in the unit that suits both, and its limits in the same unit.
struct ParameterWords {
  std::string value;
  std::string interval;
};

/// @param estimate  of which a value or a lower limit is shown
ParameterWords ParameterInWords(const ParameterEstimate& estimate) {
  if (WhatIsShown(estimate) == Shown::kLowerLimit) {
    return {"> " + (estimate.lower95 ? Quantity(*estimate.lower95, estimate.unit) : "open"), "-"};
  }
  const double error = estimate.standard_error.value_or(0.0);
  const ScaledUnit unit = UnitFor(estimate.unit, std::max(std::abs(estimate.value), error));
  const auto limit = [&](const std::optional<double>& value) {
    if (!value) return std::string("open");
    return RoundedTo(error / unit.factor, *value / unit.factor);
  };
  return {QuantityWithError(estimate.value, error, estimate.unit),
          fmt::format("{} … {}", limit(estimate.lower95), limit(estimate.upper95))};
}

/// The table of the parameters: what belongs on the first screen, and what follows.
struct ParameterTables {
  std::string first;
  std::string rest = {};
};

/// Tabulates the parameters of the contact first, and the others with them where these are few.
ParameterTables TabulateParameters(const FitResult& fit, const Style& style) {
  constexpr std::array<std::string_view, 6> kOfContact = {
      "sigma", "alpha", "slip_force", "rig_stiffness", "load_exponent", "asymmetry"};
  constexpr std::size_t kFew = 6;  // rows
  const std::string head =
      style.Strong(fmt::format("{:<22} {:<27} {:<24} {}", "parameter", "value ± std error",
                               ConfidenceWords(fit) + " interval", "verdict")) +
      "\n";
  std::string of_contact;
  std::string others;
  std::size_t rows = 0;
  std::vector<std::string> held;
  std::vector<std::string> open;
  for (const ParameterEstimate& estimate : fit.parameters) {
    if (WhatIsShown(estimate) == Shown::kNothing) {
      open.push_back(estimate.name);
      continue;
    }
    if (estimate.status == ParameterStatus::kFixed) {
      held.push_back(
          fmt::format("{} = {}", estimate.name, Quantity(estimate.value, estimate.unit, 6)));
      continue;
    }
    const ParameterWords words = ParameterInWords(estimate);
    const bool is_of_contact = std::ranges::find(kOfContact, estimate.name) != kOfContact.end();
    (is_of_contact ? of_contact : others) +=
        fmt::format("{:<22} {:<27} {:<24} {}\n", estimate.name, words.value, words.interval,
                    style.Judged(JudgementOf(estimate), VerdictWords(estimate)));
    ++rows;
  }
  ParameterTables tables{.first = head + of_contact};
  if (rows <= kFew) {
    tables.first += others;
  } else {
    tables.rest = "\n" + head + others;
  }
  if (!open.empty()) {
    tables.first += Wrapped(fmt::format("not identifiable: {}", fmt::join(open, ", ")), 2);
  }
  if (!held.empty()) {
    tables.rest += (rows <= kFew ? "\n" : "") +
                   Wrapped(fmt::format("fixed, not fitted: {}", fmt::join(held, ", ")), 2);
  }
  return tables;
}

std::string SelectionText(const identification::ModelSelection& selection, const Units& units) {
  std::string text =
      fmt::format("models compared on {:.0f} effective samples", selection.effective_samples);
  text += selection.held_out_cycles > 0
              ? fmt::format(", and by predicting {} held-out cycles:\n", selection.held_out_cycles)
              : "; too few cycles to hold any out:\n";
  text += fmt::format("  {:<22} {:>4} {:>11} {:>8} {:>7} {:>22}\n", "model", "free",
                      fmt::format("rms [{}]", units.force), "dAICc", "weight",
                      fmt::format("held-out rms [{}]", units.force));
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
  return text + "  * reported, = not distinguished from it\n" +
         Wrapped("  " + selection.verdict, 2) + "\n";
}

/// Returns "; not tried: p1, p2 (why)", of the columns with an obstacle; may be empty.
std::string KeptOut(const identification::TermSelection& terms, std::string_view obstacle,
                    std::string_view how, std::string_view why) {
  std::vector<std::string> names;
  for (const identification::ConsideredTerm& term : terms.considered) {
    const bool is_column = identification::FindTermGroup(term.name) == nullptr;
    if (is_column && term.obstacle == obstacle && !term.added) names.push_back(term.name);
  }
  return names.empty() ? "" : fmt::format("; {}: {} ({})", how, fmt::join(names, ", "), why);
}

/// Returns which terms were added and what each gained, and which columns were kept out.
std::string TermsText(const identification::TermSelection& terms) {
  const std::string kept_out =
      KeptOut(terms, "same_channel", "not tried", "repeats another column") +
      KeptOut(terms, "confounded", "not added", "follows the contact's force");
  if (terms.added.empty()) {
    return terms.considered.empty() ? "" : "terms: none of those tried improves the fit" + kept_out;
  }
  std::vector<std::string> added;
  for (const identification::ConsideredTerm& term : terms.considered) {
    if (!term.added) continue;
    added.push_back(
        fmt::format("{} (-{:.0f} %, p = {:.1g})", term.name, 100 * term.gain, term.p_value));
  }
  return fmt::format(
      "terms added: {} (change of the rms error of {}){}", fmt::join(added, ", "),
      terms.held_out_parts > 0 ? fmt::format("{} held-out parts", terms.held_out_parts) : "the fit",
      kept_out);
}

/// Says of which amplitude an energy is, where cycles have several.
std::string OfAmplitude(const Report& report) {
  const std::vector<loop::CycleFacts>& cycles = report.fit.WidestRecord().facts.cycles;
  if (std::ranges::all_of(cycles, &loop::CycleFacts::steady)) return "";
  return fmt::format(" at X = {}",
                     Quantity(report.loop->measured.amplitude, report.units.displacement, 4));
}

std::string MeasuredText(const Report& report) {
  const RecordFit& widest = report.fit.WidestRecord();
  const loop::LoopFacts& facts = widest.facts;
  const MeasuredLoop& loop = report.loop->measured;
  const Units& units = report.units;
  std::vector<std::string> parts = {"X = " + Quantity(loop.amplitude, units.displacement, 5),
                                    "T* = " + Quantity(loop.peak_force, units.force, 5)};
  const auto add = [&](const char* what, const std::optional<double>& value,
                       std::string_view unit) {
    if (value) parts.push_back(fmt::format("{} {}", what, Quantity(*value, unit, 4)));
  };
  if (!facts.closed) {
    parts.emplace_back("no closed cycle");
    return Labelled("measured: ", fmt::format("{}", fmt::join(parts, ", ")));
  }
  if (facts.half_gap && facts.half_gap_standard_deviation) {
    parts.push_back(fmt::format(
        "half gap {} between cycles",
        QuantityWithError(*facts.half_gap, facts.half_gap_standard_deviation, units.force)));
  } else {
    add("half gap", facts.half_gap, units.force);
  }
  if (loop::Slides(facts) && facts.sliding_fraction) {
    parts.push_back(
        fmt::format("it slides over {:.0f} % of the stroke", 100 * *facts.sliding_fraction));
  }
  if (facts.backlash) {
    parts.push_back(fmt::format("the force stays constant over {} after each reversal",
                                Quantity(facts.backlash->width, units.displacement, 3)));
  }
  add("sliding amplitude", facts.sliding_amplitude, units.displacement);
  parts.push_back(fmt::format("energy {} a cycle{}", Quantity(facts.energy_per_cycle, "J", 5),
                              OfAmplitude(report)));
  add("energy ratio", facts.energy_ratio, "-");
  add("energy friction coefficient", facts.energy_friction_coefficient, "-");
  add("slope after reversals", facts.slope_after_reversal, units.stiffness);
  add("plateau slope", facts.plateau_slope, units.stiffness);
  add("asymmetry", facts.asymmetry, "-");
  for (const std::string& trend : TrendStatements(facts)) parts.push_back(trend);
  return Labelled("measured: ", fmt::format("{}", fmt::join(parts, ", ")));
}

/// Returns the verdict's own word at the start of its sentence.
std::string Coloured(const std::string& sentence, const Report& report, const Style& style) {
  if (!IsJudged(report)) return sentence;
  const std::string_view word = Name(report.fit.adequacy.verdict);
  return style.Judged(JudgementOf(word), word) + sentence.substr(word.size());
}

std::string AdequacyText(const Report& report, const Style& style) {
  return Coloured(Wrapped(VerdictSentence(report), 2), report, style) +
         Labelled("next: ", NextStep(report));
}

/// Returns the other causes, which the next step may leave.
std::string OtherCausesText(const Report& report) {
  const std::vector<identification::Cause>& causes = report.fit.adequacy.causes;
  constexpr std::size_t kMost = 3;
  std::string text;
  for (std::size_t i = 1; i < std::min(kMost, causes.size()); ++i) {
    text += Labelled("or like ", Sentence(causes[i], report.fit.response));
  }
  return text.empty() ? text : "\n" + text;
}

std::string NotesText(const Report& report) {
  std::string text;
  for (const Warning& note : report.notes) text += Labelled("note: ", note.message);
  return text.empty() ? text : "\n" + text;
}

std::string SamplesText(const Report& report) {
  std::size_t samples = 0;
  std::size_t left_out = 0;
  std::size_t reversals = 0;
  std::size_t cycles = 0;
  for (const RecordFit& record : report.fit.records) {
    samples += record.residual.size();
    left_out += record.left_out;
    reversals += record.reversals.size();
    cycles += record.measures.cycles;
  }
  const loop::ReversalGate& gate = report.fit.WidestRecord().gate;
  return fmt::format("{} samples{}, {} reversals ({}gate {}), {} cycles", samples,
                     left_out > 0 ? fmt::format(", {} of them left out", left_out) : "", reversals,
                     gate.certain ? "" : "not certain, ",
                     Quantity(gate.gate, report.units.excitation, 3), cycles);
}

/// Returns the initial state, of each file where they differ.
std::string InitialStates(const FitResult& fit) {
  if (!fit.has_mixed_states()) return std::string(Name(fit.initial_state));
  std::vector<std::string_view> names;
  names.reserve(fit.records.size());
  for (const identification::RecordFit& record : fit.records) {
    names.push_back(Name(record.initial_state));
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string FitText(const Report& report) {
  const FitResult& fit = report.fit;
  std::string text = Wrapped(
      fmt::format("{}, {} initial state: {}; {}, {} of force and displacement", fit.model->title,
                  InitialStates(fit), fit.converged ? "converged" : "NOT CONVERGED",
                  SamplesText(report), fit.force_sense > 0 ? "same sign" : "opposite signs"),
      2);
  if (!fit.converged) text += Wrapped("not converged: " + fit.solver.message, 2);
  return text;
}

/// Describes a fit that is not usable in ten lines: the verdict, the next step, and what stands.
std::string UnusableText(const Report& report, const Style& style) {
  std::string text = AdequacyText(report, style) + MeasuredText(report) +
                     Labelled("reversals: ", SamplesText(report));
  for (const Warning& note : report.notes) {
    // This text prints no parameters, so a note on one has nothing to refer to.
    const bool is_of_parameters =
        std::ranges::any_of(report.fit.findings, [&](const identification::Finding& finding) {
          return std::string_view(finding.code) == note.code && !finding.parameters.empty();
        });
    if (is_of_parameters) continue;
    text += Labelled("note: ", note.message);
  }
  return text;
}

std::string ResidualText(const Report& report) {
  const FitResult& fit = report.fit;
  const Units& units = report.units;
  const identification::ResidualStatistics& residuals = fit.residuals;
  const bool is_of_force = fit.response == loop::Channel::kForce;
  // A fraction of an unknown value would reveal it.
  const ParameterEstimate* slip_force = fit.Find("slip_force");
  const std::string share = slip_force != nullptr && slip_force->is_known()
                                ? fmt::format(" ({:.3g} % of {})", 100 * residuals.normalized_rms,
                                              is_of_force ? "Tc" : "Tc/σ")
                                : "";
  std::size_t samples = 0;
  double repeatable = 0.0;
  for (const RecordFit& record : fit.records) {
    samples += record.residual.size() - record.left_out;
    repeatable = std::max(repeatable, record.structure.repeatable_share);
  }
  std::string text = fmt::format(
      "residuals{}: rms {}{}, largest {}, R² {:.6f}, Durbin-Watson {:.2f}, {:.0f} effective "
      "samples of {}",
      is_of_force ? "" : " of the displacement", Quantity(residuals.rms, units.response, 4), share,
      Quantity(residuals.max_abs, units.response, 4), residuals.r_squared, residuals.durbin_watson,
      residuals.effective_samples, samples);
  if (repeatable > 0) {
    text += fmt::format("; {:.0f} % of their variance repeats in every stroke", 100 * repeatable);
  }
  if (const double noise = fit.WidestRecord().displacement_noise; noise > 0 && is_of_force) {
    text += fmt::format("; displacement noise {} taken into account",
                        Quantity(noise, units.displacement, 3));
  }
  if (fit.outliers > 0)
    text += fmt::format("; {} outliers have less than half weight", fit.outliers);
  return Wrapped(text, 11);
}

std::string LoopText(const Report& report) {
  const LoopDescription& loop = *report.loop;
  std::string text =
      fmt::format("slip: {}; model energy {} a cycle{}", SlipStatement(loop, report.units),
                  Quantity(loop.model_energy, "J", 5), OfAmplitude(report));
  if (loop.gross_slip_energy_ratio) {
    text +=
        fmt::format(", gross slip above an energy ratio of {:.4g}", *loop.gross_slip_energy_ratio);
  }
  return Wrapped(text, 6);
}

}  // namespace

std::string ToText(const Report& report, const TextOptions& options) {
  RequireFitted(report, "a text");
  const FitResult& fit = report.fit;
  const Style style(options.has_colours);
  if (!IsUsable(report)) {
    const std::string unusable = UnusableText(report, style);
    return report.selection ? unusable + "\n" + SelectionText(*report.selection, report.units)
                            : unusable;
  }
  std::string text = AdequacyText(report, style);
  if (report.terms) text += Wrapped(TermsText(*report.terms), 2);
  const ParameterTables tables = TabulateParameters(fit, style);
  text += "\n" + tables.first + Wrapped(SlipForcesStatement(report), 13) +
          Wrapped(PriorStatement(fit), 7);
  std::string rest =
      tables.rest + Wrapped(WideIntervalStatement(fit, report.units), 2) + OtherCausesText(report);
  if (report.selection) rest += "\n" + SelectionText(*report.selection, report.units);
  rest += "\n" + FitText(report) + MeasuredText(report) + ResidualText(report);
  // For an inadequate model no curve is shown, and nothing that follows from it.
  if (fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate) {
    return text + rest + NotesText(report);
  }
  const std::string loop = "\n" + LoopText(report) + Labelled("law:  ", LawStatement(report));
  if (report.is_torsional()) {
    return text + Wrapped(std::string("no contact: ") + kWhyNoContact, 2) + loop + rest +
           NotesText(report);
  }
  text += "\n" + style.Strong("contact (Mindlin-Dahl mapping)") + "\n" + ContactText(report);
  const auto section = [&](const std::string& lines) {
    if (!lines.empty()) rest += "\n" + lines;
  };
  section(LoadSeriesText(report));
  section(HertzText(report));
  rest += "\n" + style.Strong("is it Mindlin's contact?") + "\n" + MappingText(report);
  return text + loop + rest + NotesText(report);
}

}  // namespace mindahl::report
