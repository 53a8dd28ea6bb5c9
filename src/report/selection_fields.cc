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
  return IfAny([](const Alternative& item) -> const IdentifiedContact& { return item.contact; },
               quantity, &PropagatedValue::value);
}

const std::vector<Field<Alternative>>& AlternativeFields() {
  using Item = Alternative;
  static const std::vector<Field<Item>> fields = {
      {"law", "", "name of the law, as --model takes it",
       [](const Item& item) { return item.choice.alternative->name; }},
      {"sigma", "N/m", "σ under that law",
       [](const Item& item) { return item.choice.law.tangential_stiffness; }},
      {"alpha", "-", "α under that law",
       [](const Item& item) { return item.choice.law.shape_exponent; }},
      {"slip_force", "N", "Tc under that law",
       [](const Item& item) { return item.choice.law.slip_force; }},
      {"contact_radius", "m", "a = σG*/8 under that law; absent where G* is not known",
       OfContact(&IdentifiedContact::contact_radius)},
      {"equivalent_radius", "m", "ρ under that law; absent where it is not identified",
       OfContact(&IdentifiedContact::equivalent_radius)},
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
      LawRow("law.decided", "", "true if the record distinguishes Masing's law from Dahl's own",
             &LawChoice::decided, WhyNoChoice),
      LawRow(
          "law.preferred", "", "the law that the record follows, as --model takes it",
          [](const LawChoice& choice) {
            return choice.preferred != nullptr ? std::optional(choice.preferred->name)
                                               : std::nullopt;
          },
          WhyNotPreferred),
      LawRow("law.delta_aicc", "-", "AICc of the other law minus that of the fitted one",
             &LawChoice::delta_aicc, WhyNoDifference),
      LawRow("law.likelihood_ratio", "-",
             "likelihood ratio of the fitted law to the other, as twice its logarithm",
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
      {"rig", "", "true if a spring in series is fitted too", &Item::rig},
      {"free_parameters", "", "number of free parameters", &Item::free_parameters},
      {"rms", "N", "root mean square residual of the samples that are scored", &Item::rms,
       WhyNoScore},
      {"aicc", "-", "AICc on effective samples", &Item::aicc, WhyNoScore},
      {"delta_aicc", "-", "AICc above the smallest", &Item::delta_aicc, WhyNoScore},
      {"akaike_weight", "-", "exp(−ΔAICc/2) over the sum for all models", &Item::akaike_weight,
       WhyNoScore},
      {"held_out_rms", "N", "rms error of predicting held-out cycles", &Item::held_out_rms,
       WhyNothingHeldOut},
      {"held_out_standard_error", "N", "standard error of held_out_rms",
       &Item::held_out_standard_error, WhyNothingHeldOut},
      {"converged", "", "true if the fit converged", &Item::converged},
      {"at_bound", "", "true if a free parameter is at a bound", &Item::at_bound},
      {"redundant", "", "true if a simpler model is the same", &Item::redundant},
      {"remark", "", "further comment; may be empty", &Item::remark},
  };
  return fields;
}

const std::vector<Field<identification::ModelSelection>>& SelectionFields() {
  using Item = identification::ModelSelection;
  static const std::vector<Field<Item>> fields = {
      {"chosen", "", "index in models of the reported one", &Item::chosen},
      {"indistinguishable", "",
       "models that the record does not distinguish from it, simplest first",
       &Item::indistinguishable},
      {"effective_samples", "-", "effective samples of AICc", &Item::effective_samples,
       "no model has a fit to the record"},
      {"held_out_cycles", "", "cycles held out, each predicted once", &Item::held_out_cycles},
      {"verdict", "", "reason for the choice, in words", &Item::verdict},
      {"models", "", "all models, first without, then with a rig",
       [](const Item& item) { return List(ScoreFields(), item.scores); }},
  };
  return fields;
}

const std::vector<Field<identification::ConsideredTerm>>& ConsideredTermFields() {
  using Item = identification::ConsideredTerm;
  static const std::vector<Field<Item>> fields = {
      {"name", "", "name of the term", &Item::name},
      {"gain", "-",
       "fraction by which the term lowers the rms error of prediction, to first order; for an "
       "added term, by which it lowered the rms of the fit",
       &Item::gain},
      {"p", "-", "probability that the gain is chance", &Item::p_value},
      {"predicted", "", "true if the gain is of held-out parts, false if of the fitted samples",
       &Item::is_predicted},
      {"added", "", "true if the term was added", &Item::added},
      {"obstacle", "",
       "why a term was not added: confounded, rate_dependent, unphysical; same_channel: it repeats "
       "another column and was not tried; may be empty",
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
      {"added", "", "names of the added terms, in their order", &Item::added},
      {"held_out_parts", "", "cycles or strokes held out, each predicted once",
       &Item::held_out_parts},
      {"fits", "",
       "fits that were made, nearly all of them estimates, the first and the last included; at "
       "most 15",
       &Item::estimates},
  };
  return fields;
}

}  // namespace

void AddSelectionFields(FieldTable& table) {
  table.Add({
      {"model_selection", "", "comparison of models; absent without --model auto",
       IfAny(&Report::selection,
             [](const auto& selection) { return Render(SelectionFields(), selection); })},
      {"terms", "", "selection of terms; absent where none was made",
       IfAny(&Report::terms,
             [](const auto& terms) { return Render(TermSelectionFields(), terms); })},
  });
  table.Describe("terms.", TermSelectionFields());
  table.Describe("terms.considered[].", ConsideredTermFields());
  table.Describe("model_selection.", SelectionFields());
  table.Describe("model_selection.models[].", ScoreFields());
}

}  // namespace mindahl::report
