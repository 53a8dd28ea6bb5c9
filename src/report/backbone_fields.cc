#include "mindahl/identification/backbone_estimate.h"
#include "report/field_table.h"

namespace mindahl::report {

using identification::BackboneEstimate;
using identification::BackbonePoint;
using identification::BandValue;

namespace {

const std::vector<Field<BackbonePoint>>& PointFields() {
  using Item = BackbonePoint;
  static const std::vector<Field<Item>> fields = {
      {"displacement", "m", "of first loading",
       [](const Item& item) { return Number(item.displacement); }},
      {"force", "N", "there, without a law",
       [](const Item& item) { return Number(item.force.value); }},
      {"ci95[0]", "N", "lower end of its band",
       [](const Item& item) { return Number(item.force.lower95); }},
      {"ci95[1]", "N", "upper end of its band",
       [](const Item& item) { return Number(item.force.upper95); }},
      {"law", "N", "of the fitted law", [](const Item& item) { return Number(item.law); }},
  };
  return fields;
}

template <typename Get>
Field<Report> BackboneRow(const std::string& path, const char* unit, const char* label, Get get) {
  return {path, unit, label, [get](const Report& report) {
            return report.backbone ? get(*report.backbone) : Value{};
          }};
}

void AddBand(FieldTable& table, const std::string& path, const char* label,
             BandValue BackboneEstimate::*band) {
  table.Add(
      {BackboneRow(path + ".value", "N/m", label,
                   [band](const BackboneEstimate& item) { return Number((item.*band).value); }),
       BackboneRow(path + ".ci95[0]", "N/m", "lower end of the interval",
                   [band](const BackboneEstimate& item) { return Number((item.*band).lower95); }),
       BackboneRow(path + ".ci95[1]", "N/m", "upper end of the interval",
                   [band](const BackboneEstimate& item) { return Number((item.*band).upper95); })});
}

}  // namespace

void AddBackboneFields(FieldTable& table) {
  AddBand(table, "backbone.first_stiffness", "secant over the first hundredth of the displacement",
          &BackboneEstimate::first_stiffness);
  AddBand(table, "backbone.elastic", "of what does not slip within the record",
          &BackboneEstimate::elastic);
  table.Add({
      BackboneRow("backbone.reaches_plateau", "",
                  "false: slip_force is the law's extrapolation beyond the record",
                  [](const BackboneEstimate& item) { return Flag(item.reaches_plateau); }),
      BackboneRow("backbone.rms", "N", "root mean square of what the backbone leaves",
                  [](const BackboneEstimate& item) { return Number(item.rms); }),
      BackboneRow("backbone.points", "", "from 0 to the largest displacement",
                  [](const BackboneEstimate& item) { return List(PointFields(), item.points); }),
  });
  table.Describe("backbone.points[].", PointFields());
}

}  // namespace mindahl::report
