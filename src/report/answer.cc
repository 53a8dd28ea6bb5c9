#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <boost/algorithm/string/replace.hpp>
#include <set>
#include <utility>

#include "core/text.h"
#include "report/json.h"
#include "report/statements.h"

namespace mindahl::report {

namespace {

/// Returns "a 0.251 mm (0.250 … 0.252)"; empty where it does not follow.
std::string QuantityText(const ContactQuantity& quantity) {
  const std::string text =
      QuantityWithInterval(quantity.value, quantity.lower, quantity.upper, quantity.unit);
  return text.empty() ? "" : fmt::format("{} {}", quantity.symbol, text);
}

bool IsInadequate(const Report& report) {
  return IsJudged(report) && report.fit.adequacy.verdict == AdequacyVerdict::kInadequate;
}

/// True for a parameter of an inadequate model, unless it is known and the input not in doubt.
bool IsMoot(const Report& report, const ParameterEstimate& estimate) {
  return IsInadequate(report) && (!estimate.is_known() || !report.check.empty());
}

bool IsOfLaw(std::string_view parameter) {
  return std::ranges::find(kLawParameters, parameter) != kLawParameters.end();
}

/// Returns "half gap" of "half_gap".
std::string WithBlanks(std::string_view name) {
  return boost::replace_all_copy(std::string(name), "_", " ");
}

std::string CauseText(const identification::Cause& cause) {
  return fmt::format("{}, {:.0f} % of the misfit", WithBlanks(cause.code),
                     std::min(100.0, 100 * cause.explains));
}

/// Findings that a line of the answer says in its own words.
bool IsSaidByALine(std::string_view code) {
  return code == "other_law" || code == "model_inadequate" || code == "no_closed_cycle";
}

/// Makes the lines of one answer, so that a finding is said once.
class Writer {
 public:
  explicit Writer(const Report& report) : report_(report), fit_(report.fit) {}

  std::vector<Line> Answer() {
    Add("check", report_.check, kBad);
    AddColumns();
    AddReading();
    AddFriction();
    AddStiffness();
    AddShape();
    AddLoad();
    AddTerms();
    AddLaw();
    Add("misfit", MisfitStatement(report_), JudgementOf(VerdictWord(report_)));
    AddMeasured();
    AddLeftOut();
    if (report_.next) {
      Add("next", fmt::format("{}: {}", report_.next->options, NextStatement(*report_.next)));
    } else if (report_.check.empty()) {
      AddCause();
    }
    AddRest();
    return std::move(lines_);
  }

 private:
  void Add(std::string label, std::string text, std::string_view judgement = kPlain) {
    if (!text.empty()) lines_.push_back({std::move(label), std::move(text), judgement});
  }
  /// Adds a line of parts with commas between them; none of those that are empty.
  void Add(std::string label, std::vector<std::string> parts, std::string_view judgement = kPlain) {
    std::erase(parts, "");
    Add(std::move(label), fmt::format("{}", fmt::join(parts, ", ")), judgement);
  }

  /// Returns why a parameter has no value, and notes that it is said; "" if another line says it.
  std::string WhyNot(std::string_view parameter) {
    for (const Finding& finding : fit_.findings) {
      const bool names_it =
          std::ranges::find(finding.parameters, parameter) != finding.parameters.end();
      if (!names_it || finding.code.row().verdict == Identifiability::kIdentifiable) continue;
      if (IsSaidByALine(finding.code)) return "";
      return said_.insert(&finding).second ? Sentence(finding, fit_, report_.units) : "";
    }
    return "";
  }

  /// Returns a parameter, with why it has no value where that is so.
  std::string TextOf(std::string_view symbol, const ParameterEstimate& estimate) {
    const std::string why = WhatIsShown(estimate).value ? "" : WhyNot(estimate.name);
    return fmt::format("{} {}{}{}", symbol, ValueText(estimate), why.empty() ? "" : ": ", why);
  }

