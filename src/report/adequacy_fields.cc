#include "report/adequacy.h"
#include "report/field_table.h"
#include "report/names.h"

namespace mindahl::report {

using identification::Adequacy;
using identification::Cause;

namespace {

const std::vector<Field<Cause>>& CauseFields() {
  using Item = Cause;
  static const std::vector<Field<Item>> fields = {
      {"code", "", "stable, for scripts", [](const Item& item) { return Text(item.code); }},
      {"try", "", "option of the command line that takes it into account",
       [](const Item& item) { return item.option.empty() ? Missing() : Text(item.option); },
       WhyNoOption},
      {"delta_aicc", "-", "of the fit with it less that without: negative where it helps",
       [](const Item& item) { return Number(item.delta_aicc); }},
      {"explains", "-", "fraction of the residuals' variance",
       [](const Item& item) { return Number(item.explains); }},
      {"size", "of the cause", "how large it is; of several numbers the first",
       [](const Item& item) { return item.unit.empty() ? Missing() : Number(item.size); },
       [](const Item&) {
         return std::string("it is of several numbers, none of which says much");
       }},
      {"unit", "", "unit of the size",
       [](const Item& item) { return item.unit.empty() ? Missing() : Text(item.unit); },
       [](const Item&) { return std::string("it has no size"); }},
      {"moves", "-", "sigma, alpha or slip_force with it, in halves of their intervals: the most",
       [](const Item& item) { return Number(item.moves); }},
  };
  return fields;
}

/// Makes a field of the adequacy, null where there is no verdict.
template <typename Get>
Field<Report> AdequacyRow(const char* path, const char* unit, const char* label, Get get) {
  return {path, unit, label,
          [get](const Report& report) {
            return IsJudged(report) ? get(report.fit.adequacy) : Missing();
          },
          [](const Report&) { return std::string(kWhyNotJudged); }};
}

}  // namespace

void AddAdequacyFields(FieldTable& table) {
  table.Add({
      AdequacyRow("adequacy.verdict", "", "adequate, doubtful or inadequate",
                  [](const Adequacy& adequacy) { return Text(Name(adequacy.verdict)); }),
      AdequacyRow("adequacy.misfit_over_noise", "-",
                  "rms of what the model misses over that of the noise",
                  [](const Adequacy& adequacy) { return Number(adequacy.misfit_over_noise); }),
      {"adequacy.misfit_over_half_gap", "-",
       "rms of what the model misses over the half gap measured without a model",
       [](const Report& report) {
         return IsJudged(report) ? Number(report.fit.adequacy.misfit_over_half_gap) : Missing();
       },
       [](const Report& report) {
         return IsJudged(report) ? std::string("no half gap was measured")
                                 : std::string(kWhyNotJudged);
       }},
      AdequacyRow("adequacy.use", "", "quantitative, indicative or none: what the fit is good for",
                  [](const Adequacy& adequacy) { return Text(Name(adequacy.use)); }),
      AdequacyRow("adequacy.p_value", "-", "that noise alone looks like that",
                  [](const Adequacy& adequacy) { return Number(adequacy.p_value); }),
      AdequacyRow("adequacy.causes", "",
                  "what the residuals look like, the best first; may be empty",
                  [](const Adequacy& adequacy) { return List(CauseFields(), adequacy.causes); }),
  });
  table.Describe("adequacy.causes[].", CauseFields());
}

}  // namespace mindahl::report
