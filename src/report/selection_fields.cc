#include "mindahl/identification/fit_result.h"
#include "report/field_table.h"

namespace mindahl::report {

using contact::IdentifiedContact;
using contact::PropagatedValue;
using identification::LawChoice;

namespace {

/// The law that was not fitted, and the contact by it.
struct Alternative {
  const LawChoice& choice;
  const IdentifiedContact& contact;
};

auto OfContact(std::optional<PropagatedValue> IdentifiedContact::*quantity) {
  return [quantity](const Alternative& item) {
    return IfAny(quantity, &PropagatedValue::value)(item.contact);
  };
}

const std::vector<Field<Alternative>>& AlternativeFields() {
  using Item = Alternative;
  static const std::vector<Field<Item>> fields = {
      {"law", "", "its name, as --model takes it",
       [](const Item& item) { return item.choice.alternative->name; }},
      {"sigma", "N/m", "σ by that law",
       [](const Item& item) { return item.choice.law.tangential_stiffness; }},
      {"alpha", "-", "α by that law",
       [](const Item& item) { return item.choice.law.shape_exponent; }},
      {"slip_force", "N", "Tc by that law",
       [](const Item& item) { return item.choice.law.slip_force; }},
      {"contact_radius", "m", "a = σG*/8 by that law; absent where G* is not known",
       OfContact(&IdentifiedContact::contact_radius)},
      {"equivalent_radius", "m", "ρ by that law; absent where it is not identified",
       OfContact(&IdentifiedContact::equivalent_radius)},
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

/// Makes a row, null where the laws are not compared.
template <typename Get>
Field<Report> LawRow(const char* path, const char* unit, const char* label, Get get,
                     std::string (*why)(const Report&)) {
  return {path, unit, label, At(&Report::fit, &identification::FitResult::law_choice, get), why};
}

Value Alternatives(const Report& report) {
  Value list{.json = Json::array(), .is_absent = false};
  if (const auto& choice = report.fit.law_choice) {
    list.Append(Render(AlternativeFields(), Alternative{*choice, report.contact_by_other_law}));
  }
  return list;
}

}  // namespace

void AddLawFields(FieldTable& table) {
  table.Add({
      LawRow("law.decided", "", "whether the record distinguishes Masing's law from Dahl's own",
             &LawChoice::decided, WhyNoChoice),
      LawRow(
          "law.preferred", "", "the law that it is of, as --model takes it",
          [](const LawChoice& choice) {
            return choice.preferred != nullptr ? ToValue(choice.preferred->name) : Missing();
          },
          WhyNotPreferred),
      LawRow("law.delta_aicc", "-", "of the other law less the fitted one", &LawChoice::delta_aicc,
             WhyNoDifference),
      LawRow("law.likelihood_ratio", "-",
             "of the fitted law against the other, twice its logarithm",
             &LawChoice::likelihood_ratio, WhyNoDifference),
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
      {"model", "", "name of the model", [](const Item& item) { return item.model->name; }},
      {"rig", "", "with a fitted spring in series", &Item::rig},
      {"free_parameters", "", "number of free parameters", &Item::free_parameters},
      {"rms", "N", "root mean square residual of the samples that are scored", &Item::rms,
       WhyNoScore},
      {"aicc", "-", "AICc on effective samples", &Item::aicc, WhyNoScore},
      {"delta_aicc", "-", "AICc above the least", &Item::delta_aicc, WhyNoScore},
      {"akaike_weight", "-", "exp(−ΔAICc/2) over its sum", &Item::akaike_weight, WhyNoScore},
      {"held_out_rms", "N", "error of predicting cycles held out", &Item::held_out_rms,
       WhyNothingHeldOut},
      {"held_out_standard_error", "N", "standard error of held_out_rms",
       &Item::held_out_standard_error, WhyNothingHeldOut},
      {"converged", "", "whether the fit converged", &Item::converged},
      {"at_bound", "", "a free parameter ran to a bound", &Item::at_bound},
      {"redundant", "", "the same as a simpler model", &Item::redundant},
      {"remark", "", "what else is to be known; may be empty", &Item::remark},
  };
  return fields;
}

const std::vector<Field<identification::ModelSelection>>& SelectionFields() {
  using Item = identification::ModelSelection;
  static const std::vector<Field<Item>> fields = {
      {"chosen", "", "the reported one: its place in models", &Item::chosen},
      {"indistinguishable", "",
       "models that the record does not distinguish from it, simplest first",
       &Item::indistinguishable},
      {"effective_samples", "-", "effective samples of AICc", &Item::effective_samples,
       "no model has a fit to the record"},
      {"held_out_cycles", "", "cycles held out, each predicted once", &Item::held_out_cycles},
      {"verdict", "", "the choice in words", &Item::verdict},
      {"models", "", "every model without, then with a rig",
       [](const Item& item) { return List(ScoreFields(), item.scores); }},
  };
  return fields;
}

const std::vector<Field<identification::ConsideredTerm>>& ConsideredTermFields() {
  using Item = identification::ConsideredTerm;
  static const std::vector<Field<Item>> fields = {
      {"name", "", "of the term", &Item::name},
      {"gain", "-",
       "fraction by which the rms error of prediction falls with it to first order; of one that is "
       "added, by which the rms of the fit fell",
       &Item::gain},
      {"p", "-", "probability that the gain is chance", &Item::p_value},
      {"predicted", "", "whether the gain is of held-out parts, else of the fitted samples",
       &Item::is_predicted},
      {"added", "", "whether the fit has it", &Item::added},
      {"obstacle", "",
       "why it is not added though it gains: confounded, rate_dependent, unphysical; may be empty",
       &Item::obstacle},
  };
  return fields;
}

const std::vector<Field<identification::TermSelection>>& TermSelectionFields() {
  using Item = identification::TermSelection;
  static const std::vector<Field<Item>> fields = {
      {"mode", "", "auto", [](const Item&) { return "auto"; }},
      {"considered", "", "every candidate, those added first",
       [](const Item& item) { return List(ConsideredTermFields(), item.considered); }},
      {"added", "", "names of the terms that the fit has, in their order", &Item::added},
      {"held_out_parts", "", "cycles or strokes held out, each predicted once",
       &Item::held_out_parts},
      {"fits", "",
       "fits that were made, nearly all of them estimates, the first and the last included; at "
       "most 40",
       &Item::estimates},
  };
  return fields;
}

}  // namespace

void AddSelectionFields(FieldTable& table) {
  table.Add({
      {"model_selection", "", "how the model was chosen; absent unless it was",
       [](const Report& report) {
         return report.selection ? Render(SelectionFields(), *report.selection) : Value{};
       }},
      {"terms", "", "how terms were chosen; absent unless they were",
       [](const Report& report) {
         return report.terms ? Render(TermSelectionFields(), *report.terms) : Value{};
       }},
  });
  table.Describe("terms.", TermSelectionFields());
  table.Describe("terms.considered[].", ConsideredTermFields());
  table.Describe("model_selection.", SelectionFields());
  table.Describe("model_selection.models[].", ScoreFields());
}

}  // namespace mindahl::report