  /// Says a parameter with the quantities that follow from it: μ before it, the others behind.
  /// @param remark  said right after it; "" for none
  void AddParameter(std::string label, std::string_view symbol, const ParameterEstimate& estimate,
                    const std::string& remark) {
    if (IsMoot(report_, estimate)) return;
    std::vector<std::string> parts = {TextOf(symbol, estimate), remark};
    for (const ContactQuantity& quantity : report_.contact) {
      // G* and ρ are said only where nothing better is: a, and its ratio to Hertz's.
      const bool is_said =
          quantity.parameter != estimate.name ||
          (quantity.name == "compliance" && report_.ValueOf("contact_radius")) ||
          (quantity.name == "equivalent_radius" && report_.ValueOf("sigma_over_hertz_mindlin"));
      if (is_said) continue;
      const bool is_first = quantity.name == "friction_coefficient";
      parts.insert(is_first ? parts.begin() : parts.end(), QuantityText(quantity));
    }
    Add(std::move(label), std::move(parts), JudgementOf(estimate));
  }

  void AddColumns() {
    const std::string columns = ColumnsText(report_.records.front(), fit_.force_sense);
    const std::string name = NameOf(report_.files());
    if (columns.empty()) return Add("record", name);
    Add("columns", fmt::format("{}: {}", name, columns));
  }

  /// Says what was assumed of the files: one thing in full, of more how many.
  void AddReading() {
    const std::vector<std::string>& notes = report_.notes;
    if (notes.size() <= 1) return Add("read as", notes);
    Add("read as", fmt::format("{} assumptions: --details", notes.size()));
  }

  void AddFriction() {
    const ParameterEstimate& slip_force = *fit_.Find("slip_force");
    const ContactQuantity* load =
        slip_force.is_at_given_bound() ? nullptr : report_.Find("normal_load");
    std::string remark;
    if (load != nullptr && load->value &&
        !QuantityText(*report_.Find("friction_coefficient")).empty()) {
      remark = "at N = " + Quantity(*load->value, "N", 4);
    } else if (load != nullptr && !load->value && slip_force.is_known()) {
      remark = "μ needs --normal-load";
    }
    AddParameter("friction", "Tc", slip_force, remark);
  }

  /// Says σ, that it includes a drag, and what a still needs where some of the materials are known.
  void AddStiffness() {
    const ParameterEstimate& sigma = *fit_.Find("sigma");
    const contact::KnownContact& known = report_.known;
    std::vector<std::string> missing;
    for (const auto& [option, given] :
         {std::pair("--youngs-modulus-1", &known.body_1.youngs_modulus),
          {"--poisson-1", &known.body_1.poisson_ratio},
          {"--youngs-modulus-2", &known.body_2.youngs_modulus},
          {"--poisson-2", &known.body_2.poisson_ratio}}) {
      if (!*given) missing.emplace_back(option);
    }
    const bool is_started = !missing.empty() && missing.size() < 4;  // some are given
    const bool needs_them =
        is_started && !known.tangential_compliance && !report_.is_torsional() && sigma.is_known();
    std::vector<std::string> remarks;
    if (sigma.is_known() && fit_.Find("drag_fraction") != nullptr) {
      remarks.emplace_back("σ and Tc include the drag: times 1 − drag_fraction without it");
    }
    if (needs_them) remarks.push_back(fmt::format("a needs {}", fmt::join(missing, ", ")));
    AddParameter("stiffness", "σ", sigma, fmt::format("{}", fmt::join(remarks, ", ")));
  }

  /// Says whether an exponent is a theory's; a rig that is not told from the contact changes it.
  std::string ThirdText(std::string_view whose, bool is_rejected) const {
    const bool by_rig = fit_.FindFinding("shape_or_rig") != nullptr;
    return fmt::format("{} 1/3 {}{}", whose, is_rejected ? "is rejected" : "fits",
                       !by_rig       ? ""
                       : is_rejected ? " in a rigid rig"
                                     : " in a compliant rig");
  }

