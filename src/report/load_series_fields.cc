#include <cmath>
#include <utility>

#include "report/field_table.h"
#include "report/propagated_fields.h"

namespace mindahl::report {

using contact::UncertainValue;
using identification::ParameterEstimate;

namespace {

std::string WhySeriesOpen(const ContactUnderLoad&) { return "the series leaves it open"; }

std::string WhyNotAlone(const ContactUnderLoad& item) {
  return item.alone ? "the record by itself leaves it open" : "the record by itself is no fit";
}

const std::vector<Field<ContactUnderLoad>>& ContactFieldsUnderLoad() {
  using Item = ContactUnderLoad;
  static const std::vector<Field<Item>> fields = [] {
    std::vector<Field<Item>> rows;
    rows.push_back({"normal_load", "N", "N of the record, given or the mean of its column",
                    [](const Item& item) { return Number(item.normal_load); }});
    const auto of_series = [&](const std::string& name, const char* unit, const char* label,
                               UncertainValue Item::*member) {
      rows.push_back({name + ".value", unit, label,
                      [member](const Item& item) { return Number((item.*member).value); }});
      rows.push_back({name + ".standard_error", unit, "standard error",
                      [member](const Item& item) { return Number((item.*member).standard_error); },
                      WhySeriesOpen});
    };
    of_series("sigma", "N/m", "σ at this load, of the whole series", &Item::stiffness);
    of_series("slip_force", "N", "Tc at this load, of the whole series", &Item::slip_force);
    const auto alone = [&](const std::string& name, const char* unit, const char* label,
                           ParameterEstimate identification::RecordAlone::*member) {
      rows.push_back({"alone." + name + ".value", unit, label,
                      [member](const Item& item) {
                        return item.alone ? Number(((*item.alone).*member).value) : Missing();
                      },
                      WhyNotAlone});
      rows.push_back({"alone." + name + ".ci95[0]", unit, "lower end of the interval",
                      [member](const Item& item) {
                        return item.alone ? Number(((*item.alone).*member).lower95) : Missing();
                      },
                      WhyNotAlone});
      rows.push_back({"alone." + name + ".ci95[1]", unit, "upper end of the interval",
                      [member](const Item& item) {
                        return item.alone ? Number(((*item.alone).*member).upper95) : Missing();
                      },
                      WhyNotAlone});
    };
    alone("sigma", "N/m", "σ of this record alone, with the series' α",
          &identification::RecordAlone::stiffness);
    alone("slip_force", "N", "Tc of this record alone, with the series' α",
          &identification::RecordAlone::slip_force);
    rows.push_back(
        {"contact_radius", "m", "a = σG*/8; absent unless G* is known", [](const Item& item) {
           return item.contact_radius ? Number(item.contact_radius->value) : Value{};
         }});
    rows.push_back(
        {"hertz_contact_radius", "m", "a of Hertz; absent unless materials and radii are known",
         [](const Item& item) { return item.hertz_radius ? Number(item.hertz_radius) : Value{}; }});
    return rows;
  }();
  return fields;
}

std::string WhyHypothesisNotTested(const LoadHypothesis& item) {
  return item.difference ? "load_exponent is at a bound or not identifiable"
                         : "load_exponent was held";
}

const std::vector<Field<LoadHypothesis>>& HypothesisFields() {
  using Item = LoadHypothesis;
  static const std::vector<Field<Item>> fields = {
      {"name", "", "sphere, elements, cone, flat_punch or rough",
       [](const Item& item) { return Text(item.name); }},
      {"exponent", "-", "that it has; of elements in parallel the fitted α",
       [](const Item& item) { return Number(item.exponent); }},
      {"difference", "-", "p less that", [](const Item& item) { return Number(item.difference); },
       WhyHypothesisNotTested},
      {"z", "-", "difference over its standard error",
       [](const Item& item) { return Number(item.z); }, WhyHypothesisNotTested},
      {"p_value", "-", "two-sided, of z", [](const Item& item) { return Number(item.p_value); },
       WhyHypothesisNotTested},
  };
  return fields;
}

std::string WhyNoInterval(const QuantityUnderLaw& item) {
  return item.value.standard_error > 0 ? "the series leaves it open"
                                       : "all that it follows from is held";
}

/// Returns the fields of a quantity in addition to those of every quantity of the contact.
const std::vector<Field<QuantityUnderLaw>>& QuantityFields() {
  using Item = QuantityUnderLaw;
  static const std::vector<Field<Item>> fields = {
      {"ci95[0]", "of the quantity", "lower end of the interval",
       [](const Item& item) {
         return item.interval95 ? Number(item.interval95->lower) : Missing();
       },
       WhyNoInterval},
      {"ci95[1]", "of the quantity", "upper end of the interval",
       [](const Item& item) {
         const bool is_closed = item.interval95 && std::isfinite(item.interval95->upper);
         return is_closed ? Number(item.interval95->upper) : Missing();
       },
       WhyNoInterval},
      {"predicted", "of the quantity", "what the bodies say; absent where they are not known",
       [](const Item& item) { return item.predicted ? Number(item.predicted) : Value{}; }},
  };
  return fields;
}

Value QuantityValues(const LoadLaw& law) {
  Value::Object quantities;
  for (const QuantityUnderLaw& quantity : law.quantities) {
    Value::Object members = PropagatedMembers(quantity.value, quantity.unit);
    for (auto& member : Render(QuantityFields(), quantity)) members.push_back(std::move(member));
    quantities.push_back({std::string(quantity.key), {std::move(members)}});
  }
  return {std::move(quantities)};
}

const std::vector<Field<LoadLaw>>& LoadLawFields() {
  using Item = LoadLaw;
  const auto why_exact = [](const Item&) { return std::string("sigma was held"); };
  static const std::vector<Field<Item>> fields = {
      {"name", "", "of the hypothesis", [](const Item& item) { return Text(item.name); }},
      {"exponent", "-", "p that is held; of elements in parallel the p = α nearest to both",
       [](const Item& item) { return Number(item.exponent); }},
      {"sigma.value", "N/m", "σ at the reference load, with p held",
       [](const Item& item) { return Number(item.stiffness.value); }},
      {"sigma.standard_error", "N/m", "standard error",
       [](const Item& item) { return Number(item.stiffness.standard_error); }},
      {"sigma.ci95[0]", "N/m", "lower end of the interval",
       [](const Item& item) {
         return item.stiffness95 ? Number(item.stiffness95->lower) : Missing();
       },
       why_exact},
      {"sigma.ci95[1]", "N/m", "upper end of the interval",
       [](const Item& item) {
         return item.stiffness95 ? Number(item.stiffness95->upper) : Missing();
       },
       why_exact},
      {"quantities", "", "what follows of the contact, by name; may be empty", QuantityValues},
  };
  return fields;
}

}  // namespace

void AddLoadSeriesFields(FieldTable& table) {
  table.Add({
      {"load_series.reference_load", "N",
       "N₀, mean of the records' loads: σ and Tc of parameters are those under it; load_series is "
       "absent where the records have one load",
       [](const Report& report) {
         return report.load_series ? Number(report.fit.normal_load) : Value{};
       }},
      {"load_series.records", "", "the contact at the load of each file",
       [](const Report& report) {
         return report.load_series ? List(ContactFieldsUnderLoad(), report.load_series->contacts)
                                   : Value{};
       }},
      {"load_series.hypotheses", "", "p of σ ∝ N^p against theories",
       [](const Report& report) {
         return report.load_series ? List(HypothesisFields(), report.load_series->hypotheses)
                                   : Value{};
       }},
      {"load_series.laws", "", "the hypotheses that are tenable, each held over all loads",
       [](const Report& report) {
         return report.load_series ? List(LoadLawFields(), report.load_series->laws) : Value{};
       }},
  });
  table.Describe("load_series.records[].", ContactFieldsUnderLoad());
  table.Describe("load_series.hypotheses[].", HypothesisFields());
  table.Describe("load_series.laws[].", LoadLawFields());
  table.Describe("load_series.laws[].quantities.NAME.", PropagatedFields());
  table.Describe("load_series.laws[].quantities.NAME.", QuantityFields());
}

}  // namespace mindahl::report
