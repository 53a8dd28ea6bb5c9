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
      {"law", "", "name of the law, as --model takes it",
       [](const Item& item) { return Text(item.choice.alternative->name); }},
      {"sigma", "N/m", "σ under that law",
       [](const Item& item) { return Number(item.choice.law.tangential_stiffness); }},
      {"alpha", "-", "α under that law",
       [](const Item& item) { return Number(item.choice.law.shape_exponent); }},
      {"slip_force", "N", "Tc under that law",
       [](const Item& item) { return Number(item.choice.law.slip_force); }},
      {"contact_radius", "m", "a = σG*/8 under that law; absent where G* is not known",
       [](const Item& item) { return OrAbsent(item.contact.contact_radius); }},
      {"equivalent_radius", "m", "ρ under that law; absent where it is not identified",
       [](const Item& item) { return OrAbsent(item.contact.equivalent_radius); }},
  };
  return fields;
}

std::string WhyNoChoice(const Report& report) {
  if (report.fit.depth < identification::Depth::kFull) return "the fit was not asked for it";
  if (report.fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate) {
    return "the model does not describe the record, and the other law does no better";
  }
  return "Masing's law and Dahl's own are the same for alpha = 0 and before the first reversal, "
         "and are not compared if sigma or slip_force is held or bounded, or with an asymmetry";
}

std::string WhyNoDifference(const Report& report) {
  return report.fit.law_choice
             ? "the other law was not fitted, or has no fit: on a steady loop of one amplitude "
               "both give the same curve"
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
          "law.decided", "", "true if the record distinguishes Masing's law from Dahl's own",
          [](const LawChoice& choice) { return Flag(choice.decided); }, WhyNoChoice),
      LawRow(
          "law.preferred", "", "the law that the record follows, as --model takes it",
          [](const LawChoice& choice) {
            return choice.preferred != nullptr ? Text(choice.preferred->name) : Missing();
          },
          WhyNotPreferred),
      LawRow(
          "law.delta_aicc", "-", "AICc of the other law minus that of the fitted one",
          [](const LawChoice& choice) { return Number(choice.delta_aicc); }, WhyNoDifference),
      LawRow(
          "law.likelihood_ratio", "-",
          "likelihood ratio of the fitted law to the other, as twice its logarithm",
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
      {"rig", "", "true if a spring in series is fitted too",
       [](const Item& item) { return Flag(item.rig); }},
      {"free_parameters", "", "number of free parameters",
       [](const Item& item) { return Count(item.free_parameters); }},
      {"rms", "N", "root mean square residual of the samples that are scored",
       [](const Item& item) { return Number(item.rms); }, WhyNoScore},
      {"aicc", "-", "AICc on effective samples", [](const Item& item) { return Number(item.aicc); },
       WhyNoScore},
      {"delta_aicc", "-", "AICc above the smallest",
       [](const Item& item) { return Number(item.delta_aicc); }, WhyNoScore},
      {"akaike_weight", "-", "exp(−ΔAICc/2) over the sum for all models",
       [](const Item& item) { return Number(item.akaike_weight); }, WhyNoScore},
      {"held_out_rms", "N", "rms error of predicting held-out cycles",
       [](const Item& item) { return Number(item.held_out_rms); }, WhyNothingHeldOut},
      {"held_out_standard_error", "N", "standard error of held_out_rms",
       [](const Item& item) { return Number(item.held_out_standard_error); }, WhyNothingHeldOut},
      {"converged", "", "true if the fit converged",
       [](const Item& item) { return Flag(item.converged); }},
      {"at_bound", "", "true if a free parameter is at a bound",
       [](const Item& item) { return Flag(item.at_bound); }},
      {"redundant", "", "true if a simpler model is the same",
       [](const Item& item) { return Flag(item.redundant); }},
      {"remark", "", "further comment; may be empty",
       [](const Item& item) { return Text(item.remark); }},
  };
  return fields;
}

const std::vector<Field<identification::ModelSelection>>& SelectionFields() {
  using Item = identification::ModelSelection;
  static const std::vector<Field<Item>> fields = {
      {"chosen", "", "index in models of the reported one",
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
      {"verdict", "", "reason for the choice, in words",
       [](const Item& item) { return Text(item.verdict); }},
      {"models", "", "all models, first without, then with a rig",
       [](const Item& item) { return List(ScoreFields(), item.scores); }},
  };
  return fields;
}

const std::vector<Field<identification::ConsideredTerm>>& ConsideredTermFields() {
  using Item = identification::ConsideredTerm;
  static const std::vector<Field<Item>> fields = {
      {"name", "", "name of the term", [](const Item& item) { return Text(item.name); }},
      {"gain", "-",
       "fraction by which the term lowers the rms error of prediction, to first order; for an "
       "added term, by which it lowered the rms of the fit",
       [](const Item& item) { return Number(item.gain); }},
      {"p", "-", "probability that the gain is chance",
       [](const Item& item) { return Number(item.p_value); }},
      {"predicted", "", "true if the gain is of held-out parts, false if of the fitted samples",
       [](const Item& item) { return Flag(item.is_predicted); }},
      {"added", "", "true if the term was added",
       [](const Item& item) { return Flag(item.added); }},
      {"obstacle", "",
       "why a term that gains was not added: confounded, rate_dependent, unphysical; may be empty",
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
      {"added", "", "names of the added terms, in their order",
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
      {"model_selection", "", "comparison of models; absent without --model auto",
       [](const Report& report) {
         return report.selection ? Value{Render(SelectionFields(), *report.selection)} : Value{};
       }},
      {"terms", "", "selection of terms; absent where none was made",
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