  void AddShape() {
    std::string remark;
    const AlphaTest& test = report_.alpha;
    if (test.is_rejected) {
      remark = ThirdText("Mindlin's", *test.is_rejected);
    } else if (test.minus_third && !IsInadequate(report_)) {
      remark = "Mindlin's 1/3 is not tested";
    }
    AddParameter("shape", "α", *fit_.Find("alpha"), remark);
  }

  void AddLoad() {
    const ParameterEstimate* exponent = fit_.Find("load_exponent");
    if (exponent == nullptr) return;
    std::string remark = fmt::format("σ and Tc are at the mean of {} loads", fit_.records.size());
    if (!report_.is_torsional() && exponent->is_known()) {
      remark = ThirdText("Hertz's", DeniesHertz(fit_)) + ", " + remark;
    }
    AddParameter("load", "σ ∝ N^p, p", *exponent, remark);
  }

  void AddTerms() {
    std::vector<std::string> terms;
    for (const ParameterEstimate* term : AddedTerms(report_)) {
      if (!IsMoot(report_, *term)) terms.push_back(TextOf(term->name, *term));
    }
    Add("terms", terms);
  }

  void AddLaw() {
    const auto& choice = fit_.law_choice;
    if (!choice || IsInadequate(report_)) return;
    const auto name = [](const models::FrictionModel& model) {
      return model.name == "dahl" ? "Dahl's own" : "Masing's";
    };
    const std::string laws = fmt::format("{}; {}", name(*fit_.model), name(*choice->alternative));
    std::string values;
    const auto add = [&](const char* symbol, const char* parameter, double value) {
      const ParameterEstimate& estimate = *fit_.Find(parameter);
      if (!WhatIsShown(estimate).is_estimate()) return;
      values += fmt::format("{}{} {}", values.empty() ? " (" : ", ", symbol,
                            Quantity(value, estimate.unit, 3));
    };
    add("σ", "sigma", choice->law.tangential_stiffness);
    add("Tc", "slip_force", choice->law.slip_force);
    if (!values.empty()) values += ')';
    if (!choice->decided()) {
      const double delta = choice->delta_aicc.value_or(0.0);
      std::string condition;
      if (std::abs(delta) >= report_.options.thresholds.undecided) {
        condition = fmt::format(", {} the first stroke began at a turn that is not recorded",
                                delta < 0 ? "unless" : "if");
      }
      const bool is_better = !condition.empty() && delta < 0;
      Add("law",
          fmt::format("{} fits {}{}{}", laws, is_better ? "better" : "as well", values, condition));
    } else if (choice->preferred == choice->alternative) {
      Add("law",
          fmt::format("{} fits better{}: --model {}", laws, values, choice->alternative->name),
          kPoor);
    } else {
      Add("law", fmt::format("{}, not {}", name(*fit_.model), name(*choice->alternative)), kGood);
    }
  }

  void AddMeasured() {
    const RecordFit& widest = fit_.WidestRecord();
    const loop::LoopFacts& facts = widest.facts;
    const Units& units = report_.units;
    const std::string amplitude = "±" + Quantity(facts.amplitude, units.displacement, 4);
    std::vector<std::string> parts = {amplitude, "±" + Quantity(facts.peak_force, units.force, 4),
                                      "no closed cycle"};
    if (facts.closed) {
      const std::optional<double>& error = facts.half_gap_standard_deviation;
      parts = {facts.half_gap ? "half gap " + QuantityWithError(*facts.half_gap, error, units.force)
                              : "",
               Quantity(facts.energy_per_cycle, "J", 4) + " a cycle", amplitude,
               fmt::format("{} closed cycle{}", facts.steady_cycles,
                           facts.steady_cycles == 1 ? "" : "s"),
               loop::Slides(facts) ? "it slides" : ""};
    }
    if (fit_.is_load_series() && widest.normal_load) {
      parts.push_back("at N = " + Quantity(*widest.normal_load, "N", 4));
    }
    Add("measured", parts);
  }

