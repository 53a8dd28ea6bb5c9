#include "mindahl/report/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string_view>

#include "mindahl/identification/trend.h"
#include "report/adequacy.h"
#include "report/field_table.h"
#include "report/fields.h"
#include "report/names.h"
#include "report/requirements.h"

namespace mindahl::report {

using contact::PropagatedValue;
using identification::FitResult;
using identification::RecordFit;

namespace {

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
    // A word takes the blanks before it along, and a number its per cent.
    const std::size_t letter = std::min(text.find_first_not_of(' ', begin), text.size());
    std::size_t end = std::min(text.find(' ', letter), text.size());
    if (text.substr(end).starts_with(" %")) end = std::min(text.find(' ', end + 1), text.size());
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

std::string ParameterTable(const FitResult& fit) {
  std::string text;
  std::size_t width = 4;
  for (const identification::ParameterEstimate& estimate : fit.parameters) {
    width = std::max(width, estimate.unit.starts_with("N m") ? estimate.unit.size() : 0);
  }
  const auto row = [&](std::string_view name, std::string_view unit, std::string_view value,
                       std::string_view error, std::string_view interval,
                       std::string_view verdict) {
    text += fmt::format("{:<19} {:<{}} {:>12} {:>9}  {:<24} {}\n", name, unit, width, value, error,
                        interval, verdict);
  };
  row("parameter", "unit", "value", "std error", "95 % interval", "verdict");
  for (const identification::ParameterEstimate& estimate : fit.parameters) {
    if (estimate.status == identification::ParameterStatus::kFixed) {
      row(estimate.name, estimate.unit, Significant(estimate.value), "-", "-", "fixed");
      continue;
    }
    std::string verdict = Words(estimate.identifiability);
    if (estimate.status != identification::ParameterStatus::kFree) verdict += ", at bound";
    // A number beside "not identifiable" would be read as one all the same.
    using identification::Identifiability;
    if (estimate.identifiability == Identifiability::kNotIdentifiable) {
      row(estimate.name, estimate.unit, "-", "-", "-", verdict);
      continue;
    }
    if (estimate.identifiability == Identifiability::kBoundedBelow) {
      row(estimate.name, estimate.unit, "> " + Bound(estimate.lower95), "-", "-", verdict);
      continue;
    }
    row(estimate.name, estimate.unit, Significant(estimate.value),
        estimate.standard_error ? fmt::format("{:.2g}", *estimate.standard_error) : "-",
        fmt::format("{} … {}", Bound(estimate.lower95), Bound(estimate.upper95)), verdict);
  }
  return text;
}

std::string ErrorText(const contact::UncertainValue& value) {
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

std::string ContactText(const Report& report) {
  const contact::IdentifiedContact& contact = report.contact;
  std::string text =
      "  G* = (2−ν₁)/G₁ + (2−ν₂)/G₂ [1/Pa], a compliance: many texts write G* for its inverse\n";
  for (const ContactField& field : ContactFields()) {
    const std::optional<PropagatedValue> value = field.get(report);
    if (!value) continue;
    text += fmt::format("  {:<22} {:>14} {:<10} {:<5} {}\n", field.label, Significant(value->value),
                        ErrorText(*value), field.unit == "-" ? "" : field.unit, field.formula);
    text += SharesText(*value);
  }
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
  return text + "  * reported, = not told from it\n" + Wrapped("  " + selection.verdict, 2) + "\n";
}

std::string SlipText(const LoopDescription& loop, const Units& units) {
  if (!loop.regime) return "whether it slips is open: slip_force is not identifiable";
  if (loop.gross_slip_displacement) {
    return fmt::format("{} slip (gross-slip displacement {:.5g} {})", Name(*loop.regime),
                       *loop.gross_slip_displacement, units.displacement);
  }
  if (!loop.knows_slip) {
    return fmt::format("{} slip (gross-slip displacement not identified)", Name(*loop.regime));
  }
  return fmt::format("{:.3g} % of Tc reached: with α >= 1 the force only approaches it",
                     100 * loop.slip_force_share);
}

std::string MappingText(const Report& report) {
  std::string text;
  const auto verdict = [](double p_value) {
    return p_value < kSignificance ? "rejected" : "tenable";
  };
  const auto& mindlin = report.fit.mindlin_test;
  // Of the two tests the likelihood ratio has the say: it needs no parabola.
  if (report.alpha.z) {
    text += fmt::format(
        "  α − 1/3 = {:.3g}, {:.2f} standard errors, p = {:.3g}{}\n", *report.alpha.minus_third,
        *report.alpha.z, *report.alpha.p_value,
        mindlin ? "" : fmt::format(": Mindlin's exponent is {}", verdict(*report.alpha.p_value)));
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
  for (const StiffnessTest& test : report.stiffness) {
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

/// A theory of the load's exponent in words.
std::string Words(const LoadHypothesis& hypothesis) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 5> kWords = {{
      {"sphere", "smooth sphere, Hertz (1/3)"},
      {"elements", "elements in parallel (α)"},
      {"cone", "cone (1/2)"},
      {"flat_punch", "flat punch (0)"},
      {"rough", "rough contact (1)"},
  }};
  const auto row = std::ranges::find(kWords, hypothesis.name,
                                     &std::pair<std::string_view, std::string_view>::first);
  return std::string(row == kWords.end() ? hypothesis.name : row->second);
}

/// No number of what is not known.
std::string ValueAndError(const contact::UncertainValue& value, const FitResult& fit,
                          std::string_view parameter) {
  const identification::ParameterEstimate& estimate = *fit.Find(parameter);
  return estimate.is_known() ? fmt::format("{} {}", Significant(value.value), ErrorText(value))
                             : "-";
}

std::string LoadSeriesText(const LoadSeries& series, const FitResult& fit) {
  std::string text = fmt::format(
      "\nunder several loads (σ ∝ N^p, Tc = μN; the parameters above are at the mean, {:.6g} N):\n",
      *fit.normal_load);
  const bool has_radius = series.contacts.front().contact_radius.has_value();
  const bool has_hertz = series.contacts.front().hertz_radius.has_value();
  text += fmt::format("  {:>9} {:>23} {:>20}{}{}\n", "N [N]", "σ [N/m]", "Tc [N]",
                      has_radius ? fmt::format(" {:>22}", "a = σG*/8 [m]") : "",
                      has_hertz ? fmt::format(" {:>14}", "a of Hertz [m]") : "");
  for (const ContactUnderLoad& contact : series.contacts) {
    text += fmt::format("  {:>9.5g} {:>23} {:>20}", contact.normal_load,
                        ValueAndError(contact.stiffness, fit, "sigma"),
                        ValueAndError(contact.slip_force, fit, "slip_force"));
    if (has_radius)
      text += fmt::format(" {:>22}", ValueAndError(*contact.contact_radius, fit, "sigma"));
    if (has_hertz) text += fmt::format(" {:>14}", Significant(*contact.hertz_radius));
    text += "\n";
  }
  constexpr double kLeastChance = 1e-12;
  for (const LoadHypothesis& hypothesis : series.hypotheses) {
    if (!hypothesis.p_value) continue;
    const double p_value = *hypothesis.p_value;
    text +=
        fmt::format("  {:<28} p − {:<6.4g} = {:>8.3g}, {:>6.2f} standard errors, p-value {}{}\n",
                    Words(hypothesis), hypothesis.exponent, *hypothesis.difference, *hypothesis.z,
                    p_value < kLeastChance ? "< 1e-12" : fmt::format("{:.3g}", p_value),
                    p_value < kSignificance ? ": rejected" : "");
  }
  return text;
}

/// A trend over the cycles in words, where it is worth any.
std::string TrendText(const char* what, const std::optional<loop::Trend>& trend,
                      const std::optional<double>& mean) {
  if (!trend || !mean || !identification::IsWorthSaying(*trend, *mean)) return "";
  return fmt::format("{} changes by {:+.2g} ± {:.1g} % a cycle (p = {:.1g})", what,
                     100 * trend->slope / std::abs(*mean),
                     100 * trend->standard_error / std::abs(*mean), trend->p_value);
}

/// What needs no model.
std::string MeasuredText(const Report& report) {
  const RecordFit& widest = report.fit.WidestRecord();
  const loop::LoopFacts& facts = widest.facts;
  const MeasuredLoop& loop = report.loop->measured;
  const Units& units = report.units;
  std::vector<std::string> parts = {
      fmt::format("X = {:.5g} {}", loop.amplitude, units.displacement),
      fmt::format("T* = {:.5g} {}", loop.peak_force, units.force)};
  const auto add = [&](const char* what, const std::optional<double>& value,
                       std::string_view unit) {
    if (value) {
      parts.push_back(fmt::format("{} {:.4g}{}{}", what, *value, unit.empty() ? "" : " ", unit));
    }
  };
  if (!facts.closed) {
    parts.emplace_back("no closed cycle");
    return Wrapped("measured: " + fmt::format("{}", fmt::join(parts, ", ")), 10);
  }
  if (facts.half_gap && facts.half_gap_standard_deviation) {
    parts.push_back(fmt::format("half gap {:.4g} ± {:.2g} {} between cycles", *facts.half_gap,
                                *facts.half_gap_standard_deviation, units.force));
  } else {
    add("half gap", facts.half_gap, units.force);
  }
  add("sliding amplitude", facts.sliding_amplitude, units.displacement);
  parts.push_back(fmt::format("energy {:.5g} J a cycle", facts.energy_per_cycle));
  parts.push_back(fmt::format("energy ratio {:.4g}", facts.energy_ratio));
  add("energy friction coefficient", facts.energy_friction_coefficient, "");
  add("slope after reversals", facts.slope_after_reversal, units.stiffness);
  add("plateau slope", facts.plateau_slope, units.stiffness);
  add("asymmetry", facts.asymmetry, "");
  for (const std::string& trend :
       {TrendText("half gap", facts.half_gap_trend, facts.half_gap),
        TrendText("energy", facts.energy_trend, facts.energy_per_cycle)}) {
    if (!trend.empty()) parts.push_back(trend);
  }
  return Wrapped("measured: " + fmt::format("{}", fmt::join(parts, ", ")), 10);
}

/// The verdict, and causes besides the best.
std::string AdequacyText(const Report& report) {
  std::string text = Wrapped(VerdictSentence(report), 2);
  const identification::Adequacy& adequacy = report.fit.adequacy;
  if (!IsJudged(report) || adequacy.verdict == identification::AdequacyVerdict::kAdequate) {
    return text;
  }
  for (std::size_t i = 1; i < adequacy.causes.size(); ++i) {
    text += Wrapped("  or " + Sentence(adequacy.causes[i]), 5);
  }
  return text;
}

/// Which of the two laws σ and Tc are of, and what the other would make of the contact.
std::string LawText(const Report& report) {
  if (!report.fit.law_choice) return "";
  const identification::LawChoice& choice = *report.fit.law_choice;
  const auto name = [](const models::FrictionModel& model) {
    return model.memory == models::Memory::kReturnPoint ? "Masing's law" : "Dahl's own law";
  };
  if (choice.preferred == report.fit.model) {
    return choice.delta_aicc
               ? fmt::format("law:  {}, not {} (ΔAICc = {:.3g})\n", name(*report.fit.model),
                             name(*choice.alternative), *choice.delta_aicc)
               : fmt::format("law:  {}\n", name(*report.fit.model));
  }
  const Units& units = report.units;
  std::string text = fmt::format(
      "law:  sigma and slip_force are of {}; by {}, which {}, they are {:.6g} {} and {:.6g} {}",
      name(*report.fit.model), name(*choice.alternative),
      choice.decided ? fmt::format("fits better (ΔAICc = {:.3g}, --model {})",
                                   choice.delta_aicc.value_or(0.0), choice.alternative->name)
                     : std::string("the record does not tell from it"),
      choice.law.tangential_stiffness, units.stiffness, choice.law.slip_force, units.force);
  const auto add = [&](const char* what, const std::optional<PropagatedValue>& quantity) {
    if (quantity) text += fmt::format(", {} {:.6g} m", what, quantity->value);
  };
  add("contact radius", report.contact_by_other_law.contact_radius);
  add("equivalent radius", report.contact_by_other_law.equivalent_radius);
  return Wrapped(text, 6);
}

/// The comparisons of branches, in words.
struct ComparisonWords {
  std::string_view code;
  std::string_view words;
};

constexpr std::array<ComparisonWords, 6> kComparisons = {{
    {"virgin_branch", "virgin branch"},
    {"directions", "directions"},
    {"amplitudes", "amplitudes"},
    {"slope_at_reversal", "slopes after reversals"},
    {"return_point", "way on after inner loops"},
    {"other_law", "what the other law fits"},
}};

/// Of which memory the record is, whatever the shape of its branches.
std::string MemoryText(const Report& report) {
  if (!report.fit.memory || report.fit.memory->comparisons.empty()) return "";
  const identification::MemoryTest& memory = *report.fit.memory;
  const auto p = [](double value) {
    return value < 1e-6 ? std::string("p < 1e-6") : fmt::format("p = {:.2g}", value);
  };
  std::string text = "memory: ";
  using enum identification::MemoryVerdict;
  switch (memory.verdict) {
    case kMasing:
      text +=
          fmt::format("Masing's ({}), not Dahl's ({})", p(memory.p_value), p(memory.dahl_p_value));
      break;
    case kDahl:
      text +=
          fmt::format("Dahl's ({}), not Masing's ({})", p(memory.dahl_p_value), p(memory.p_value));
      break;
    case kNeither:
      text += fmt::format("neither Masing's ({}) nor Dahl's ({})", p(memory.p_value),
                          p(memory.dahl_p_value));
      break;
    case kUndecided:
      text += fmt::format("Masing's ({}) or Dahl's ({}), undecided", p(memory.p_value),
                          p(memory.dahl_p_value));
      break;
  }
  std::vector<std::string> compared;
  for (const ComparisonWords& row : kComparisons) {
    const auto found =
        std::ranges::find(memory.comparisons, row.code, &identification::MemoryComparison::code);
    if (found == memory.comparisons.end()) continue;
    if (memory.verdict == kNeither) {
      compared.push_back(fmt::format("{} ({}, {:.2g} {})", row.words, p(found->p_value),
                                     found->size, report.units.force));
    } else {
      compared.emplace_back(row.words);
    }
  }
  text += fmt::format("; compared: {}", fmt::join(compared, ", "));
  if (memory.verdict == kUndecided) {
    const auto has = [&](std::string_view code) {
      return std::ranges::find(memory.comparisons, code, &identification::MemoryComparison::code) !=
             memory.comparisons.end();
    };
    text += has("virgin_branch") || has("amplitudes")
                ? "; amplitudes further apart, or less noise, would decide"
                : "; a virgin branch, a second amplitude or an inner loop would decide";
  }
  return Wrapped(text, 8);
}

std::string NotesText(const Report& report) {
  std::string text;
  for (const Warning& note : report.notes) text += Wrapped("note: " + note.message, 6);
  return text.empty() ? text : "\n" + text;
}

}  // namespace

std::string ToText(const Report& report) {
  RequireFitted(report, "a text");
  const FitResult& fit = report.fit;
  const LoopDescription& loop = *report.loop;
  const RecordFit& widest = fit.WidestRecord();
  const Units& units = report.units;
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
  std::string text = AdequacyText(report) + MeasuredText(report) + MemoryText(report) + "\n";
  if (report.selection) text += SelectionText(*report.selection, units);
  text += fmt::format(
      "{}, {} initial state: {}\n{} samples, {} reversals (gate {:.3g} {}), {} cycles; {} "
      "of force and displacement\n",
      fit.model->title, Name(fit.initial_state), fit.converged ? "converged" : "NOT CONVERGED",
      samples, reversals, widest.gate.gate, units.displacement, cycles,
      fit.force_sense > 0 ? "same sign" : "opposite signs");
  if (!fit.converged) text += Wrapped("not converged: " + fit.termination, 2);
  if (left_out > 0) text += fmt::format("{} samples left out of the fit\n", left_out);
  text += "\n" + ParameterTable(fit);
  for (const Warning& warning : report.fit_warnings) {
    if (warning.code == "no_model_fits") text += "\n" + Wrapped(warning.message, 2);
  }
  const identification::ResidualStatistics& residuals = fit.residuals;
  // A share of what is not known would say it all the same.
  const identification::ParameterEstimate* slip_force = fit.Find("slip_force");
  const bool is_known =
      slip_force != nullptr &&
      slip_force->identifiability != identification::Identifiability::kNotIdentifiable;
  const std::string share =
      is_known ? fmt::format(" ({:.3g} % of Tc)", 100 * residuals.normalized_rms) : "";
  text += fmt::format(
      "\nresiduals: rms {:.4g} {}{}, largest {:.4g} {}, R² {:.6f}, Durbin-Watson {:.2f},\n"
      "           {:.0f} effective samples of {}\n",
      residuals.rms, units.force, share, residuals.max_abs, units.force, residuals.r_squared,
      residuals.durbin_watson, residuals.effective_samples, samples - left_out);
  double repeatable = 0.0;
  for (const RecordFit& record : fit.records) {
    repeatable = std::max(repeatable, record.structure.repeatable_share);
  }
  if (repeatable > 0) {
    text += fmt::format(
        "           repeatable residual: {:.0f} % of their variance is the same in every stroke\n",
        100 * repeatable);
  }
  if (widest.displacement_noise > 0) {
    text += fmt::format("           noise of the displacement {:.3g} {}, weighed in\n",
                        widest.displacement_noise, units.displacement);
  }
  if (fit.outliers > 0) {
    text += fmt::format("           {} outliers count less than half\n", fit.outliers);
  }
  if (fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate) {
    return text + "\n" +
           Wrapped("no loop of the model, and no contact: the model does not describe this record",
                   2) +
           NotesText(report);
  }
  text += fmt::format("\nloop: {}\n      energy per cycle {:.5g} J of the model",
                      SlipText(loop, units), loop.model_energy);
  text += loop.gross_slip_energy_ratio
              ? fmt::format(", gross slip from an energy ratio of {:.4g}\n",
                            *loop.gross_slip_energy_ratio)
              : "\n";
  text += LawText(report);
  if (report.is_torsional()) {
    return text + "\n" + Wrapped(std::string("no contact: ") + kWhyNoContact, 2) +
           NotesText(report);
  }
  if (report.load_series) text += LoadSeriesText(*report.load_series, fit);
  text += "\ncontact (Mindlin-Dahl mapping σ = 8a/G*, Tc = μN):\n" + ContactText(report);
  text += "\nis it Mindlin's contact?\n" + MappingText(report);
  return text + NotesText(report);
}

}  // namespace mindahl::report
