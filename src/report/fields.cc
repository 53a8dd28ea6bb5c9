#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>

#include "mindahl/core/version.h"
#include "mindahl/identification/terms.h"
#include "report/json.h"
#include "report/statements.h"

namespace mindahl::report {

using identification::ParameterEstimate;
using identification::ParameterStatus;
using identification::RecordFit;

namespace {

template <typename Value>
Json JsonOf(const Value& value) {
  if constexpr (std::is_enum_v<Value>) {
    return Name(value);
  } else if constexpr (std::is_convertible_v<Value, std::optional<double>> &&
                       !std::is_integral_v<Value>) {
    return NumberOrNull(value);
  } else {
    return value;
  }
}

/// Returns a member of a member.
template <auto kFirst, auto... kMore, typename Whole>
decltype(auto) Member(const Whole& whole) {
  if constexpr (sizeof...(kMore) == 0) {
    return std::invoke(kFirst, whole);
  } else {
    return Member<kMore...>(std::invoke(kFirst, whole));
  }
}

template <auto... kMembers>
Json Of(const Report& report) {
  return JsonOf(Member<kMembers...>(report));
}

template <auto... kMembers>
Json OfResiduals(const Report& report) {
  return report.failed() ? Json() : JsonOf(Member<kMembers...>(report.fit.residuals));
}

template <auto... kMembers>
Json OfAdequacy(const Report& report) {
  return IsJudged(report) ? JsonOf(Member<kMembers...>(report.fit.adequacy)) : Json();
}

/// Returns a fact of the widest record; null where that closes no cycle.
template <auto... kMembers>
Json OfCycles(const Report& report) {
  if (report.failed() || !report.fit.WidestRecord().facts.closed) return nullptr;
  return JsonOf(Member<kMembers...>(report.fit.WidestRecord().facts));
}

/// Returns the same, else what is measured without a closed cycle.
template <auto kFact, auto kMeasure>
Json OfLoop(const Report& report) {
  if (report.failed()) return nullptr;
  const RecordFit& widest = report.fit.WidestRecord();
  return NumberOrNull(widest.facts.closed ? widest.facts.*kFact : widest.measures.*kMeasure);
}

constexpr std::string_view kNotClosed = "no cycle is closed";
constexpr std::string_view kNotJudged =
    "there are too few samples to identify anything in addition to the model";

// --- input

Json ColumnJson(const io::ChosenColumn* column) {
  if (column == nullptr || column->index == 0) return nullptr;
  return {{"name", column->name}, {"index", column->index}, {"unit", column->unit}};
}

Json Columns(const Report& report) {
  const io::RecordFile& first = report.records.front();
  return {{"displacement", ColumnJson(&first.displacement)},
          {"force", ColumnJson(&first.force)},
          {"time", ColumnJson(first.time ? &*first.time : nullptr)},
          {"normal_load", ColumnJson(first.normal_load ? &*first.normal_load : nullptr)}};
}

/// Returns the sum over the records of what one of them has.
template <auto... kMembers>
Json SumOver(const Report& report) {
  std::size_t sum = 0;
  for (const RecordFit& record : report.fit.records) sum += Member<kMembers...>(record);
  return sum;
}

Json Samples(const Report& report) {
  std::size_t samples = 0;
  for (const io::RecordFile& file : report.records) {
    samples += file.record.size() + (file.piece ? file.piece->left_out : 0);
  }
  for (const LeftOut& part : report.left_out) samples += part.samples;
  return samples;
}

Json LeftOutJson(const Report& report) {
  const auto line = [](std::size_t number) { return number > 0 ? Json(number) : Json(); };
  return ListOf(DescribeLeftOut(report), [&](const LeftOut& part) -> Json {
    return {{"file", part.file},
            {"samples", part.samples},
            {"first", line(part.first)},
            {"last", line(part.last)},
            {"why", part.why}};
  });
}

// --- parameters

/// True where a value is only where the search ended: at a limit of the program's own.
bool IsAtOwnLimit(const ParameterEstimate& estimate) {
  return (estimate.status == ParameterStatus::kAtLowerBound ||
          estimate.status == ParameterStatus::kAtUpperBound) &&
         estimate.identifiability == identification::Identifiability::kNotIdentifiable;
}

Json Parameters(const Report& report) {
  Json parameters = Json::object();
  for (const ParameterEstimate& estimate : report.fit.parameters) {
    const bool is_at_limit = IsAtOwnLimit(estimate);
    const auto unless_at_limit = [&](std::optional<double> value) {
      return is_at_limit ? Json() : NumberOrNull(value);
    };
    parameters[estimate.name] = {
        {"value", unless_at_limit(estimate.value)},
        {"unit", estimate.unit},
        {"ci95", {unless_at_limit(estimate.lower95), unless_at_limit(estimate.upper95)}},
        {"standard_error", unless_at_limit(estimate.standard_error)},
        {"status", Name(estimate.status)},
        {"identifiability", Name(estimate.identifiability)}};
  }
  return parameters;
}

Json Correlations(const Report& report) {
  const auto& parameters = report.fit.parameters;
  const std::vector<double>& correlation = report.fit.correlation;
  Json matrix = Json::object();
  if (correlation.size() != parameters.size() * parameters.size()) return matrix;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    Json row = Json::object();
    for (std::size_t j = 0; j < parameters.size(); ++j) {
      row[parameters[j].name] = NumberOrNull(correlation[i * parameters.size() + j]);
    }
    matrix[parameters[i].name] = std::move(row);
  }
  return matrix;
}

// --- adequacy and what is measured

Json Causes(const Report& report) {
  return ListOf(report.fit.adequacy.causes, [](const identification::Cause& cause) -> Json {
    return {{"code", cause.code},
            {"term", cause.term.empty() ? Json() : Json(cause.term)},
            {"delta_aicc", NumberOrNull(cause.delta_aicc)},
            {"explains", NumberOrNull(cause.explains)}};
  });
}

Json MeasuredCycles(const Report& report) {
  if (report.failed()) return Json::array();
  return ListOf(report.fit.WidestRecord().facts.cycles, [](const loop::CycleFacts& cycle) -> Json {
    return {{"start", cycle.start},
            {"amplitude", NumberOrNull(cycle.amplitude)},
            {"peak_force", NumberOrNull(cycle.peak_force)},
            {"half_gap", NumberOrNull(cycle.half_gap)},
            {"energy", NumberOrNull(cycle.energy)},
            {"energy_ratio", NumberOrNull(cycle.energy_ratio)}};
  });
}

// --- law, contact, terms

Json Alternatives(const Report& report) {
  const auto& choice = report.fit.law_choice;
  if (!choice) return Json::array();
  Json law = {{"law", choice->alternative->name}};
  law.update(LawJson(choice->law));
  return Json::array({std::move(law)});
}

Json Contact(const Report& report) {
  Json contact = Json::object();
  for (const ContactQuantity& quantity : report.contact) {
    contact[std::string(quantity.name)] = {
        {"value", NumberOrNull(quantity.value)},
        {"ci95", {NumberOrNull(quantity.lower), NumberOrNull(quantity.upper)}},
        {"unit", quantity.unit}};
  }
  return contact;
}

constexpr std::string_view kNotTested =
    "alpha is held, at a bound or not identifiable, or it is a torque";

Json ConsideredTerms(const Report& report) {
  if (!report.terms) return Json::array();
  return ListOf(report.terms->considered, [](const identification::ConsideredTerm& term) -> Json {
    return {{"name", term.name},
            {"gain", NumberOrNull(term.gain)},
            {"added", term.added},
            {"refused", term.obstacle}};
  });
}

Json Next(const Report& report) {
  if (!report.next) return nullptr;
  return {{"text", report.next->text},
          {"options", report.next->options},
          {"misfit_before", report.next->misfit_before},
          {"misfit_after", report.next->misfit_after}};
}

/// Reasons of nulls by the path of a value or of an object that has it.
std::vector<std::pair<std::string, std::string>> ReasonsOf(const Report& report) {
  std::vector<std::pair<std::string, std::string>> reasons;
  if (report.failed()) {
    reasons.emplace_back("", "the fit failed: " + report.fit.solver.message);
    return reasons;
  }
  reasons.emplace_back("", "not a finite number");
  for (const Field& field : Fields()) {
    if (!field.why_null.empty()) reasons.emplace_back(field.path, field.why_null);
  }
  for (const ParameterEstimate& estimate : report.fit.parameters) {
    const std::string path = "parameters." + estimate.name;
    reasons.emplace_back(path, IsAtOwnLimit(estimate) ? "the search stopped at its own limit"
                               : estimate.status == ParameterStatus::kFixed
                                   ? "it is held"
                                   : "the record does not determine it");
  }
  for (const ContactQuantity& quantity : report.contact) {
    reasons.emplace_back(fmt::format("contact.{}", quantity.name), quantity.why);
  }
  return reasons;
}

/// Adds a place for every null of a value, each with the reason of the longest path to it.
void FindNulls(const Json& value, const std::string& path,
               const std::vector<std::pair<std::string, std::string>>& reasons, Json& nulls) {
  if (value.is_object()) {
    for (const auto& [key, member] : value.items()) {
      FindNulls(member, path.empty() ? key : fmt::format("{}.{}", path, key), reasons, nulls);
    }
  } else if (value.is_array()) {
    for (std::size_t k = 0; k < value.size(); ++k) {
      FindNulls(value[k], fmt::format("{}[{}]", path, k), reasons, nulls);
    }
  } else if (value.is_null()) {
    const std::pair<std::string, std::string>* best = &reasons.front();
    for (const auto& reason : reasons) {
      const bool leads = path.starts_with(reason.first) &&
                         (reason.first.size() == path.size() || path[reason.first.size()] == '.' ||
                          path[reason.first.size()] == '[');
      if (leads && reason.first.size() > best->first.size()) best = &reason;
    }
    nulls.push_back({{"path", path}, {"why", best->second}});
  }
}

}  // namespace

