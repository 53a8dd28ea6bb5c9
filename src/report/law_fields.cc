#include "mindahl/identification/law_choice.h"
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

}  // namespace mindahl::report
