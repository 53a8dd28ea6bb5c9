#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "mindahl/core/version.h"
#include "mindahl/identification/terms.h"
#include "report/json.h"
#include "report/statements.h"

// Makes the JSON of a fit. docs/schema/fit.json says what each of its members is, and in what unit.
namespace mindahl::report {

namespace {

Json ColumnJson(const io::ChosenColumn& column) {
  if (!column) return nullptr;
  return {{"name", column.name}, {"index", column.index}, {"unit", column.unit}};
}

/// Returns the members, those of a part that there is not as null and its lists empty.
Json If(bool there_is, Json members) {
  if (there_is) return members;
  for (Json& member : members) {
    member = member.is_object() ? If(false, member) : member.is_array() ? Json::array() : Json();
  }
  return members;
}

Json Parameters(const Report& report) {
  Json parameters = Json::object();
  for (const ParameterEstimate& estimate : report.fit.parameters) {
    // The value at a bound that determines nothing is the bound's: it is not reported.
    const bool is_at_limit =
        estimate.is_at_bound() && estimate.identifiability == Identifiability::kNotIdentifiable;
    const auto number = [&](std::optional<double> value) {
      return is_at_limit ? Json() : NumberOrNull(value);
    };
    parameters[estimate.name] = {{"value", number(estimate.value)},
                                 {"unit", estimate.unit},
                                 {"ci95", {number(estimate.lower95), number(estimate.upper95)}},
                                 {"standard_error", number(estimate.standard_error)},
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

Json MeasuredJson(const Report& report) {
  const loop::LoopFacts& facts = report.fit.WidestRecord().facts;
  const auto if_closed = [&](std::optional<double> value) {
    return facts.closed ? NumberOrNull(value) : Json();
  };
  return If(!report.failed(),
            {{"half_gap",
              {{"value", if_closed(facts.half_gap)},
               {"standard_deviation", if_closed(facts.half_gap_standard_deviation)}}},
             {"amplitude", NumberOrNull(facts.amplitude)},
             {"peak_force", NumberOrNull(facts.peak_force)},
             {"energy_per_cycle", if_closed(facts.energy_per_cycle)},
             {"energy_ratio", if_closed(facts.energy_ratio)},
             {"asymmetry", if_closed(facts.asymmetry)},
             {"slides", loop::Slides(facts)},
             {"cycles", ListOf(facts.cycles, [](const loop::CycleFacts& cycle) -> Json {
                return {{"start", cycle.start},
                        {"amplitude", NumberOrNull(cycle.amplitude)},
                        {"peak_force", NumberOrNull(cycle.peak_force)},
                        {"half_gap", NumberOrNull(cycle.half_gap)},
                        {"energy", NumberOrNull(cycle.energy)},
                        {"energy_ratio", NumberOrNull(cycle.energy_ratio)}};
              })}});
}

Json AdequacyJson(const Report& report) {
  const identification::Adequacy& adequacy = report.fit.adequacy;
  return If(IsJudged(report),
            {{"verdict", Name(adequacy.verdict)},
             {"use", Name(adequacy.use)},
             {"p_value", NumberOrNull(adequacy.p_value)},
             {"misfit_over_noise", NumberOrNull(adequacy.misfit_over_noise)},
             {"misfit_over_half_gap", NumberOrNull(adequacy.misfit_over_half_gap)},
             {"causes", ListOf(adequacy.causes, [](const identification::Cause& cause) -> Json {
                return {{"code", cause.code},
                        {"term", cause.term.empty() ? Json() : Json(cause.term)},
                        {"delta_aicc", NumberOrNull(cause.delta_aicc)},
                        {"explains", NumberOrNull(cause.explains)}};
              })}});
}

Json LawChoiceJson(const std::optional<identification::LawChoice>& choice) {
  Json alternatives = Json::array();
  if (choice) {
    alternatives.push_back({{"law", choice->alternative->name}});
    alternatives.back().update(LawJson(choice->law));
  }
  const bool prefers = choice && choice->preferred != nullptr;
  return {{"decided", choice && choice->decided()},
          {"preferred", prefers ? Json(choice->preferred->name) : Json()},
          {"alternatives", std::move(alternatives)},
          {"delta_aicc", choice ? NumberOrNull(choice->delta_aicc) : Json()}};
}

Json ContactJson(const Report& report) {
  Json contact = Json::object();
  for (const ContactQuantity& quantity : report.contact) {
    contact[std::string(quantity.name)] = {
        {"value", NumberOrNull(quantity.value)},
        {"ci95", {NumberOrNull(quantity.lower), NumberOrNull(quantity.upper)}},
        {"unit", quantity.unit}};
  }
  return contact;
}

Json TermsJson(const Report& report) {
  Json considered = Json::array();
  if (report.terms) {
    considered = ListOf(report.terms->considered, [](const auto& term) -> Json {
      return {{"name", term.name},
              {"gain", NumberOrNull(term.gain)},
              {"added", term.added},
              {"refused", term.obstacle}};
    });
  }
  Json added = ListOf(AddedTerms(report), [](const auto* term) -> Json { return term->name; });
  const char* const mode = report.terms ? "auto" : added.empty() ? "none" : "named";
  return {{"mode", mode}, {"considered", std::move(considered)}, {"added", std::move(added)}};
}

/// Reasons of nulls by the path of a value or of an object that has it.
using Reasons = std::map<std::string, std::string>;

Reasons ReasonsOf(const Report& report) {
  if (report.failed()) return {{"", "the fit failed: " + report.fit.solver.message}};
  return {
      {"", "not a finite number"},
      {"input.columns", "the file has none, or it is not used"},
      {"input.left_out", "they are not in a row, or no samples"},
      {"correlation", "one of the two is not fitted, or has no error"},
      {"parameters", "it is held, or the record does not determine it"},
      {"adequacy", "it is not judged, or no half gap is measured"},
      {"adequacy.causes", "no term takes it into account"},
      {"measured", "no cycle shows it, or fewer than two"},
      {"law", "the record does not distinguish the laws, or they are not compared"},
      {"contact",
       "it needs what is not known of the contact, or follows from a parameter that is open or at "
       "a bound that was given"},
      {"contact.normal_load.ci95", "it is exact, or not known"},
      {"mapping.sigma_over_hertz_mindlin",
       "it needs what is not known of the contact, or sigma is open"},
      {"mapping",
       "alpha is held, at a bound, not identifiable or bounded away from 1/3, or it is a torque"},
      {"compared", "there are no cycles to hold out, or a fit without them failed"},
      {"next", "nothing that was tried helps by a tenth"}};
}

/// Adds a place for every null of a value, with the reason of the longest path that leads there.
void FindNulls(const Json& value, const std::string& path, std::string why, const Reasons& reasons,
               Json& nulls) {
  if (const auto own = reasons.find(path); own != reasons.end()) why = own->second;
  if (value.is_null()) nulls.push_back({{"path", path}, {"why", why}});
  if (!value.is_structured()) return;
  for (const auto& [key, member] : value.items()) {
    FindNulls(member,
              value.is_array() ? fmt::format("{}[{}]", path, key)
              : path.empty()   ? key
                               : fmt::format("{}.{}", path, key),
              why, reasons, nulls);
  }
}

}  // namespace

std::string Document(std::string_view schema, const Json& members) {
  Json document = {{"schema", schema}, {"version", Version()}};
  document.update(members);
  return Dump(document);
}

Json DocumentOf(const Report& report) {
  const FitResult& fit = report.fit;
  const identification::ResidualStatistics& residuals = fit.residuals;
  const io::RecordFile& first = report.records.front();
  const std::optional<NextStep>& next = report.next;
  std::size_t cycles = 0;
  std::size_t reversals = 0;
  for (const RecordFit& record : fit.records) {
    cycles += record.facts.complete_cycles;
    reversals += record.reversals.size();
  }
  Json document = {
      {"input",
       {{"files", report.files()},
        {"columns",
         {{"displacement", ColumnJson(first.displacement)},
          {"force", ColumnJson(first.force)},
          {"time", ColumnJson(first.time)},
          {"normal_load", ColumnJson(first.normal_load)}}},
        {"samples", report.samples},
        {"cycles", cycles},
        {"reversals", reversals},
        {"left_out", ListOf(report.left_out,
                            [](const LeftOut& part) -> Json {
                              return {{"file", part.file},
                                      {"samples", part.samples},
                                      {"first", part.first > 0 ? Json(part.first) : Json()},
                                      {"last", part.last > 0 ? Json(part.last) : Json()},
                                      {"why", part.why}};
                            })}}},
      {"model", fit.model->name},
      {"initial_state", Name(fit.initial_state)},
      {"parameters", Parameters(report)},
      {"correlation", Correlations(report)},
      {"residuals",
       If(!report.failed(), {{"rms", NumberOrNull(residuals.rms)},
                             {"max_abs", NumberOrNull(residuals.max_abs)},
                             {"r_squared", NumberOrNull(residuals.r_squared)},
                             {"durbin_watson", NumberOrNull(residuals.durbin_watson)},
                             {"effective_samples", NumberOrNull(residuals.effective_samples)}})},
      {"solver",
       {{"solver", fit.solver.solver},
        {"termination", fit.solver.termination},
        {"converged", fit.converged},
        {"iterations", fit.solver.iterations},
        {"final_cost", report.failed() ? Json() : NumberOrNull(fit.solver.final_cost)}}},
      {"adequacy", AdequacyJson(report)},
      {"measured", MeasuredJson(report)},
      {"law", LawChoiceJson(fit.law_choice)},
      {"contact", ContactJson(report)},
      {"mapping",
       {{"alpha_minus_third", NumberOrNull(report.alpha.minus_third)},
        {"p_value", NumberOrNull(report.alpha.p_value)},
        {"sigma_over_hertz_mindlin", NumberOrNull(report.ValueOf("sigma_over_hertz_mindlin"))}}},
      {"terms", TermsJson(report)},
      {"compared", ComparedModels(report)},
      {"next", next ? Json{{"text", next->text},
                           {"options", next->options},
                           {"misfit_before", next->misfit_before},
                           {"misfit_after", next->misfit_after}}
                    : Json()},
      {"confidence", fit.confidence},
      {"warnings", ListOf(report.warnings, [](const Warning& warning) -> Json {
         return {{"code", warning.code}, {"message", warning.message}};
       })}};
  Json nulls = Json::array();
  FindNulls(document, "", "", ReasonsOf(report), nulls);
  document["nulls"] = std::move(nulls);
  return document;
}

std::string ToJson(const Report& report) { return Document("mindahl.fit/2", DocumentOf(report)); }

Json ComparedModels(const Report& report) {
  std::vector<identification::ModelScore> scores = report.compared;
  std::ranges::sort(scores, {}, &identification::ModelScore::delta_aicc);
  return ListOf(scores, [](const auto& score) -> Json {
    return {{"model", score.model->name},
            {"rig", score.rig},
            {"delta_aicc", score.delta_aicc},
            {"rms", score.rms},
            {"held_out_rms", NumberOrNull(score.held_out_rms)}};
  });
}

std::vector<const ParameterEstimate*> AddedTerms(const Report& report) {
  std::vector<const ParameterEstimate*> terms;
  for (const ParameterEstimate& estimate : report.fit.parameters) {
    const bool is_column = estimate.name.starts_with(identification::NameOfCovariate(""));
    const std::string_view name =
        is_column ? estimate.name : identification::TermNameOf(estimate.name);
    constexpr auto kOfEveryFit = std::to_array<std::string_view>(
        {"sigma", "alpha", "slip_force", "load_exponent", "force_offset", "displacement_offset"});
    if (std::ranges::find(kOfEveryFit, name) != kOfEveryFit.end()) continue;
    const bool is_none = estimate.status == ParameterStatus::kFixed &&
                         !report.options.fixed.contains(std::string(name));
    if (!is_none) terms.push_back(&estimate);
  }
  return terms;
}

}  // namespace mindahl::report
