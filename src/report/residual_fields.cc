#include "mindahl/identification/fit_result.h"
#include "mindahl/report/units.h"
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
      {"code", "", "stable, for scripts", &Item::code},
      {"try", "", "option of the command line that takes it into account",
       [](const Item& item) { return item.option.empty() ? Missing() : ToValue(item.option); },
       WhyNoOption},
      {"delta_aicc", "-", "of the fit with it less that without: negative where it helps",
       &Item::delta_aicc},
      {"explains", "-", "fraction of the residuals' variance", &Item::explains},
      {"size", "of the cause", "how large it is; of several numbers the first",
       [](const Item& item) { return item.unit.empty() ? Missing() : ToValue(item.size); },
       "it is of several numbers, none of which says much"},
      {"unit", "", "unit of the size",
       [](const Item& item) { return item.unit.empty() ? Missing() : ToValue(item.unit); },
       "it has no size"},
      {"moves", "-", "sigma, alpha or slip_force with it, in halves of their intervals: the most",
       &Item::moves},
  };
  return fields;
}

/// Makes a field of the adequacy, null where there is no verdict.
template <typename Get>
Field<Report> AdequacyRow(const char* path, const char* unit, const char* label, Get get) {
  return {path, unit, label,
          [get](const Report& report) {
            return IsJudged(report) ? At(get)(report.fit.adequacy) : Missing();
          },
          kWhyNotJudged};
}

}  // namespace

void AddAdequacyFields(FieldTable& table) {
  table.Add({
      AdequacyRow("adequacy.verdict", "", "adequate, doubtful or inadequate", &Adequacy::verdict),
      AdequacyRow("adequacy.misfit_over_noise", "-",
                  "rms of what the model misses over that of the noise",
                  &Adequacy::misfit_over_noise),
      {"adequacy.misfit_over_half_gap", "-",
       "rms of what the model misses over the half gap measured without a model",
       [](const Report& report) {
         return IsJudged(report) ? ToValue(report.fit.adequacy.misfit_over_half_gap) : Missing();
       },
       [](const Report& report) {
         return IsJudged(report) ? std::string("no half gap was measured")
                                 : std::string(kWhyNotJudged);
       }},
      AdequacyRow("adequacy.use", "", "quantitative, indicative or none: what the fit is good for",
                  &Adequacy::use),
      AdequacyRow("adequacy.p_value", "-", "that noise alone looks like that", &Adequacy::p_value),
      AdequacyRow("adequacy.causes", "",
                  "what the residuals look like, the best first; may be empty",
                  [](const Adequacy& adequacy) { return List(CauseFields(), adequacy.causes); }),
  });
  table.Describe("adequacy.causes[].", CauseFields());
}

using identification::MemoryComparison;
using identification::MemoryTest;

namespace {

const std::vector<Field<MemoryComparison>>& ComparisonFields() {
  using Item = MemoryComparison;
  static const std::vector<Field<Item>> fields = {
      {"code", "", "stable, for scripts", &Item::code},
      {"p_value", "-", "that noise alone makes it of a contact of Masing's memory", &Item::p_value},
      {"dahl_p_value", "-", "likewise of Dahl's", &Item::dahl_p_value},
      {"size", "N", "rms of what is beyond Masing's memory and beyond noise", &Item::size},
  };
  return fields;
}

std::string WhyNoMemory(const Report& report) {
  if (report.fit.depth < identification::Depth::kThorough) return "the fit was not asked for it";
  return "branches are not compared before the motion turns, where sigma or slip_force is held or "
         "bounded, under loads that vary or differ, with a lag or an asymmetry, and in a fit of "
         "the "
         "displacement";
}

}  // namespace

void AddMemoryFields(FieldTable& table) {
  const auto of_memory = [](auto member) {
    return At(&Report::fit, &identification::FitResult::memory, member);
  };
  table.Add({
      {"memory.verdict", "", "masing, dahl, neither or undecided", of_memory(&MemoryTest::verdict),
       WhyNoMemory},
      {"memory.p_value", "-", "of Masing's memory, by all comparisons",
       of_memory(&MemoryTest::p_value), WhyNoMemory},
      {"memory.dahl_p_value", "-", "of Dahl's", of_memory(&MemoryTest::dahl_p_value), WhyNoMemory},
      {"memory.tests", "", "comparisons that the record has; may be empty",
       [](const Report& report) {
         return report.fit.memory ? List(ComparisonFields(), report.fit.memory->comparisons)
                                  : Value{.json = Json::array(), .is_absent = false};
       }},
  });
  table.Describe("memory.tests[].", ComparisonFields());
}

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
            return residuals.samples > 0 ? ToValue(residuals.*member) : Missing();
          },
          "not a finite number"};
}

const std::vector<Field<StrokeBin>>& BinFields() {
  static const std::vector<Field<StrokeBin>> fields = {
      {"position", "-", "middle of the part, as a fraction of the travel between reversals",
       &StrokeBin::position},
      {"mean", kOfResponse, "mean residual there", &StrokeBin::mean},
      {"standard_error", kOfResponse, "of the mean, from the scatter between strokes",
       &StrokeBin::standard_error},
  };
  return fields;
}

const std::vector<Field<StrokeResiduals>>& StrokeFields() {
  using Item = StrokeResiduals;
  static const std::vector<Field<Item>> fields = {
      {"direction", "", "up or down",
       [](const Item& item) { return item.direction > 0 ? "up" : "down"; }},
      {"strokes", "", "strokes that count, those at least three quarters as long as the longest",
       &Item::strokes},
      {"mean", kOfResponse, "mean residual", &Item::mean},
      {"rms", kOfResponse, "root mean square of the residual", &Item::rms},
      {"along_stroke", "", "parts of the stroke",
       [](const Item& item) { return List(BinFields(), item.bins); }},
  };
  return fields;
}

const std::vector<Field<RecordFit>>& StructureFields() {
  static const std::vector<Field<RecordFit>> fields = {
      {"repeatable_share", "-", "fraction of the variance that repeats in every stroke",
       [](const RecordFit& item) { return item.structure.repeatable_share; }},
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
       [](const Report& report) { return Name(report.fit.response); }},
      {"residuals.force_noise", "N",
       "standard deviation of the force, given or estimated; 0 where it is imposed",
       [](const Report& report) {
         return report.failed() ? Missing() : ToValue(report.fit.force_noise);
       }},
      {"residuals.outliers", "", "samples that the loss gives less than half their weight",
       [](const Report& report) { return report.fit.outliers; }},
      {"residual_structure", "", "the repeatable residual, one entry a file",
       [](const Report& report) { return List(StructureFields(), report.fit.records); }},
  });
  table.Describe("residual_structure[].", StructureFields());
  table.Describe("residual_structure[].directions[].", StrokeFields());
  table.Describe("residual_structure[].directions[].along_stroke[].", BinFields());
}

}  // namespace mindahl::report
