#include "mindahl/report/units.h"
#include "report/field_table.h"
#include "report/names.h"

namespace mindahl::report {

using identification::RecordFit;
using identification::ResidualStatistics;
using identification::StrokeBin;
using identification::StrokeResiduals;

namespace {

Field<Report> Residual(const char* name, const char* unit, const char* label,
                       double ResidualStatistics::*member) {
  return {std::string("residuals.") + name, unit, label,
          [member](const Report& report) {
            const ResidualStatistics& residuals = report.fit.residuals;
            return residuals.samples > 0 ? Number(residuals.*member) : Missing();
          },
          [](const Report&) { return std::string("not a finite number"); }};
}

const std::vector<Field<StrokeBin>>& BinFields() {
  static const std::vector<Field<StrokeBin>> fields = {
      {"position", "-", "middle of the part, as a fraction of the travel between reversals",
       [](const StrokeBin& bin) { return Number(bin.position); }},
      {"mean", kOfResponse, "mean residual there",
       [](const StrokeBin& bin) { return Number(bin.mean); }},
      {"standard_error", kOfResponse, "of the mean, from the scatter between strokes",
       [](const StrokeBin& bin) { return Number(bin.standard_error); }},
  };
  return fields;
}

const std::vector<Field<StrokeResiduals>>& StrokeFields() {
  using Item = StrokeResiduals;
  static const std::vector<Field<Item>> fields = {
      {"direction", "", "up or down",
       [](const Item& item) { return Text(item.direction > 0 ? "up" : "down"); }},
      {"strokes", "", "strokes that count, those at least three quarters as long as the longest",
       [](const Item& item) { return Count(item.strokes); }},
      {"mean", kOfResponse, "mean residual", [](const Item& item) { return Number(item.mean); }},
      {"rms", kOfResponse, "root mean square of the residual",
       [](const Item& item) { return Number(item.rms); }},
      {"along_stroke", "", "parts of the stroke",
       [](const Item& item) { return List(BinFields(), item.bins); }},
  };
  return fields;
}

const std::vector<Field<RecordFit>>& StructureFields() {
  static const std::vector<Field<RecordFit>> fields = {
      {"repeatable_share", "-", "fraction of the variance that repeats in every stroke",
       [](const RecordFit& item) { return Number(item.structure.repeatable_share); }},
      {"directions", "", "growing, then falling displacement",
       [](const RecordFit& item) {
         const auto& directions = item.structure.directions;
         return List(StrokeFields(),
                     std::vector<StrokeResiduals>(directions.begin(), directions.end()));
       }},
  };
  return fields;
}

}  // namespace

void AddResidualFields(FieldTable& table) {
  table.Add({
      Residual("rms", kOfResponse, "root mean square of fitted − measured",
               &ResidualStatistics::rms),
      Residual("max_abs", kOfResponse, "largest residual", &ResidualStatistics::max_abs),
      Residual("normalized_rms", "-", "rms over Tc, or over Tc/σ of a displacement",
               &ResidualStatistics::normalized_rms),
      Residual("r_squared", "-", "fraction of the fitted channel's variance that the fit explains",
               &ResidualStatistics::r_squared),
      Residual("durbin_watson", "-",
               "2 where residuals are white, near 0 where they are autocorrelated",
               &ResidualStatistics::durbin_watson),
      Residual("effective_samples", "-", "samples less what their autocorrelation takes away",
               &ResidualStatistics::effective_samples),
      Residual("degrees_of_freedom", "-", "degrees of freedom of errors and tests",
               &ResidualStatistics::degrees_of_freedom),
      {"residuals.channel", "", "the one that is fitted, whose unit residuals have",
       [](const Report& report) { return Text(Name(report.fit.response)); }},
      {"residuals.force_noise", "N",
       "standard deviation of the force, given or estimated; 0 where it is imposed",
       [](const Report& report) {
         return report.failed() ? Missing() : Number(report.fit.force_noise);
       }},
      {"residuals.outliers", "", "samples that the loss gives less than half their weight",
       [](const Report& report) { return Count(report.fit.outliers); }},
      {"residual_structure", "", "the repeatable residual, one entry a file",
       [](const Report& report) { return List(StructureFields(), report.fit.records); }},
  });
  table.Describe("residual_structure[].", StructureFields());
  table.Describe("residual_structure[].directions[].", StrokeFields());
  table.Describe("residual_structure[].directions[].along_stroke[].", BinFields());
}

}  // namespace mindahl::report