const std::vector<Field>& Fields() {
  using R = const Report&;
  using identification::Adequacy;
  using identification::FitResult;
  using identification::ResidualStatistics;
  using identification::SolverReport;
  using loop::LoopFacts;
  using loop::LoopMeasures;
  static const std::vector<Field> fields = {
      {"schema", "", "mindahl.fit/2", [](R) { return Json("mindahl.fit/2"); }},
      {"version", "", "of the program", [](R) { return Json(Version()); }},
      {"input.files", "", "names of the records", Of<&Report::files>},
      {"input.columns", "",
       "`name`, `index` from 1 and `unit` of displacement, force, time and normal_load in the "
       "first "
       "file",
       Columns, "the file has none, or it is not used"},
      {"input.samples", "", "samples of all files, including those that do not count", Samples},
      {"input.cycles", "", "complete cycles of all records",
       SumOver<&RecordFit::measures, &LoopMeasures::cycles>},
      {"input.reversals", "", "turning points of all records",
       SumOver<&RecordFit::reversals, &std::vector<std::size_t>::size>},
      {"input.left_out", "",
       "samples that do not count: `file`, `samples`, `first` and `last` line, `why`", LeftOutJson,
       "they are not in a row"},
      {"model", "", "the law that was fitted",
       [](R report) { return Json(report.fit.model->name); }},
      {"initial_state", "", "`virgin`, `steady` or `mixed`",
       [](R report) {
         return Json(report.fit.has_mixed_states() ? "mixed" : Name(report.fit.initial_state));
       }},
      {"parameters", "",
       "by name: `value`, `unit`, `ci95`, `standard_error`, `status`, `identifiability`",
       Parameters},
      {"correlation", "-", "of the errors of two parameters, by their names", Correlations,
       "one of the two is not fitted, or has no error"},
      {"residuals.rms", "response", "rms of fitted less measured",
       OfResiduals<&ResidualStatistics::rms>},
      {"residuals.max_abs", "response", "the largest", OfResiduals<&ResidualStatistics::max_abs>},
      {"residuals.r_squared", "-", "fraction of the variance that the fit explains",
       OfResiduals<&ResidualStatistics::r_squared>},
      {"residuals.durbin_watson", "-", "2 of white residuals, towards 0 of autocorrelated ones",
       OfResiduals<&ResidualStatistics::durbin_watson>},
      {"residuals.effective_samples", "-", "independent samples of equal information",
       OfResiduals<&ResidualStatistics::effective_samples>},
      {"solver.solver", "", "`tiny_solver` or `solve` of Ceres, `none`",
       Of<&Report::fit, &FitResult::solver, &SolverReport::solver>},
      {"solver.termination", "", "as Ceres reports it",
       Of<&Report::fit, &FitResult::solver, &SolverReport::termination>},
      {"solver.converged", "", "true if the search converged",
       Of<&Report::fit, &FitResult::converged>},
      {"solver.iterations", "", "of all searches from the best start",
       Of<&Report::fit, &FitResult::solver, &SolverReport::iterations>},
      {"solver.final_cost", "response²", "half the weighted sum of squares",
       Of<&Report::fit, &FitResult::solver, &SolverReport::final_cost>},
      {"adequacy.verdict", "", "`adequate`, `doubtful` or `inadequate`",
       OfAdequacy<&Adequacy::verdict>, kNotJudged},
      {"adequacy.use", "",
       "`quantitative` up to 5 % of misfit over half gap, `indicative` up to 15 %, `none`",
       OfAdequacy<&Adequacy::use>, kNotJudged},
      {"adequacy.p_value", "-", "probability of such residuals from noise alone",
       OfAdequacy<&Adequacy::p_value>, kNotJudged},
      {"adequacy.misfit_over_noise", "-", "rms of what the model misses over that of the noise",
       OfAdequacy<&Adequacy::misfit_over_noise>, kNotJudged},
      {"adequacy.misfit_over_half_gap", "-", "the same over the measured half gap",
       OfAdequacy<&Adequacy::misfit_over_half_gap>, "it is not judged, or no half gap is measured"},
      {"adequacy.causes", "",
       "terms that the residuals look like: `code`, `term`, `delta_aicc`, `explains`", Causes,
       "no term takes it into account"},
      {"measured.half_gap.value", "N", "half the force between the strokes, at their middle",
       OfCycles<&LoopFacts::half_gap>, kNotClosed},
      {"measured.half_gap.standard_deviation", "N", "between cycles",
       OfCycles<&LoopFacts::half_gap_standard_deviation>,
       "there are fewer than two cycles of the widest amplitude"},
      {"measured.amplitude", "m", "half the travel of the widest cycles",
       OfLoop<&LoopFacts::amplitude, &LoopMeasures::amplitude>},
      {"measured.peak_force", "N", "half the range of the force",
       OfLoop<&LoopFacts::peak_force, &LoopMeasures::peak_force>},
      {"measured.energy_per_cycle", "J", "enclosed by a cycle",
       OfCycles<&LoopFacts::energy_per_cycle>, kNotClosed},
      {"measured.energy_ratio", "-", "energy over 4·amplitude·peak force",
       OfCycles<&LoopFacts::energy_ratio>, kNotClosed},
      {"measured.asymmetry", "-", "distance of one stroke from the other turned about the centre",
       OfCycles<&LoopFacts::asymmetry>, kNotClosed},
      {"measured.slides", "", "true if the loop slides",
       [](R report) {
         return report.failed() ? Json() : Json(loop::Slides(report.fit.WidestRecord().facts));
       }},
      {"measured.cycles", "",
       "each cycle of the widest record: `start`, `amplitude`, `peak_force`, `half_gap`, `energy`, "
       "`energy_ratio`",
       MeasuredCycles, "the cycle does not show it"},
      {"law.decided", "", "true if the record distinguishes Masing's law and Dahl's own",
       [](R report) { return Json(report.fit.law_choice && report.fit.law_choice->decided); }},
      {"law.preferred", "", "`mindlin-dahl` or `dahl`",
       [](R report) {
         const auto& choice = report.fit.law_choice;
         return choice && choice->preferred != nullptr ? Json(choice->preferred->name) : Json();
       },
       "the record does not distinguish the laws, or they are not compared"},
      {"law.alternatives", "", "the other law: `law`, `sigma`, `alpha`, `slip_force`",
       Alternatives},
      {"law.delta_aicc", "-", "AICc of the other law less that of the fitted one",
       [](R report) {
         const auto& choice = report.fit.law_choice;
         return choice ? NumberOrNull(choice->delta_aicc) : Json();
       },
       "both give the same steady loop of one amplitude, or they are not compared"},
      {"contact", "", "by name: `value`, `ci95`, `unit`; empty of a torque", Contact},
      {"mapping.alpha_minus_third", "-", "α − 1/3", Of<&Report::alpha, &AlphaTest::minus_third>,
       kNotTested},
      {"mapping.p_value", "-", "two-sided p-value of α = 1/3",
       Of<&Report::alpha, &AlphaTest::p_value>, kNotTested},
      {"mapping.sigma_over_hertz_mindlin", "-", "σ/(8a/G*)",
       [](R report) { return NumberOrNull(report.ValueOf("sigma_over_hertz_mindlin")); },
       "as of contact.sigma_over_hertz_mindlin; not of a torque"},
      {"terms.mode", "", "`none`, `auto` or `named`",
       [](R report) {
         if (report.terms && !report.terms->considered.empty()) return Json("auto");
         return Json(AddedTerms(report).empty() ? "none" : "named");
       }},
      {"terms.considered", "", "`name`, `gain`, `added`, `refused` for what reason, or empty",
       ConsideredTerms},
      {"terms.added", "", "names of the parameters in addition to the law's",
       [](R report) {
         return ListOf(AddedTerms(report), [](const auto* term) -> Json { return term->name; });
       }},
      {"compared", "",
       "by `--compare`, the best first: `model`, `rig`, `delta_aicc`, `rms` and `held_out_rms` in "
       "the force's unit",
       ComparedModels, "there are no cycles to hold out, or a fit without them failed"},
      {"next", "",
       "`text`, `options`, `misfit_before`, `misfit_after` over the half gap, of what was tried",
       Next, "nothing that was tried helps by a tenth"},
      {"confidence", "-", "of every interval", Of<&Report::fit, &FitResult::confidence>},
      {"warnings", "", "`code` and `message` of what a person should act on",
       [](R report) {
         return ListOf(report.warnings, [](const Warning& warning) -> Json {
           return {{"code", warning.code}, {"message", warning.message}};
         });
       }},
  };
  return fields;
}

