#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string>
#include <utility>

#include "mindahl/report/contact.h"
#include "report/field_table.h"
#include "report/fields.h"

namespace mindahl::report {

using contact::PropagatedValue;

const std::vector<Field<PropagatedValue>>& PropagatedFields() {
  using Item = PropagatedValue;
  static const std::vector<Field<Item>> fields = {
      {"value", "of the quantity", "estimate", &Item::value},
      {"standard_error", "of the quantity", "standard error from the fit and from the given inputs",
       &Item::standard_error, "the record does not determine the parameter that it follows from"},
      {"unit", "", "unit of value and error", [](const Item&) { return "-"; }},
      {"from_fit", "-", "fraction of the variance from the fit", &Item::FitShare},
      {"from_inputs", "-", "fraction of the variance from the inputs", &Item::InputShare},
      {"largest_input", "", "the input that contributes most; absent where all are exact",
       IfAny([](const Item& item) { return If(!item.largest_input.empty(), item); },
             &Item::largest_input)},
  };
  return fields;
}

Value PropagatedMembers(const PropagatedValue& value, std::string_view unit) {
  Value members = Render(PropagatedFields(), value);
  members.Place("unit", ToValue(unit));
  return members;
}

Value ToMembers(const PropagatedQuantity& quantity) {
  return quantity.value ? PropagatedMembers(*quantity.value, quantity.unit) : Missing();
}

namespace {

std::string WhySlipForceOpen(const Report& report) {
  return report.slip_forces ? "slip_force and asymmetry are held, or not determined"
                            : "slip_force or asymmetry is not identifiable";
}

std::vector<Field<Report>> RowsOf(const std::string& sense, const char* label,
                                  SlipForce SlipForces::*member) {
  std::vector<Field<Report>> rows;
  const auto add = [&](const char* name, const char* row_label, auto number) {
    rows.push_back({fmt::format("slip_forces.{}.{}", sense, name), "N", row_label,
                    IfAny(
                        [](const Report& report) {
                          return If(report.fit.Find("asymmetry") != nullptr, report.slip_forces);
                        },
                        [member, number](const std::optional<SlipForces>& forces) {
                          OrNull found;
                          if (forces) found.number = std::invoke(number, (*forces).*member);
                          return found;
                        }),
                    WhySlipForceOpen});
  };
  add("value", label, &SlipForce::value);
  add("standard_error", "standard error", &SlipForce::standard_error);
  add("ci95[0]", "lower end of the interval", &SlipForce::lower95);
  add("ci95[1]", "upper end of the interval", &SlipForce::upper95);
  return rows;
}

}  // namespace

void AddSlipForceFields(FieldTable& table) {
  table.Add(RowsOf("positive",
                   "Tc(1 + A), where the displacement grows; absent, as is slip_forces.negative, "
                   "unless the fit has an asymmetry",
                   &SlipForces::positive));
  table.Add(RowsOf("negative", "Tc(1 − A), where the displacement falls", &SlipForces::negative));
}

using contact::UncertainValue;
using identification::Interval;
using identification::MindlinTest;

namespace {

std::string WhyStiffnessNotTested(const StiffnessTest& test) {
  return test.ratio.standard_error > 0 ? "sigma is not identifiable"
                                       : "neither sigma nor an input is uncertain";
}

const std::vector<Field<StiffnessTest>>& StiffnessFields() {
  using Item = StiffnessTest;
  static const std::vector<Field<Item>> fields = {
      {"ci95[0]", "-", "lower end of the interval", At(&Item::interval95, &Interval::lower),
       WhyStiffnessNotTested},
      {"ci95[1]", "-", "upper end of the interval", At(&Item::interval95, &Interval::upper),
       WhyStiffnessNotTested},
      {"z", "-", "(ratio − 1)/SE", &Item::z, WhyStiffnessNotTested},
      {"p_value", "-", "two-sided", &Item::p_value, WhyStiffnessNotTested},
  };
  return fields;
}

Value StiffnessTests(const Report& report) {
  Value list{.json = Json::array(), .is_absent = false};
  for (const StiffnessTest& test : report.stiffness) {
    Value members{.json = {{"radius", test.radius}}, .is_absent = false};
    members.Add(PropagatedMembers(test.ratio, "-"));
    members.Add(Render(StiffnessFields(), test));
    list.Append(std::move(members));
  }
  return list;
}

std::string WhyAlphaNotTested(const Report& report) {
  const identification::ParameterEstimate& alpha = *report.fit.Find("alpha");
  if (alpha.status == identification::ParameterStatus::kFixed) {
    return "alpha was held, so alpha = 1/3 is not tested";
  }
  return alpha.is_known() ? "alpha has no standard error: it is at a bound"
                          : "alpha is not identifiable, so alpha = 1/3 is not tested";
}

std::string WhyNoLikelihoodRatio(const Report& report) {
  if (!report.fit.mindlin_test) return "alpha is held or not determined";
  if (!report.alpha.is_rejected) return WhyAlphaNotTested(report);
  return "the interval of alpha includes more than this model, and decides otherwise";
}

std::string WhyNoRig(const Report& report) {
  return report.fit.mindlin_test ? "alpha = 1/3 is not rejected, alpha is above 1/3, a rig is "
                                   "fitted, or no rig helps"
                                 : WhyNoLikelihoodRatio(report);
}

Field<Report> Likelihood(const char* path, const char* unit, const char* label,
                         double MindlinTest::*member) {
  return {path, unit, label, At(&Report::alpha, &AlphaTest::likelihood, member),
          WhyNoLikelihoodRatio};
}

std::string WhyNoRatio(const Report& report) {
  return report.stiffness.empty() ? "needs a contact radius known apart from the fit: the elastic "
                                    "constants and radii of both bodies with the load, or a "
                                    "contact radius with the compliance or the elastic constants"
                                  : "the record does not determine sigma";
}

}  // namespace

void AddMappingFields(FieldTable& table) {
  const auto ratio = [](double UncertainValue::*member) {
    return [member](const Report& report) {
      return report.stiffness.empty() ? std::nullopt
                                      : std::optional(report.stiffness.front().ratio.*member);
    };
  };
  table.Add({
      {"mapping.alpha_minus_third", "-", "α − 1/3",
       [](const Report& report) { return report.alpha.minus_third; }, WhyAlphaNotTested},
      {"mapping.z", "-", "(α − 1/3)/SE", [](const Report& report) { return report.alpha.z; },
       WhyAlphaNotTested},
      {"mapping.p_value", "-", "two-sided p-value of z",
       [](const Report& report) { return report.alpha.p_value; }, WhyAlphaNotTested},
      Likelihood("mapping.likelihood_ratio", "-",
                 "α = 1/3 against the fitted α, twice its logarithm",
                 &MindlinTest::likelihood_ratio),
      Likelihood("mapping.likelihood_ratio_p_value", "-", "p-value of the likelihood ratio",
                 &MindlinTest::p_value),
      {"mapping.tenable_with_rig_stiffness", "N/m", "rig with which α = 1/3 fits as well",
       At(&Report::fit, &identification::FitResult::mindlin_test, &MindlinTest::rig_stiffness),
       WhyNoRig},
      {"mapping.sigma_over_hertz_mindlin", "-", "σ/(8a/G*)", ratio(&UncertainValue::value),
       WhyNoRatio},
      {"mapping.sigma_over_hertz_mindlin_standard_error", "-", "standard error of σ/(8a/G*)",
       ratio(&UncertainValue::standard_error), WhyNoRatio},
      {"mapping.stiffness_tests", "", "σ/(8a/G*) against 1, one entry per known radius",
       StiffnessTests},
  });
  table.items.push_back({"mapping.stiffness_tests[].radius", "", "source of a: hertz or given"});
  table.Describe("mapping.stiffness_tests[].", PropagatedFields());
  table.Describe("mapping.stiffness_tests[].", StiffnessFields());
}

using identification::ParameterEstimate;

namespace {

std::string WhySeriesOpen(const ContactUnderLoad&) { return "the series does not determine it"; }

std::string WhyNotAlone(const ContactUnderLoad& item) {
  return item.alone ? "the record alone does not determine it"
                    : "the record alone cannot be fitted";
}

const std::vector<Field<ContactUnderLoad>>& ContactFieldsUnderLoad() {
  using Item = ContactUnderLoad;
  static const std::vector<Field<Item>> fields = [] {
    std::vector<Field<Item>> rows;
    rows.push_back({"normal_load", "N", "N of the record, given or the mean of its column",
                    &Item::normal_load});
    const auto of_series = [&](const std::string& name, const char* unit, const char* label,
                               UncertainValue Item::*member) {
      rows.push_back({name + ".value", unit, label, At(member, &UncertainValue::value)});
      rows.push_back({name + ".standard_error", unit, "standard error",
                      At(member, &UncertainValue::standard_error), WhySeriesOpen});
    };
    of_series("sigma", "N/m", "σ at this load, from the whole series", &Item::stiffness);
    of_series("slip_force", "N", "Tc at this load, from the whole series", &Item::slip_force);
    const auto alone = [&](const std::string& name, const char* unit, const char* label,
                           ParameterEstimate identification::RecordAlone::*member) {
      const auto add = [&](const char* number, const char* row_label, auto get) {
        rows.push_back({"alone." + name + number, unit, row_label, At(&Item::alone, member, get),
                        WhyNotAlone});
      };
      add(".value", label, &ParameterEstimate::value);
      add(".ci95[0]", "lower end of the interval", &ParameterEstimate::lower95);
      add(".ci95[1]", "upper end of the interval", &ParameterEstimate::upper95);
    };
    alone("sigma", "N/m", "σ of this record alone, with the series' α",
          &identification::RecordAlone::stiffness);
    alone("slip_force", "N", "Tc of this record alone, with the series' α",
          &identification::RecordAlone::slip_force);
    rows.push_back({"contact_radius", "m", "a = σG*/8; absent unless G* is known",
                    IfAny(&Item::contact_radius, &UncertainValue::value)});
    rows.push_back({"hertz_contact_radius", "m",
                    "a of Hertz; absent unless materials and radii are known",
                    IfAny(&Item::hertz_radius)});
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
      {"name", "", "sphere, elements, cone, flat_punch or rough", &Item::name},
      {"exponent", "-", "exponent that the theory predicts; for elements in parallel the fitted α",
       &Item::exponent},
      {"difference", "-", "p minus that exponent", &Item::difference, WhyHypothesisNotTested},
      {"z", "-", "difference over its standard error", &Item::z, WhyHypothesisNotTested},
      {"p_value", "-", "two-sided p-value of z", &Item::p_value, WhyHypothesisNotTested},
  };
  return fields;
}

std::string WhyNoInterval(const QuantityUnderLaw& item) {
  return item.value.standard_error > 0 ? "the series does not determine it"
                                       : "all parameters that it follows from are fixed";
}

/// Returns the fields of a quantity in addition to those of every quantity of the contact.
const std::vector<Field<QuantityUnderLaw>>& QuantityFields() {
  using Item = QuantityUnderLaw;
  static const std::vector<Field<Item>> fields = {
      {"ci95[0]", "of the quantity", "lower end of the interval",
       At(&Item::interval95, &Interval::lower), WhyNoInterval},
      {"ci95[1]", "of the quantity", "upper end of the interval",
       At(&Item::interval95, &Interval::upper), WhyNoInterval},
      {"predicted", "of the quantity",
       "value predicted from the bodies; absent where they are not known", IfAny(&Item::predicted)},
  };
  return fields;
}

Value QuantityValues(const LoadLaw& law) {
  Value quantities{.json = Json::object(), .is_absent = false};
  for (const QuantityUnderLaw& quantity : law.quantities) {
    Value members = PropagatedMembers(quantity.value, quantity.unit);
    members.Add(Render(QuantityFields(), quantity));
    quantities.Set(std::string(quantity.key), std::move(members));
  }
  return quantities;
}

const std::vector<Field<LoadLaw>>& LoadLawFields() {
  using Item = LoadLaw;
  const auto why_exact = "sigma was held";
  static const std::vector<Field<Item>> fields = {
      {"name", "", "name of the hypothesis", &Item::name},
      {"exponent", "-",
       "exponent p of the hypothesis; for elements in parallel the p = α nearest to both",
       &Item::exponent},
      {"sigma.value", "N/m", "σ at the reference load, with that p",
       At(&Item::stiffness, &UncertainValue::value)},
      {"sigma.standard_error", "N/m", "standard error",
       At(&Item::stiffness, &UncertainValue::standard_error), "the series does not determine it"},
      {"sigma.ci95[0]", "N/m", "lower end of the interval",
       At(&Item::stiffness95, &Interval::lower), why_exact},
      {"sigma.ci95[1]", "N/m", "upper end of the interval",
       At(&Item::stiffness95, &Interval::upper), why_exact},
      {"quantities", "", "quantities of the contact that follow, by name; may be empty",
       QuantityValues},
  };
  return fields;
}

}  // namespace

void AddLoadSeriesFields(FieldTable& table) {
  table.Add({
      {"load_series.reference_load", "N",
       "N₀, mean of the records' loads, at which σ and Tc of parameters are given; load_series is "
       "absent where the records have one load",
       IfAny([](const Report& report) { return If(report.load_series.has_value(), report); },
             [](const Report& report) { return report.fit.normal_load.value_or(NAN); })},
      {"load_series.records", "", "the contact at the load of each file",
       IfAny(&Report::load_series,
             [](const auto& series) { return List(ContactFieldsUnderLoad(), series.contacts); })},
      {"load_series.hypotheses", "", "p of σ ∝ N^p compared with theories",
       IfAny(&Report::load_series,
             [](const auto& series) { return List(HypothesisFields(), series.hypotheses); })},
      {"load_series.laws", "", "the tenable hypotheses, each assumed at all loads",
       IfAny(&Report::load_series,
             [](const auto& series) { return List(LoadLawFields(), series.laws); })},
  });
  table.Describe("load_series.records[].", ContactFieldsUnderLoad());
  table.Describe("load_series.hypotheses[].", HypothesisFields());
  table.Describe("load_series.laws[].", LoadLawFields());
  table.Describe("load_series.laws[].quantities.NAME.", PropagatedFields());
  table.Describe("load_series.laws[].quantities.NAME.", QuantityFields());
}

using contact::ContactQuantity;

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
      rows.push_back({name, unit, label, At(member, &PropagatedValue::value)});
      rows.push_back({name + "_standard_error", unit, "standard error, from the inputs alone",
                      At(member, &PropagatedValue::standard_error)});
    };
    const auto propagated = [&](const char* path, const char* unit, const char* label,
                                PropagatedValue Item::*member) {
      rows.push_back({path, unit, label, [member, unit](const Item& item) {
                        return PropagatedQuantity{item.*member, unit};
                      }});
    };
    of_inputs("contact_radius", "m", "a of Hertz", &Item::contact_radius);
    of_inputs("sigma", "N/m", "8a/G*", &Item::tangential_stiffness);
    propagated("gross_slip_displacement", "m", "3·Tc·G*/(16a) with the measured Tc",
               &Item::gross_slip_displacement);
    of_inputs("equivalent_radius", "m", "from the two radii", &Item::equivalent_radius);
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
    rows.push_back({fmt::format("contact.{}", field.key), std::string(field.unit),
                    std::string(field.label),
                    [&field](const Report& report) {
                      return PropagatedQuantity{field.get(report), field.unit};
                    },
                    field.why_null});
    if (field.key != "compliance") continue;
    rows.push_back({"contact.compliance_definition", "", "definition of G*",
                    [](const Report&) { return "G* = (2-nu1)/G1 + (2-nu2)/G2"; }});
    rows.push_back({"contact.compliance_unit", "", "unit of compliance",
                    [](const Report&) { return "1/Pa"; }});
  }
  rows.push_back({"contact.normal_load", "N", "normal load, given or the mean of its column",
                  [](const Report& report) {
                    OrNull load{.why = "not given, and no column has it"};
                    if (report.known.normal_load) load.number = report.known.normal_load->value;
                    return load;
                  }});
  rows.push_back(
      {"contact.hertz_mindlin", "",
       "what Hertz and Mindlin predict; absent unless materials, radii and load are known",
       IfAny(&Report::contact, &contact::IdentifiedContact::hertz,
             [](const auto& hertz) { return Render(HertzFields(), hertz); })});
  table.Add(std::move(rows));
  table.Describe("contact.QUANTITY.", PropagatedFields());
  table.Describe("contact.hertz_mindlin.", HertzFields());
}

}  // namespace mindahl::report
