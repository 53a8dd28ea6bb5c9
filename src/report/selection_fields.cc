#include "report/field_table.h"

namespace mindahl::report {

using identification::ModelScore;

namespace {

std::string WhyNoScore(const ModelScore&) { return "this model has no fit to the record"; }

std::string WhyNothingHeldOut(const ModelScore& score) {
  return score.redundant ? "redundant: a simpler model is the same"
                         : "there is no cycle to hold out, or the fit without it failed";
}

const std::vector<Field<ModelScore>>& ScoreFields() {
  using Item = ModelScore;
  static const std::vector<Field<Item>> fields = {
      {"model", "", "name of the model", [](const Item& item) { return Text(item.model->name); }},
      {"rig", "", "with a fitted spring in series",
       [](const Item& item) { return Flag(item.rig); }},
      {"free_parameters", "", "number of free parameters",
       [](const Item& item) { return Count(item.free_parameters); }},
      {"rms", "N", "root mean square residual of the samples that are scored",
       [](const Item& item) { return Number(item.rms); }, WhyNoScore},
      {"aicc", "-", "AICc on effective samples", [](const Item& item) { return Number(item.aicc); },
       WhyNoScore},
      {"delta_aicc", "-", "AICc above the least",
       [](const Item& item) { return Number(item.delta_aicc); }, WhyNoScore},
      {"akaike_weight", "-", "exp(−ΔAICc/2) over its sum",
       [](const Item& item) { return Number(item.akaike_weight); }, WhyNoScore},
      {"held_out_rms", "N", "error of predicting cycles held out",
       [](const Item& item) { return Number(item.held_out_rms); }, WhyNothingHeldOut},
      {"held_out_standard_error", "N", "standard error of held_out_rms",
       [](const Item& item) { return Number(item.held_out_standard_error); }, WhyNothingHeldOut},
      {"converged", "", "whether the fit converged",
       [](const Item& item) { return Flag(item.converged); }},
      {"at_bound", "", "a free parameter ran to a bound",
       [](const Item& item) { return Flag(item.at_bound); }},
      {"redundant", "", "the same as a simpler model",
       [](const Item& item) { return Flag(item.redundant); }},
      {"remark", "", "what else is to be known; may be empty",
       [](const Item& item) { return Text(item.remark); }},
  };
  return fields;
}

const std::vector<Field<identification::ModelSelection>>& SelectionFields() {
  using Item = identification::ModelSelection;
  static const std::vector<Field<Item>> fields = {
      {"chosen", "", "the reported one: its place in models",
       [](const Item& item) { return Count(item.chosen); }},
      {"indistinguishable", "",
       "models that the record does not distinguish from it, simplest first",
       [](const Item& item) {
         Value::Array places;
         for (const std::size_t place : item.indistinguishable) places.push_back(Count(place));
         return Value{std::move(places)};
       }},
      {"effective_samples", "-", "effective samples of AICc",
       [](const Item& item) { return Number(item.effective_samples); },
       [](const Item&) { return std::string("no model has a fit to the record"); }},
      {"held_out_cycles", "", "cycles held out, each predicted once",
       [](const Item& item) { return Count(item.held_out_cycles); }},
      {"verdict", "", "the choice in words", [](const Item& item) { return Text(item.verdict); }},
      {"models", "", "every model without, then with a rig",
       [](const Item& item) { return List(ScoreFields(), item.scores); }},
  };
  return fields;
}

const std::vector<Field<identification::ConsideredTerm>>& ConsideredTermFields() {
  using Item = identification::ConsideredTerm;
  static const std::vector<Field<Item>> fields = {
      {"name", "", "of the term", [](const Item& item) { return Text(item.name); }},
      {"gain", "-",
       "fraction by which the rms error of prediction falls with it to first order; of one that is "
       "added, by which the rms of the fit fell",
       [](const Item& item) { return Number(item.gain); }},
      {"p", "-", "probability that the gain is chance",
       [](const Item& item) { return Number(item.p_value); }},
      {"predicted", "", "whether the gain is of held-out parts, else of the fitted samples",
       [](const Item& item) { return Flag(item.is_predicted); }},
      {"added", "", "whether the fit has it", [](const Item& item) { return Flag(item.added); }},
      {"obstacle", "",
       "why it is not added though it gains: confounded, rate_dependent, unphysical; may be empty",
       [](const Item& item) { return Text(item.obstacle); }},
  };
  return fields;
}

const std::vector<Field<identification::TermSelection>>& TermSelectionFields() {
  using Item = identification::TermSelection;
  static const std::vector<Field<Item>> fields = {
      {"mode", "", "auto", [](const Item&) { return Text("auto"); }},
      {"considered", "", "every candidate, those added first",
       [](const Item& item) { return List(ConsideredTermFields(), item.considered); }},
      {"added", "", "names of the terms that the fit has, in their order",
       [](const Item& item) {
         Value::Array names;
         for (const std::string& name : item.added) names.push_back(Text(name));
         return Value{std::move(names)};
       }},
      {"held_out_parts", "", "cycles or strokes held out, each predicted once",
       [](const Item& item) { return Count(item.held_out_parts); }},
      {"fits", "",
       "fits that were made, nearly all of them estimates, the first and the last included; at "
       "most 40",
       [](const Item& item) { return Count(item.estimates); }},
  };
  return fields;
}

}  // namespace

void AddSelectionFields(FieldTable& table) {
  table.Add({
      {"model_selection", "", "how the model was chosen; absent unless it was",
       [](const Report& report) {
         return report.selection ? Value{Render(SelectionFields(), *report.selection)} : Value{};
       }},
      {"terms", "", "how terms were chosen; absent unless they were",
       [](const Report& report) {
         return report.terms ? Value{Render(TermSelectionFields(), *report.terms)} : Value{};
       }},
  });
  table.Describe("terms.", TermSelectionFields());
  table.Describe("terms.considered[].", ConsideredTermFields());
  table.Describe("model_selection.", SelectionFields());
  table.Describe("model_selection.models[].", ScoreFields());
}

}  // namespace mindahl::report
