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
      {"value", "of the quantity", "estimate", [](const Item& item) { return Number(item.value); }},
      {"standard_error", "of the quantity", "standard error from the fit and from the given inputs",
       [](const Item& item) { return Number(item.standard_error); },
       [](const Item&) {
         return std::string("the record does not determine the parameter that it follows from");
       }},
      {"unit", "", "unit of value and error", [](const Item&) { return Text("-"); }},
      {"from_fit", "-", "fraction of the variance from the fit",
       [](const Item& item) { return Number(item.FitShare()); }},
      {"from_inputs", "-", "fraction of the variance from the inputs",
       [](const Item& item) { return Number(item.InputShare()); }},
      {"largest_input", "", "the input that contributes most; absent where all are exact",
       [](const Item& item) {
         return item.largest_input.empty() ? Value{} : Text(item.largest_input);
       }},
  };
  return fields;
}

/// Returns members with the unit of the quantity, which the table does not know.
Value::Object PropagatedMembers(const PropagatedValue& value, std::string_view unit) {
  Value::Object object = Render(PropagatedFields(), value);
  Place(object, "unit", Text(unit));
  return object;
}

Value Propagated(const std::optional<PropagatedValue>& value, std::string_view unit) {
  return value ? Value{PropagatedMembers(*value, unit)} : Missing();
}

namespace {

std::string WhySlipForceOpen(const Report& report) {
  return report.slip_forces ? "slip_force and asymmetry are held, or the record does not determine "
                              "it"
                            : "slip_force or asymmetry is not identifiable";
}

/// Makes a row, absent of a fit that has one slip force.
template <typename Get>
Field<Report> SlipForceRow(const std::string& path, const char* label, Get get) {
  return {path, "N", label,
          [get](const Report& report) {
            if (report.fit.Find("asymmetry") == nullptr) return Value{};
            return report.slip_forces ? get(*report.slip_forces) : Missing();
          },
          WhySlipForceOpen};
}

std::vector<Field<Report>> RowsOf(const std::string& sense, const char* label,
                                  SlipForce SlipForces::*member) {
  const std::string path = "slip_forces." + sense;
  return {
      SlipForceRow(path + ".value", label,
                   [member](const SlipForces& forces) { return Number((forces.*member).value); }),
      SlipForceRow(
          path + ".standard_error", "standard error",
          [member](const SlipForces& forces) { return Number((forces.*member).standard_error); }),
      SlipForceRow(path + ".ci95[0]", "lower end of the interval",
                   [member](const SlipForces& forces) { return Number((forces.*member).lower95); }),
      SlipForceRow(
          path + ".ci95[1]", "upper end of the interval",
          [member](const SlipForces& forces) { return Number((forces.*member).upper95); })};
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

const std::vector<Field<identification::BranchShape>>& BranchFields() {
  using Item = identification::BranchShape;
  const auto why = [](const Item&) {
    return std::string("this branch alone does not determine it");
  };
  static const std::vector<Field<Item>> fields = {
      {"branch", "", "virgin, unloading or reloading",
       [](const Item& item) { return Text(item.branch); }},
      {"samples", "", "number of samples on these branches",
       [](const Item& item) { return Count(item.samples); }},
      {"alpha", "-", "α of these branches alone, the rest shared",
       [](const Item& item) { return Number(item.shape_exponent); }, why},
      {"standard_error", "-", "standard error of alpha",
       [](const Item& item) { return Number(item.standard_error); }, why},
  };
  return fields;
}

std::string WhyStiffnessNotTested(const StiffnessTest& test) {
  return test.ratio.standard_error > 0 ? "sigma is not identifiable"
                                       : "neither sigma nor an input is uncertain";
}

const std::vector<Field<StiffnessTest>>& StiffnessFields() {
  using Item = StiffnessTest;
  const auto end = [](double Interval::*member) {
    return [member](const Item& item) {
      return item.interval95 ? Number((*item.interval95).*member) : Missing();
    };
  };
  static const std::vector<Field<Item>> fields = {
      {"ci95[0]", "-", "lower end of the interval", end(&Interval::lower), WhyStiffnessNotTested},
      {"ci95[1]", "-", "upper end of the interval", end(&Interval::upper), WhyStiffnessNotTested},
      {"z", "-", "(ratio − 1)/SE", [](const Item& item) { return Number(item.z); },
       WhyStiffnessNotTested},
      {"p_value", "-", "two-sided", [](const Item& item) { return Number(item.p_value); },
       WhyStiffnessNotTested},
  };
  return fields;
}

void AppendMembers(Value::Object& object, Value::Object more) {
  for (auto& member : more) object.push_back(std::move(member));
}

Value StiffnessTests(const Report& report) {
  Value::Array array;
  for (const StiffnessTest& test : report.stiffness) {
    Value::Object object;
    object.push_back({"radius", Text(test.radius)});
    AppendMembers(object, PropagatedMembers(test.ratio, "-"));
    AppendMembers(object, Render(StiffnessFields(), test));
    array.push_back({std::move(object)});
  }
  return {std::move(array)};
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
  return {path, unit, label,
          [member](const Report& report) {
            return report.alpha.likelihood ? Number((*report.alpha.likelihood).*member) : Missing();
          },
          WhyNoLikelihoodRatio};
}

std::string WhyNoRatio(const Report& report) {
  return report.stiffness.empty()
             ? "needs a contact radius known apart from the fit: the elastic constants and "
               "radii of both bodies with the load, or a contact radius with the compliance or "
               "the elastic constants"
             : "the record does not determine sigma";
}

}  // namespace

void AddMappingFields(FieldTable& table) {
  const auto ratio = [](double UncertainValue::*member) {
    return [member](const Report& report) {
      return report.stiffness.empty() ? Missing() : Number(report.stiffness.front().ratio.*member);
    };
  };
  table.Add({
      {"mapping.alpha_minus_third", "-", "α − 1/3",
       [](const Report& report) { return Number(report.alpha.minus_third); }, WhyAlphaNotTested},
      {"mapping.z", "-", "(α − 1/3)/SE",
       [](const Report& report) { return Number(report.alpha.z); }, WhyAlphaNotTested},
      {"mapping.p_value", "-", "two-sided p-value of z",
       [](const Report& report) { return Number(report.alpha.p_value); }, WhyAlphaNotTested},
      Likelihood("mapping.likelihood_ratio", "-",
                 "α = 1/3 against the fitted α, twice its logarithm",
                 &MindlinTest::likelihood_ratio),
      Likelihood("mapping.likelihood_ratio_p_value", "-", "p-value of the likelihood ratio",
                 &MindlinTest::p_value),
      {"mapping.tenable_with_rig_stiffness", "N/m", "rig with which α = 1/3 fits as well",
       [](const Report& report) {
         return report.fit.mindlin_test ? Number(report.fit.mindlin_test->rig_stiffness)
                                        : Missing();
       },
       WhyNoRig},
      {"mapping.alpha_by_branch", "", "α of each kind of branch alone",
       [](const Report& report) { return List(BranchFields(), report.fit.branch_shapes); }},
      {"mapping.sigma_over_hertz_mindlin", "-", "σ/(8a/G*)", ratio(&UncertainValue::value),
       WhyNoRatio},
      {"mapping.sigma_over_hertz_mindlin_standard_error", "-", "standard error of σ/(8a/G*)",
       ratio(&UncertainValue::standard_error), WhyNoRatio},
      {"mapping.stiffness_tests", "", "σ/(8a/G*) against 1, one entry per known radius",
       StiffnessTests},
  });
  table.Describe("mapping.alpha_by_branch[].", BranchFields());
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
                    [](const Item& item) { return Number(item.normal_load); }});
    const auto of_series = [&](const std::string& name, const char* unit, const char* label,
                               UncertainValue Item::*member) {
      rows.push_back({name + ".value", unit, label,
                      [member](const Item& item) { return Number((item.*member).value); }});
      rows.push_back({name + ".standard_error", unit, "standard error",
                      [member](const Item& item) { return Number((item.*member).standard_error); },
                      WhySeriesOpen});
    };
    of_series("sigma", "N/m", "σ at this load, from the whole series", &Item::stiffness);
    of_series("slip_force", "N", "Tc at this load, from the whole series", &Item::slip_force);
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
      {"exponent", "-", "exponent that the theory predicts; for elements in parallel the fitted α",
       [](const Item& item) { return Number(item.exponent); }},
      {"difference", "-", "p minus that exponent",
       [](const Item& item) { return Number(item.difference); }, WhyHypothesisNotTested},
      {"z", "-", "difference over its standard error",
       [](const Item& item) { return Number(item.z); }, WhyHypothesisNotTested},
      {"p_value", "-", "two-sided p-value of z",
       [](const Item& item) { return Number(item.p_value); }, WhyHypothesisNotTested},
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
      {"predicted", "of the quantity",
       "value predicted from the bodies; absent where they are not known",
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
      {"name", "", "name of the hypothesis", [](const Item& item) { return Text(item.name); }},
      {"exponent", "-",
       "exponent p of the hypothesis; for elements in parallel the p = α nearest to both",
       [](const Item& item) { return Number(item.exponent); }},
      {"sigma.value", "N/m", "σ at the reference load, with that p",
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
      {"quantities", "", "quantities of the contact that follow, by name; may be empty",
       QuantityValues},
  };
  return fields;
}

}  // namespace