std::string Document(std::string_view schema, const Json& members) {
  Json document = {{"schema", schema}, {"version", Version()}};
  document.update(members);
  return Dump(document);
}

std::string ToJson(const Report& report) {
  Json document;
  for (const Field& field : Fields()) {
    std::string path(field.path);
    std::ranges::replace(path, '.', '/');
    document[Json::json_pointer("/" + path)] = field.get(report);
  }
  Json nulls = Json::array();
  FindNulls(document, "", ReasonsOf(report), nulls);
  document["nulls"] = std::move(nulls);
  return Dump(document);
}

std::vector<std::string> ValuesUnder(const Report& report, std::string_view section) {
  std::vector<std::string> values;
  for (const Field& field : Fields()) {
    if (!field.path.starts_with(section)) continue;
    const Json value = field.get(report);
    if (value.is_null() || value.is_structured()) continue;
    constexpr std::string_view kResponse = "response";
    std::string unit = UnitIn(report.units, field.unit);
    if (unit.starts_with(kResponse)) unit.replace(0, kResponse.size(), report.units.response);
    std::string name(field.path.substr(std::min(section.size() + 1, field.path.size())));
    std::ranges::replace(name, '_', ' ');
    std::ranges::replace(name, '.', ' ');
    values.push_back(fmt::format("{}{}{}", name, name.empty() ? "" : " ",
                                 field.path.ends_with("p_value")
                                     ? ChanceText(value.get<double>()).substr(2)
                                 : value.is_number_float() ? Quantity(value.get<double>(), unit, 4)
                                                           : CellText(value)));
  }
  return values;
}

