#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "mindahl/report/contact.h"
#include "report/field_table.h"
#include "report/fields.h"
#include "report/propagated_fields.h"

namespace mindahl::report {

using contact::ContactQuantity;
using contact::PropagatedValue;

namespace {

std::string WhyNotIdentified(const Report& report, ContactQuantity quantity) {
  if (report.failed()) return WhyFailed(report);
  const bool is_of_sphere = quantity == ContactQuantity::kEquivalentRadius ||
                            quantity == ContactQuantity::kMaximumPressure;
  if (is_of_sphere && DeniesHertz(report.fit)) return kWhyNoSphere;
  return fmt::format("needs {}", fmt::join(contact::MissingInputs(report.known, quantity), ", "));
}

template <ContactQuantity kQuantity>
std::string WhyNotIdentified(const Report& report) {
  return WhyNotIdentified(report, kQuantity);
}

const std::vector<Field<contact::HertzPrediction>>& HertzFields() {
  using Item = contact::HertzPrediction;
  static const std::vector<Field<Item>> fields = [] {
    std::vector<Field<Item>> rows;
    const auto of_inputs = [&](const std::string& name, const char* unit, const char* label,
                               PropagatedValue Item::*member) {
      rows.push_back(
          {name, unit, label, [member](const Item& item) { return Number((item.*member).value); }});
      rows.push_back(
          {name + "_standard_error", unit, "standard error, of inputs alone",
           [member](const Item& item) { return Number((item.*member).standard_error); }});
    };
    const auto propagated = [&](const char* path, const char* unit, const char* label,
                                PropagatedValue Item::*member) {
      rows.push_back({path, unit, label,
                      [member, unit](const Item& item) { return Propagated(item.*member, unit); }});
    };
    of_inputs("contact_radius", "m", "a of Hertz", &Item::contact_radius);
    of_inputs("sigma", "N/m", "8a/G*", &Item::tangential_stiffness);
    propagated("gross_slip_displacement", "m", "3·Tc·G*/(16a) with the measured Tc",
               &Item::gross_slip_displacement);
    of_inputs("equivalent_radius", "m", "of the two radii", &Item::equivalent_radius);
    of_inputs("maximum_pressure", "Pa", "p₀ of Hertz", &Item::maximum_pressure);
    propagated("measured_over_predicted.contact_radius", "-", "measured over predicted",
               &Item::sigma_over_hertz_mindlin);
    propagated("measured_over_predicted.sigma", "-", "measured over predicted",
               &Item::sigma_over_hertz_mindlin);
    propagated("measured_over_predicted.gross_slip_displacement", "-", "measured over predicted",
               &Item::gross_slip_displacement_ratio);
    return rows;
  }();
  return fields;
}

}  // namespace

const std::vector<ContactField>& ContactFields() {
  static const std::vector<ContactField> fields = {
      {"friction_coefficient", "-", "friction coefficient", "μ = Tc/N",
       [](const Report& report) { return report.contact.friction_coefficient; },
       [](const Report& report) {
         if (const auto why = WhyFrictionIsWithheld(report.fit, report.known)) return *why;
         return WhyNotIdentified(report, ContactQuantity::kFrictionCoefficient);
       }},
      {"contact_radius", "m", "contact radius", "a = σG*/8",
       [](const Report& report) { return report.contact.contact_radius; },
       WhyNotIdentified<ContactQuantity::kContactRadius>},
      {"compliance", "1/Pa", "tangential compliance", "G* = 8a/σ",
       [](const Report& report) { return report.contact.tangential_compliance; },
       WhyNotIdentified<ContactQuantity::kTangentialCompliance>},
      {"equivalent_radius", "m", "equivalent radius", "ρ = 4E*a³/(3N)",
       [](const Report& report) { return report.contact.equivalent_radius; },
       WhyNotIdentified<ContactQuantity::kEquivalentRadius>},
      {"maximum_pressure", "Pa", "maximum pressure", "p₀ = 3N/(2πa²)",
       [](const Report& report) { return report.contact.maximum_pressure; },
       WhyNotIdentified<ContactQuantity::kMaximumPressure>},
      {"mindlin_gross_slip_displacement", "m", "gross slip (α = 1/3)", "δc = 3Tc/(2σ)",
       [](const Report& report) {
         return report.failed() || report.is_torsional() ? std::optional<PropagatedValue>()
                                                         : report.contact.gross_slip_displacement;
       },
       WhyFailed},
  };
  return fields;
}

void AddContactFields(FieldTable& table) {
  std::vector<Field<Report>> rows;
  for (const ContactField& field : ContactFields()) {
    rows.push_back(
        {fmt::format("contact.{}", field.key), std::string(field.unit), std::string(field.label),
         [&field](const Report& report) { return Propagated(field.get(report), field.unit); },
         field.why_null});
    if (field.key != "compliance") continue;
    rows.push_back({"contact.compliance_definition", "", "which G* is meant",
                    [](const Report&) { return Text("G* = (2-nu1)/G1 + (2-nu2)/G2"); }});
    rows.push_back({"contact.compliance_unit", "", "unit of compliance",
                    [](const Report&) { return Text("1/Pa"); }});
  }
  rows.push_back({"contact.normal_load", "N", "normal load, given or the mean of its column",
                  [](const Report& report) {
                    return report.known.normal_load ? Number(report.known.normal_load->value)
                                                    : Missing("not given, and no column has it");
                  }});
  rows.push_back(
      {"contact.hertz_mindlin", "",
       "what Hertz and Mindlin predict; absent unless materials, radii and load are known",
       [](const Report& report) {
         return report.contact.hertz ? Value{Render(HertzFields(), *report.contact.hertz)}
                                     : Value{};
       }});
  table.Add(std::move(rows));
  table.Describe("contact.QUANTITY.", PropagatedFields());
  table.Describe("contact.hertz_mindlin.", HertzFields());
}

}  // namespace mindahl::report
