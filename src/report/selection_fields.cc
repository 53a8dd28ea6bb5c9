#include "mindahl/identification/fit_result.h"
#include "report/field_table.h"

namespace mindahl::report {

using contact::PropagatedValue;
using identification::LawChoice;

namespace {

/// The law that was not fitted, and the contact by it.
struct Alternative {
  const LawChoice& choice;
  const contact::IdentifiedContact& contact;
};

Value OrAbsent(const std::optional<PropagatedValue>& quantity) {
  return quantity ? Number(quantity->value) : Value{};
}

const std::vector<Field<Alternative>>& AlternativeFields() {
  using Item = Alternative;
  static const std::vector<Field<Item>> fields = {
      {"law", "", "its name, as --model takes it",
       [](const Item& item) { return Text(item.choice.alternative->name); }},
      {"sigma", "N/m", "σ by that law",
       [](const Item& item) { return Number(item.choice.law.tangential_stiffness); }},
      {"alpha", "-", "α by that law",
       [](const Item& item) { return Number(item.choice.law.shape_exponent); }},
      {"slip_force", "N", "Tc by that law",
       [](const Item& item) { return Number(item.choice.law.slip_force); }},
      {"contact_radius", "m", "a = σG*/8 by that law; absent where G* is not known",
       [](const Item& item) { return OrAbsent(item.contact.contact_radius); }},
      {"equivalent_radius", "m", "ρ by that law; absent where it is not identified",
       [](const Item& item) { return OrAbsent(item.contact.equivalent_radius); }},
  };
  return fields;
}

std::string WhyNoChoice(const Report& report) {
  if (report.fit.depth < identification::Depth::kFull) return "the fit was not asked for it";
  if (report.fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate) {
    return "the model does not describe the record, nor does the other law better";
  }
  return "Masing's law and Dahl's own are one for alpha = 0 and before the motion turns, and are "
         "not compared where sigma or slip_force is held or bounded, or with an asymmetry";
}

std::string WhyNoDifference(const Report& report) {
  return report.fit.law_choice
             ? "the other law was not fitted, or has no fit: on a steady loop of one amplitude the "
               "two are one curve"
             : WhyNoChoice(report);
}

std::string WhyNotPreferred(const Report& report) {
  return report.fit.law_choice ? "the record does not distinguish the two laws"
                               : WhyNoChoice(report);
}

template <typename Get>
Field<Report> LawRow(const char* path, const char* unit, const char* label, Get get,
                     std::string (*why)(const Report&)) {
  return {path, unit, label,
          [get](const Report& report) {
            return report.fit.law_choice ? get(*report.fit.law_choice) : Missing();
          },
          why};
}

Value Alternatives(const Report& report) {
  Value::Array array;
  if (report.fit.law_choice) {
    array.push_back({Render(AlternativeFields(),
                            Alternative{*report.fit.law_choice, report.contact_by_other_law})});
  }
  return {std::move(array)};
}

}  // namespace

void AddLawFields(FieldTable& table) {
  table.Add({
      LawRow(
          "law.decided", "", "whether the record distinguishes Masing's law from Dahl's own",
          [](const LawChoice& choice) { return Flag(choice.decided); }, WhyNoChoice),
      LawRow(
          "law.preferred", "", "the law that it is of, as --model takes it",
          [](const LawChoice& choice) {
            return choice.preferred != nullptr ? Text(choice.preferred->name) : Missing();
          },
          WhyNotPreferred),
      LawRow(
          "law.delta_aicc", "-", "of the other law less the fitted one",
          [](const LawChoice& choice) { return Number(choice.delta_aicc); }, WhyNoDifference),
      LawRow(
          "law.likelihood_ratio", "-", "of the fitted law against the other, twice its logarithm",
          [](const LawChoice& choice) { return Number(choice.likelihood_ratio); }, WhyNoDifference),
      {"law.alternatives", "", "the other law; empty where the two are not compared", Alternatives},
  });
  table.Describe("law.alternatives[].", AlternativeFields());
}

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