Json ComparedModels(const Report& report) {
  std::vector<identification::ModelScore> scores = report.compared;
  std::erase_if(scores, [](const auto& score) { return !score.converged; });
  std::ranges::sort(scores, {}, &identification::ModelScore::delta_aicc);
  return ListOf(scores, [](const auto& score) -> Json {
    return {{"model", score.model->name},
            {"rig", score.rig},
            {"delta_aicc", score.delta_aicc},
            {"rms", score.rms},
            {"held_out_rms", NumberOrNull(score.held_out_rms)}};
  });
}

std::vector<LeftOut> DescribeLeftOut(const Report& report) {
  std::vector<LeftOut> parts = report.left_out;
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const io::RecordFile& file = report.records[r];
    const RecordFit& fit = report.fit.records[r];
    const auto add = [&](std::size_t samples, std::size_t first, bool are_in_a_row,
                         const char* why) {
      const auto line = [&](std::size_t sample) { return are_in_a_row ? file.LineOf(sample) : 0; };
      if (samples == 0) return;
      parts.push_back({.file = report.files[r],
                       .samples = samples,
                       .first = line(first),
                       .last = line(first + samples - 1),
                       .why = why});
    };
    const std::size_t faults = fit.glitches.total;
    const std::size_t rest = fit.left_out - std::min(fit.left_out, faults);
    const auto first = std::ranges::find(fit.counts, 0);
    const auto last =
        std::find_if(first, fit.counts.end(), [](auto counts) { return counts != 0; });
    add(faults, fit.glitches.first, faults == 1, "faults");
    add(rest, static_cast<std::size_t>(first - fit.counts.begin()),
        faults == 0 && static_cast<std::size_t>(last - first) == rest, "selection");
    add(file.piece ? file.piece->left_out : 0, 0, /*are_in_a_row=*/false, "another load");
  }
  return parts;
}

std::vector<const ParameterEstimate*> AddedTerms(const Report& report) {
  std::vector<const ParameterEstimate*> terms;
  for (const ParameterEstimate& estimate : report.fit.parameters) {
    const std::string_view name = identification::TermNameOf(estimate.name);
    constexpr auto kOfEveryFit = std::to_array<std::string_view>(
        {"sigma", "alpha", "slip_force", "load_exponent", "force_offset", "displacement_offset"});
    if (std::ranges::find(kOfEveryFit, name) != kOfEveryFit.end()) continue;
    // Reported of every fit, as 0 where it is not fitted.
    const bool is_none = estimate.status == ParameterStatus::kFixed &&
                         (estimate.value == 0.0 || std::isinf(estimate.value)) &&
                         !report.options.fixed.contains(std::string(name));
    if (!is_none) terms.push_back(&estimate);
  }
  return terms;
}

}  // namespace mindahl::report