void AddLoadSeriesFields(FieldTable& table) {
  table.Add({
      {"load_series.reference_load", "N",
       "N₀, mean of the records' loads, at which σ and Tc of parameters are given; load_series "
       "is absent where the records have one load",
       [](const Report& report) {
         return report.load_series ? Number(report.fit.normal_load) : Value{};
       }},
      {"load_series.records", "", "the contact at the load of each file",
       [](const Report& report) {
         return report.load_series ? List(ContactFieldsUnderLoad(), report.load_series->contacts)
                                   : Value{};
       }},
      {"load_series.hypotheses", "", "p of σ ∝ N^p compared with theories",
       [](const Report& report) {
         return report.load_series ? List(HypothesisFields(), report.load_series->hypotheses)
                                   : Value{};
       }},
      {"load_series.laws", "", "the tenable hypotheses, each assumed at all loads",
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
      rows.push_back(
          {name, unit, label, [member](const Item& item) { return Number((item.*member).value); }});
      rows.push_back(
          {name + "_standard_error", unit, "standard error, from the inputs alone",
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
    rows.push_back(
        {fmt::format("contact.{}", field.key), std::string(field.unit), std::string(field.label),
         [&field](const Report& report) { return Propagated(field.get(report), field.unit); },
         field.why_null});
    if (field.key != "compliance") continue;
    rows.push_back({"contact.compliance_definition", "", "definition of G*",
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