  void AddLeftOut() {
    std::vector<std::string> parts;
    for (const LeftOut& part : report_.left_out) {
      parts.push_back(part.first == 0 ? fmt::format("{} row{} ({})", part.samples,
                                                    part.samples == 1 ? "" : "s", part.why)
                      : part.first == part.last
                          ? fmt::format("line {} ({})", part.first, part.why)
                          : fmt::format("lines {} … {} ({})", part.first, part.last, part.why));
    }
    Add("left out", parts);
  }

  /// Names what explains most of the misfit, where no term fits it and there is no next step.
  void AddCause() {
    constexpr double kMost = 0.5;
    for (const identification::Cause& cause : fit_.adequacy.causes) {
      if (!cause.term.empty() || cause.explains < kMost) continue;
      return Add("looks like", CauseText(cause));
    }
  }

  /// Says what else a person should act on: of the record, where the model is inadequate.
  void AddRest() {
    for (const Finding& finding : fit_.findings) {
      const bool is_note = finding.severity == identification::Severity::kNote;
      const bool is_moot = IsInadequate(report_) && !finding.parameters.empty();
      if (is_note || is_moot || said_.contains(&finding) || IsSaidByALine(finding.code)) continue;
      Add("note", WarningText(finding, report_), kPoor);
    }
    for (const Warning& warning : report_.warnings) {
      if (warning.code == "contact_implausible") Add("note", warning.message, kPoor);
    }
  }

