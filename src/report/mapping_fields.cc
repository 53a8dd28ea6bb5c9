#include <utility>

#include "report/field_table.h"
#include "report/propagated_fields.h"

namespace mindahl::report {

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
      {"samples", "", "samples on these branches",
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
  return "the interval of alpha includes more than this model, and says otherwise";
}

std::string WhyNoRig(const Report& report) {
  return report.fit.mindlin_test ? "alpha = 1/3 is not rejected, alpha is the larger one, a rig is "
                                   "fitted, or none helps"
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
             ? "needs a contact radius known besides the fit: the elastic constants and radii of "
               "both bodies with the load, or a contact radius with the compliance or the elastic "
               "constants"
             : "the record leaves sigma open";
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
      {"mapping.p_value", "-", "two-sided, of z",
       [](const Report& report) { return Number(report.alpha.p_value); }, WhyAlphaNotTested},
      Likelihood("mapping.likelihood_ratio", "-",
                 "α = 1/3 against the fitted α, twice its logarithm",
                 &MindlinTest::likelihood_ratio),
      Likelihood("mapping.likelihood_ratio_p_value", "-", "of the likelihood ratio",
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
      {"mapping.stiffness_tests", "", "σ/(8a/G*) against 1, one a known radius", StiffnessTests},
  });
  table.Describe("mapping.alpha_by_branch[].", BranchFields());
  table.items.push_back({"mapping.stiffness_tests[].radius", "", "hertz, or given: whence a"});
  table.Describe("mapping.stiffness_tests[].", PropagatedFields());
  table.Describe("mapping.stiffness_tests[].", StiffnessFields());
}

}  // namespace mindahl::report
