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
      {"code", "", "stable name, for scripts", &Item::code},
      {"try", "", "option of the command line that takes it into account",
       [](const Item& item) {
         const bool is_offered = !item.option.empty() && !item.has_known_factor();
         return is_offered ? std::optional(item.option) : std::nullopt;
       },
       WhyNoOption},
      {"delta_aicc", "-", "AICc of the fit with it minus that without: negative where it helps",
       &Item::delta_aicc},
      {"explains", "-", "fraction of the residuals' variance that it explains", &Item::explains},
      {"size", "of the cause", "size of the cause; of several numbers the first",
       At([](const Item& item) { return If(!item.unit.empty(), item); }, &Item::size),
       "it has several numbers, none of which is significant alone"},
      {"unit", "", "unit of the size",
       At([](const Item& item) { return If(!item.unit.empty(), item); }, &Item::unit),
       "it has no size"},
      {"moves", "-",
       "largest change of sigma, alpha or slip_force with it, in half widths of their intervals",
       &Item::moves},
  };
  return fields;
}

std::optional<std::reference_wrapper<const Adequacy>> Judged(const Report& report) {
  return If(IsJudged(report), report.fit.adequacy);
}

/// Makes a field of the adequacy, null where there is no verdict.
template <typename Get>
Field<Report> AdequacyRow(const char* path, const char* unit, const char* label, Get get) {
  return {path, unit, label, At(&Judged, get), kWhyNotJudged};
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
       At(&Judged, &Adequacy::misfit_over_half_gap),
       [](const Report& report) {
         return IsJudged(report) ? std::string("no half gap was measured")
                                 : std::string(kWhyNotJudged);
       }},
      AdequacyRow("adequacy.use", "", "quantitative, indicative or none: what the fit is good for",
                  &Adequacy::use),
      AdequacyRow("adequacy.p_value", "-", "probability that noise alone looks like that",
                  &Adequacy::p_value),
      AdequacyRow("adequacy.causes", "",
                  "causes that the residuals look like, the best first; may be empty",
                  [](const Adequacy& adequacy) { return List(CauseFields(), adequacy.causes); }),
  });
  table.Describe("adequacy.causes[].", CauseFields());
}

using identification::RecordFit;
using identification::ResidualStatistics;
using identification::StrokeBin;
using identification::StrokeResiduals;

namespace {

Field<Report> Residual(const char* name, const char* unit, const char* label,
                       double ResidualStatistics::*member) {
  return {std::string("residuals.") + name, unit, label,
          At(
              [](const Report& report) {
                return If(report.fit.residuals.samples > 0, report.fit.residuals);
              },
              member)};
}

const std::vector<Field<StrokeBin>>& BinFields() {
  static const std::vector<Field<StrokeBin>> fields = {
      {"position", "-", "middle of the part, as a fraction of the travel between reversals",
       &StrokeBin::position},
      {"mean", kOfResponse, "mean residual in that part", &StrokeBin::mean},
      {"standard_error", kOfResponse,
       "standard error of the mean, from the scatter between strokes", &StrokeBin::standard_error},
  };
  return fields;
}

const std::vector<Field<StrokeResiduals>>& StrokeFields() {
  using Item = StrokeResiduals;
  static const std::vector<Field<Item>> fields = {
      {"direction", "", "up or down",
       [](const Item& item) { return item.direction > 0 ? "up" : "down"; }},
      {"strokes", "", "strokes that count: those at least three quarters as long as the longest",
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
               "Durbin-Watson statistic: 2 for white residuals, near 0 for autocorrelated ones",
               &ResidualStatistics::durbin_watson),
      Residual("effective_samples", "-", "number of independent samples with the same information",
               &ResidualStatistics::effective_samples),
      Residual("degrees_of_freedom", "-", "degrees of freedom of errors and tests",
               &ResidualStatistics::degrees_of_freedom),
      {"residuals.channel", "", "the fitted channel, in whose unit the residuals are",
       [](const Report& report) { return report.fit.response; }},
      {"residuals.force_noise", "N",
       "standard deviation of the force, given or estimated; 0 where it is imposed",
       At([](const Report& report) { return If(!report.failed(), report.fit); },
          &identification::FitResult::force_noise)},
      {"residuals.outliers", "", "samples with less than half weight under the loss",
       [](const Report& report) { return report.fit.outliers; }},
      {"residual_structure", "", "the repeatable residual, one entry per file",
       [](const Report& report) { return List(StructureFields(), report.fit.records); }},
  });
  table.Describe("residual_structure[].", StructureFields());
  table.Describe("residual_structure[].directions[].", StrokeFields());
  table.Describe("residual_structure[].directions[].along_stroke[].", BinFields());
}

}  // namespace mindahl::report