  const Report& report_;
  const FitResult& fit_;
  std::vector<Line> lines_;
  std::set<const Finding*> said_;
};

constexpr std::size_t kTextWidth = 100;
constexpr std::size_t kLabel = 14;  // where texts begin

std::string LinesText(const std::vector<Line>& lines) {
  std::string text;
  const std::string indent = '\n' + std::string(kLabel, ' ');
  for (const Line& line : lines) {
    // An interval is not broken.
    const std::string whole = boost::replace_all_copy(line.text, " … ", "\t…\t");
    text += fmt::format("{:<{}}{}\n", line.label, kLabel,
                        fmt::join(LinesOf(PartsOf(whole, ' '), kTextWidth - kLabel), indent));
  }
  std::ranges::replace(text, '\t', ' ');
  return text;
}

}  // namespace

std::string ColumnsText(const io::RecordFile& file, int force_sense) {
  std::vector<std::string> columns;
  const auto add = [&](const char* role, const io::ChosenColumn& column, const char* remark) {
    if (!column) return;
    const bool has_unit = !column.has_no_unit && column.name.find(column.unit) != std::string::npos;
    columns.push_back(fmt::format(
        "{}{} ({}{}){}{}{}", role, column.name.empty() ? "" : fmt::format(" '{}'", column.name),
        column.index, remark, has_unit ? "" : " in ", has_unit ? "" : column.unit,
        column.has_no_unit ? " (assumed)" : ""));
  };
  add(file.is_torsional ? "angle" : "displacement", file.displacement, "");
  add(file.is_torsional ? "torque" : "force", file.force, force_sense < 0 ? ", opposite sign" : "");
  add("load", file.normal_load, "");
  return fmt::format("{}", fmt::join(columns, ", "));
}

std::string MisfitStatement(const Report& report) {
  const FitResult& fit = report.fit;
  if (!fit.converged) return "not converged: " + fit.solver.message;
  const std::string_view unit = report.units.response;
  const std::string rms = Quantity(fit.residuals.rms, unit, 3);
  if (!IsJudged(report)) return rms + " rms; too few samples to judge the law";
  const Finding* unseen = fit.FindFinding("model_inadequate", "no_loop");
  if (unseen != nullptr) return Sentence(*unseen, fit, report.units);
  const identification::Adequacy& adequacy = fit.adequacy;
  if (adequacy.verdict == AdequacyVerdict::kAdequate) {
    return rms + " rms, like noise: the law describes the record";
  }
  std::string text = Quantity(adequacy.misfit, unit, 3);
  if (adequacy.misfit_over_half_gap) text += ", " + MisfitShare(*adequacy.misfit_over_half_gap);
  constexpr double kMostOfIt = 0.5;  // is the same at one place of every stroke
  if (fit.WidestRecord().structure.repeatable_share > kMostOfIt) text += ", alike in every stroke";
  if (adequacy.verdict == AdequacyVerdict::kDoubtful) {
    if (fit.FindFinding("search_limit") != nullptr &&
        adequacy.p_value >= report.options.thresholds.doubt) {
      return rms + " rms, like noise, but the search stopped at a limit of its own";
    }
    const bool is_included =
        std::ranges::any_of(fit.parameters, &ParameterEstimate::includes_discrepancy);
    return text + ": the law is not the whole story" +
           (is_included ? "; the intervals include it" : "");
  }
  const bool is_any_known = std::ranges::any_of(fit.parameters, [&](const auto& of) {
    return IsOfLaw(of.name) && WhatIsShown(of).is_estimate() && !IsMoot(report, of);
  });
  return text + ": the law does not describe the record" +
         (is_any_known ? "; what stands above is known" : "; use what is measured");
}

std::vector<Line> AnswerLines(const Report& report) { return Writer(report).Answer(); }

std::vector<Line> DetailLines(const Report& report) {
  std::vector<Line> lines;
  const FitResult& fit = report.fit;
  if (report.notes.size() > 1) {
    for (const std::string& note : report.notes) lines.push_back({"read as", note});
  }
  const Json document = DocumentOf(report);
  lines.push_back({"model", fmt::format("{}, initial state {}", fit.model->title,
                                        CellText(document["initial_state"]))});
  const std::vector<const ParameterEstimate*> terms = AddedTerms(report);
  for (const ParameterEstimate& estimate : fit.parameters) {
    const bool is_nothing = estimate.status == ParameterStatus::kFixed && estimate.value == 0;
    const bool is_said = std::ranges::find(terms, &estimate) != terms.end();
    if (IsOfLaw(estimate.name) || !estimate.is_known() || is_nothing || is_said) continue;
    lines.push_back({"parameter", fmt::format("{} {}", estimate.name, ValueText(estimate))});
  }
  for (const char* section : {"input", "measured", "adequacy", "residuals", "mapping", "solver"}) {
    std::vector<std::string> values;
    for (const auto& [name, value] : document[section].items()) {
      if (value.is_null() || value.is_structured()) continue;
      values.push_back(fmt::format("{} {}", WithBlanks(name), CellText(value, /*digits=*/4)));
    }
    if (!values.empty()) lines.push_back({section, fmt::format("{}", fmt::join(values, ", "))});
  }
  for (const identification::Cause& cause : fit.adequacy.causes) {
    lines.push_back({"looks like", CauseText(cause)});
  }
  for (const Finding& finding : fit.findings) {
    if (finding.severity != identification::Severity::kNote || IsSaidByALine(finding.code))
      continue;
    lines.push_back({"note", Sentence(finding, fit, report.units)});
  }
  return lines;
}

std::string ToText(const Report& report, Detail detail) {
  RequireFitted(report, "a text");
  std::string text = LinesText(AnswerLines(report));
  if (!report.compared.empty()) {
    text += fmt::format("\nmodels compared, rms in {}:\n{}", report.units.response,
                        TableText(ComparedModels(report)));
  }
  if (detail == Detail::kAll) text += '\n' + LinesText(DetailLines(report));
  return text;
}

}  // namespace mindahl::report
