#include "report/fields.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <functional>
#include <utility>

#include "mindahl/core/version.h"
#include "mindahl/report/contact.h"
#include "report/field.h"
#include "report/names.h"

namespace mindahl::report {
namespace {

std::string WhyFailed(const Report& report) { return "the fit failed: " + report.fit.termination; }

// --- parameters and their correlation

struct ReportedParameter {
  const Report& report;
  const ParameterEstimate& estimate;
};

std::string WhyNoError(const ReportedParameter& item) {
  if (item.report.failed()) return WhyFailed(item.report);
  switch (item.estimate.status) {
    case ParameterStatus::kFixed:
      return "held, not fitted";
    case ParameterStatus::kAtLowerBound:
    case ParameterStatus::kAtUpperBound:
      return "at its bound, where the interval is one-sided";
    case ParameterStatus::kFree:
      break;
  }
  return "the record leaves it open";
}

std::string WhyOpen(const ReportedParameter& item) {
  if (item.report.failed()) return WhyFailed(item.report);
  return item.estimate.status == ParameterStatus::kFixed ? "held, not fitted"
                                                         : "the record sets no limit there";
}

const std::vector<Field<ReportedParameter>>& ParameterFields() {
  using Item = ReportedParameter;
  static const std::vector<Field<Item>> fields = {
      {"value", "of the parameter", "estimate",
       [](const Item& item) { return Number(item.estimate.value); },
       [](const Item& item) { return WhyFailed(item.report); }},
      {"unit", "", "unit of value, error and interval",
       [](const Item& item) { return Text(item.estimate.unit); }},
      {"standard_error", "of the parameter", "standard error",
       [](const Item& item) { return Number(item.estimate.standard_error); }, WhyNoError},
      {"ci95[0]", "of the parameter", "lower end of the 95 % interval",
       [](const Item& item) { return Number(item.estimate.lower95); }, WhyOpen},
      {"ci95[1]", "of the parameter", "upper end of the 95 % interval",
       [](const Item& item) { return Number(item.estimate.upper95); }, WhyOpen},
      {"status", "", "free, fixed, at_lower_bound or at_upper_bound",
       [](const Item& item) { return Text(Name(item.estimate.status)); }},
      {"identifiability", "", "identifiable, bounded_below, bounded_above or not_identifiable",
       [](const Item& item) { return Text(Name(item.estimate.identifiability)); }},
  };
  return fields;
}

ParameterEstimate NotEstimated(const char* name, const char* unit) {
  ParameterEstimate estimate;
  estimate.name = name;
  estimate.unit = unit;
  estimate.value = NAN;
  estimate.status = ParameterStatus::kFree;
  return estimate;
}

Value Parameters(const Report& report) {
  const std::vector<ParameterEstimate> missing = {
      NotEstimated("sigma", "N/m"), NotEstimated("alpha", "-"), NotEstimated("slip_force", "N")};
  Value::Object object;
  for (const ParameterEstimate& estimate : report.failed() ? missing : report.fit.parameters) {
    object.emplace_back(estimate.name, Value{Render(ParameterFields(), {report, estimate})});
  }
  return {std::move(object)};
}

Value Correlations(const Report& report) {
  const FitResult& fit = report.fit;
  const std::size_t count = fit.parameters.size();
  const auto undefined = [&](std::size_t i) {
    return !std::isfinite(fit.correlation[i * count + i]);
  };
  Value::Object object;
  for (std::size_t i = 0; i < count; ++i) {
    if (fit.parameters[i].status == ParameterStatus::kFixed) continue;
    Value::Object row;
    for (std::size_t j = 0; j < count; ++j) {
      if (fit.parameters[j].status == ParameterStatus::kFixed) continue;
      Value value = Number(fit.correlation[i * count + j]);
      if (std::holds_alternative<Value::Null>(value.content)) {
        value = Missing(fmt::format("{} is at a bound or undetermined",
                                    fit.parameters[undefined(i) ? i : j].name));
      }
      row.emplace_back(fit.parameters[j].name, std::move(value));
    }
    object.emplace_back(fit.parameters[i].name, Value{std::move(row)});
  }
  return {std::move(object)};
}

// --- residuals

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
      {"position", "-", "middle of the part, as a share of the way between reversals",
       [](const StrokeBin& bin) { return Number(bin.position); }},
      {"mean", "N", "mean residual there", [](const StrokeBin& bin) { return Number(bin.mean); }},
      {"standard_error", "N", "of the mean, from the scatter between strokes",
       [](const StrokeBin& bin) { return Number(bin.standard_error); }},
  };
  return fields;
}

const std::vector<Field<StrokeResiduals>>& StrokeFields() {
  using Item = StrokeResiduals;
  static const std::vector<Field<Item>> fields = {
      {"direction", "", "up or down",
       [](const Item& item) { return Text(item.direction > 0 ? "up" : "down"); }},
      {"strokes", "", "strokes that count", [](const Item& item) { return Count(item.strokes); }},
      {"mean", "N", "mean residual", [](const Item& item) { return Number(item.mean); }},
      {"rms", "N", "root mean square", [](const Item& item) { return Number(item.rms); }},
      {"along_stroke", "", "parts of the stroke",
       [](const Item& item) { return List(BinFields(), item.bins); }},
  };
  return fields;
}

const std::vector<Field<RecordFit>>& StructureFields() {
  static const std::vector<Field<RecordFit>> fields = {
      {"repeatable_share", "-", "share of the variance that comes back in every stroke",
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

// --- the choice between models

std::string WhyNoScore(const ModelScore&) { return "this model has no fit to the record"; }

std::string WhyNothingHeldOut(const ModelScore& score) {
  return score.redundant ? "redundant: a simpler model is the same"
                         : "there is no cycle to hold out, or the fit without it failed";
}

const std::vector<Field<ModelScore>>& ScoreFields() {
  using Item = ModelScore;
  static const std::vector<Field<Item>> fields = {
      {"model", "", "name", [](const Item& item) { return Text(item.model->name); }},
      {"rig", "", "with a fitted spring in series",
       [](const Item& item) { return Flag(item.rig); }},
      {"free_parameters", "", "number",
       [](const Item& item) { return Count(item.free_parameters); }},
      {"rms", "N", "of the samples that are scored",
       [](const Item& item) { return Number(item.rms); }, WhyNoScore},
      {"aicc", "-", "AICc on effective samples", [](const Item& item) { return Number(item.aicc); },
       WhyNoScore},
      {"delta_aicc", "-", "above the least",
       [](const Item& item) { return Number(item.delta_aicc); }, WhyNoScore},
      {"akaike_weight", "-", "weight", [](const Item& item) { return Number(item.akaike_weight); },
       WhyNoScore},
      {"held_out_rms", "N", "error of predicting cycles held out",
       [](const Item& item) { return Number(item.held_out_rms); }, WhyNothingHeldOut},
      {"held_out_standard_error", "N", "of held_out_rms",
       [](const Item& item) { return Number(item.held_out_standard_error); }, WhyNothingHeldOut},
      {"converged", "", "did the fit", [](const Item& item) { return Flag(item.converged); }},
      {"at_bound", "", "a free parameter ran to a bound",
       [](const Item& item) { return Flag(item.at_bound); }},
      {"redundant", "", "the same as a simpler model",
       [](const Item& item) { return Flag(item.redundant); }},
      {"remark", "", "what else is to be known",
       [](const Item& item) { return Text(item.remark); }},
  };
  return fields;
}

const std::vector<Field<ModelSelection>>& SelectionFields() {
  using Item = ModelSelection;
  static const std::vector<Field<Item>> fields = {
      {"chosen", "", "place in models", [](const Item& item) { return Count(item.chosen); }},
      {"indistinguishable", "", "places in models, simplest first",
       [](const Item& item) {
         Value::Array places;
         for (const std::size_t place : item.indistinguishable) places.push_back(Count(place));
         return Value{std::move(places)};
       }},
      {"effective_samples", "-", "of the criterion",
       [](const Item& item) { return Number(item.effective_samples); },
       [](const Item&) { return std::string("no model has a fit to the record"); }},
      {"held_out_cycles", "", "each was predicted once",
       [](const Item& item) { return Count(item.held_out_cycles); }},
      {"verdict", "", "in words", [](const Item& item) { return Text(item.verdict); }},
      {"models", "", "every model without, then with a rig",
       [](const Item& item) { return List(ScoreFields(), item.scores); }},
  };
  return fields;
}

// --- the solver

std::vector<Field<StartReport>> LawFields(const std::string& prefix, BranchLaw StartReport::*law) {
  const auto why = [](const StartReport&) {
    return std::string("the solver came to nothing finite from here");
  };
  const auto row = [&](const char* name, const char* unit, double BranchLaw::*member) {
    return Field<StartReport>{
        prefix + "." + name, unit, name,
        [law, member](const StartReport& item) { return Number(item.*law.*member); }, why};
  };
  return {row("sigma", "N/m", &BranchLaw::tangential_stiffness),
          row("alpha", "-", &BranchLaw::shape_exponent),
          row("slip_force", "N", &BranchLaw::slip_force)};
}

const std::vector<Field<StartReport>>& StartFields() {
  using Item = StartReport;
  static const std::vector<Field<Item>> fields = [] {
    const auto why = [](const Item&) { return std::string("the cost is not finite here"); };
    std::vector<Field<Item>> rows = {
        {"from", "", "grid, or seed where it was drawn",
         [](const Item& item) { return Text(item.drawn ? "seed" : "grid"); }}};
    const auto append = [&](const std::vector<Field<Item>>& more) {
      rows.insert(rows.end(), more.begin(), more.end());
    };
    append(LawFields("start", &Item::start));
    append({{"initial_rms", "N", "at the start",
             [](const Item& item) { return Number(item.initial_rms); }, why}});
    append(LawFields("reached", &Item::reached));
    append({{"final_rms", "N", "where it ended",
             [](const Item& item) { return Number(item.final_rms); }, why},
            {"converged", "", "did the solver",
             [](const Item& item) { return Flag(item.converged); }}});
    return rows;
  }();
  return fields;
}

// --- the contact

const std::vector<Field<PropagatedValue>>& PropagatedFields() {
  using Item = PropagatedValue;
  static const std::vector<Field<Item>> fields = {
      {"value", "of the quantity", "value", [](const Item& item) { return Number(item.value); }},
      {"standard_error", "of the quantity", "of the fit and of what is known besides it",
       [](const Item& item) { return Number(item.standard_error); },
       [](const Item&) {
         return std::string("the record leaves open the parameter that it rests on");
       }},
      {"unit", "", "of value and error", [](const Item&) { return Text("-"); }},
      {"from_fit", "-", "the fit's share of the variance",
       [](const Item& item) { return Number(item.FitShare()); }},
      {"from_inputs", "-", "the inputs' share of the variance",
       [](const Item& item) { return Number(item.InputShare()); }},
      {"largest_input", "", "the input that contributes most; absent where all are exact",
       [](const Item& item) {
         return item.largest_input.empty() ? Value{} : Text(item.largest_input);
       }},
  };
  return fields;
}

/// With the unit of the quantity, which the table does not know.
Value::Object PropagatedMembers(const PropagatedValue& value, std::string_view unit) {
  Value::Object object = Render(PropagatedFields(), value);
  Place(object, "unit", Text(unit));
  return object;
}

Value Propagated(const std::optional<PropagatedValue>& value, std::string_view unit) {
  return value ? Value{PropagatedMembers(*value, unit)} : Missing();
}

std::string WhyNotIdentified(const Report& report, ContactQuantity quantity) {
  if (report.failed()) return WhyFailed(report);
  return fmt::format("needs {}", fmt::join(MissingInputs(report.known, quantity), ", "));
}

template <ContactQuantity kQuantity>
std::string WhyNotIdentified(const Report& report) {
  return WhyNotIdentified(report, kQuantity);
}

const std::vector<Field<HertzPrediction>>& HertzFields() {
  using Item = HertzPrediction;
  static const std::vector<Field<Item>> fields = [] {
    std::vector<Field<Item>> rows;
    const auto of_inputs = [&](const std::string& name, const char* unit, const char* label,
                               PropagatedValue Item::*member) {
      rows.push_back(
          {name, unit, label, [member](const Item& item) { return Number((item.*member).value); }});
      rows.push_back(
          {name + "_standard_error", unit, "of inputs alone",
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

// --- the mapping

const std::vector<Field<BranchShape>>& BranchFields() {
  using Item = BranchShape;
  const auto why = [](const Item&) { return std::string("this branch alone does not tell it"); };
  static const std::vector<Field<Item>> fields = {
      {"branch", "", "virgin, unloading or reloading",
       [](const Item& item) { return Text(item.branch); }},
      {"samples", "", "of the branch", [](const Item& item) { return Count(item.samples); }},
      {"alpha", "-", "of this branch alone",
       [](const Item& item) { return Number(item.shape_exponent); }, why},
      {"standard_error", "-", "of alpha",
       [](const Item& item) { return Number(item.standard_error); }, why},
  };
  return fields;
}

std::string WhyNotTested(const StiffnessTest& test) {
  return test.ratio.standard_error > 0 ? "the record leaves sigma open"
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
      {"ci95[0]", "-", "lower end of the 95 % interval", end(&Interval::lower), WhyNotTested},
      {"ci95[1]", "-", "upper end of the 95 % interval", end(&Interval::upper), WhyNotTested},
      {"z", "-", "(ratio − 1)/SE", [](const Item& item) { return Number(item.z); }, WhyNotTested},
      {"p_value", "-", "two-sided", [](const Item& item) { return Number(item.p_value); },
       WhyNotTested},
  };
  return fields;
}

void Append(Value::Object& object, Value::Object more) {
  for (auto& member : more) object.push_back(std::move(member));
}

Value StiffnessTests(const Report& report) {
  Value::Array array;
  for (const StiffnessTest& test : report.stiffness) {
    Value::Object object;
    object.emplace_back("radius", Text(test.radius));
    Append(object, PropagatedMembers(test.ratio, "-"));
    Append(object, Render(StiffnessFields(), test));
    array.push_back({std::move(object)});
  }
  return {std::move(array)};
}

std::string WhyAlphaNotTested(const Report& report) {
  return report.fit.Find("alpha")->status == ParameterStatus::kFixed
             ? "alpha was held, so alpha = 1/3 is not tested"
             : "alpha has no standard error: it is at a bound or undetermined";
}

std::string WhyNoLikelihoodRatio(const Report&) { return "alpha is held or not determined"; }

std::string WhyNoRig(const Report& report) {
  return report.fit.mindlin_test ? "alpha = 1/3 is not rejected, alpha is the larger one, a rig is "
                                   "fitted, or none helps"
                                 : WhyNoLikelihoodRatio(report);
}

Field<Report> Likelihood(const char* path, const char* unit, const char* label,
                         std::function<std::optional<double>(const MindlinTest&)> get,
                         std::string (*why)(const Report&)) {
  return {path, unit, label,
          [get = std::move(get)](const Report& report) {
            return report.fit.mindlin_test ? Number(get(*report.fit.mindlin_test)) : Missing();
          },
          why};
}

std::string WhyNoRatio(const Report& report) {
  return report.stiffness.empty()
             ? "needs a contact radius known besides the fit: the elastic constants and radii of "
               "both bodies with the load, or a contact radius with the compliance or the elastic "
               "constants"
             : "the record leaves sigma open";
}

// --- all of it

/// The sum over the records of what one of them has.
template <typename Get>
std::function<Value(const Report&)> Sum(Get get) {
  return [get](const Report& report) {
    std::size_t sum = 0;
    for (const RecordFit& record : report.fit.records) sum += get(record);
    return Count(sum);
  };
}

std::function<Value(const Report&)> OneARecord(double RecordFit::*member) {
  return [member](const Report& report) {
    Value::Array array;
    for (const RecordFit& record : report.fit.records) array.push_back(Number(record.*member));
    return Value{std::move(array)};
  };
}

std::function<Value(const Report&)> Measured(double LoopMeasures::*member) {
  return
      [member](const Report& report) { return Number(report.fit.WidestRecord().measures.*member); };
}

Value UnitOf(const std::optional<ChosenColumn>& column) {
  return column ? Text(column->unit) : Value{};
}

void AppendInput(std::vector<Field<Report>>& rows) {
  const std::vector<Field<Report>> more = {
      {"schema", "", "name and version of this form",
       [](const Report&) { return Text("mindahl.fit/1"); }},
      {"version", "", "of mindahl", [](const Report&) { return Text(Version()); }},
      {"input.files", "", "names of the files",
       [](const Report& report) {
         Value::Array files;
         for (const std::string& file : report.files) files.push_back(Text(file));
         return Value{std::move(files)};
       }},
      {"input.samples", "", "read, those that do not count too",
       [](const Report& report) {
         std::size_t samples = 0;
         for (const RecordFile& input : report.records) samples += input.record.size();
         return Count(samples);
       }},
      {"input.cycles", "", "complete cycles",
       Sum([](const RecordFit& record) { return record.measures.cycles; })},
      {"input.reversals", "", "turning points",
       Sum([](const RecordFit& record) { return record.reversals.size(); })},
      {"input.units.displacement", "", "of the first file",
       [](const Report& report) { return Text(report.records.front().displacement.unit); }},
      {"input.units.force", "", "of the first file",
       [](const Report& report) { return Text(report.records.front().force.unit); }},
      {"input.units.time", "", "of the first file; absent where it has none",
       [](const Report& report) { return UnitOf(report.records.front().time); }},
      {"input.units.normal_load", "", "of the first file; absent where it has none",
       [](const Report& report) { return UnitOf(report.records.front().normal_load); }},
      {"input.left_out", "", "samples that do not count",
       Sum([](const RecordFit& record) { return record.left_out; })},
      {"input.reversal_gate", "m", "one a file: excursions up to it are noise",
       OneARecord(&RecordFit::reversal_gate)},
      {"input.displacement_noise", "m", "one a file: standard deviation, given or estimated",
       OneARecord(&RecordFit::displacement_noise)},
      {"input.force_sign", "", "same or opposite, of force and displacement",
       [](const Report& report) { return Text(report.fit.force_sense > 0 ? "same" : "opposite"); }},
  };
  rows.insert(rows.end(), more.begin(), more.end());
}

void AppendFit(std::vector<Field<Report>>& rows) {
  const std::vector<Field<Report>> fit = {
      {"model", "", "name", [](const Report& report) { return Text(report.fit.model->name); }},
      {"initial_state", "", "virgin or steady",
       [](const Report& report) { return Text(Name(report.fit.initial_state)); }},
      {"parameters", "", "by name", Parameters},
      {"correlation", "-", "of the errors of free parameters", Correlations},
      Residual("rms", "N", "root mean square", &ResidualStatistics::rms),
      Residual("max_abs", "N", "largest", &ResidualStatistics::max_abs),
      Residual("normalized_rms", "-", "rms over Tc", &ResidualStatistics::normalized_rms),
      Residual("r_squared", "-", "R²", &ResidualStatistics::r_squared),
      Residual("durbin_watson", "-", "2 when white, near 0 when autocorrelated",
               &ResidualStatistics::durbin_watson),
      Residual("effective_samples", "-", "samples by their autocorrelation",
               &ResidualStatistics::effective_samples),
      Residual("degrees_of_freedom", "-", "of the errors", &ResidualStatistics::degrees_of_freedom),
      {"residuals.force_noise", "N", "standard deviation, given or estimated",
       [](const Report& report) {
         return report.failed() ? Missing() : Number(report.fit.force_noise);
       }},
      {"residuals.outliers", "", "samples that the loss gives less than half their weight",
       [](const Report& report) { return Count(report.fit.outliers); }},
      {"residual_structure", "", "one a file",
       [](const Report& report) { return List(StructureFields(), report.fit.records); }},
      {"model_selection", "", "where the model was chosen",
       [](const Report& report) {
         return report.selection ? Value{Render(SelectionFields(), *report.selection)} : Value{};
       }},
      {"solver.converged", "", "did it",
       [](const Report& report) { return Flag(report.fit.converged); }},
      {"solver.iterations", "", "number",
       [](const Report& report) { return Integer(report.fit.iterations); }},
      {"solver.termination", "", "why it stopped",
       [](const Report& report) { return Text(report.fit.termination); }},
      {"solver.starts", "", "where the solver began",
       [](const Report& report) { return List(StartFields(), report.fit.starts); }},
  };
  rows.insert(rows.end(), fit.begin(), fit.end());
}

/// Of the loop's description, where there is one.
template <typename Get>
std::function<Value(const Report&)> OfLoop(Get get) {
  return [get](const Report& report) { return report.loop ? get(*report.loop) : Missing(); };
}

void AppendLoop(std::vector<Field<Report>>& rows) {
  const std::vector<Field<Report>> more = {
      {"loop.amplitude", "m", "X of the widest record", Measured(&LoopMeasures::amplitude)},
      {"loop.centre", "m", "of its displacements", Measured(&LoopMeasures::centre)},
      {"loop.peak_force", "N", "T*", Measured(&LoopMeasures::peak_force)},
      {"loop.energy_per_cycle_measured", "J", "mean over closed cycles",
       [](const Report& report) {
         return Number(report.fit.WidestRecord().measures.energy_per_cycle);
       },
       [](const Report&) { return std::string("the record closes no cycle"); }},
      {"loop.energy_per_cycle_model", "J", "of the fitted law at the amplitude",
       OfLoop([](const LoopDescription& loop) { return Number(loop.model_energy); })},
      {"loop.energy_ratio", "-", "W/(4XT*), the model's W where none was measured",
       OfLoop([](const LoopDescription& loop) { return Number(loop.energy_ratio); }),
       [](const Report&) {
         return std::string("needs a force that differs between the extremes of the displacement");
       }},
      {"loop.slip_regime", "", "partial or gross",
       OfLoop([](const LoopDescription& loop) { return Text(Name(loop.regime)); })},
      {"loop.gross_slip_displacement", "m", "δc of the fitted law",
       OfLoop([](const LoopDescription& loop) { return Number(loop.gross_slip_displacement); }),
       [](const Report&) {
         return std::string("with alpha >= 1 the force only approaches slip_force");
       }},
      {"loop.stick_radius_ratio", "-", "c/a of a Mindlin contact",
       OfLoop([](const LoopDescription& loop) { return Number(loop.stick_radius_ratio); })},
  };
  rows.insert(rows.end(), more.begin(), more.end());
}

void AppendContact(std::vector<Field<Report>>& rows) {
  for (const ContactField& field : ContactFields()) {
    rows.push_back(
        {fmt::format("contact.{}", field.key), std::string(field.unit), std::string(field.label),
         [&field](const Report& report) { return Propagated(field.get(report), field.unit); },
         field.why_null});
    if (field.key != "compliance") continue;
    rows.push_back({"contact.compliance_definition", "", "which G* is meant",
                    [](const Report&) { return Text("G* = (2-nu1)/G1 + (2-nu2)/G2"); }});
    rows.push_back(
        {"contact.compliance_unit", "", "its unit", [](const Report&) { return Text("1/Pa"); }});
  }
  rows.push_back({"contact.normal_load", "N", "given or measured", [](const Report& report) {
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
}

void AppendMapping(std::vector<Field<Report>>& rows) {
  const auto ratio = [](double UncertainValue::*member) {
    return [member](const Report& report) {
      return report.stiffness.empty() ? Missing() : Number(report.stiffness.front().ratio.*member);
    };
  };
  const std::vector<Field<Report>> mapping = {
      {"mapping.alpha_minus_third", "-", "α − 1/3",
       [](const Report& report) { return Number(report.alpha.minus_third); }, WhyAlphaNotTested},
      {"mapping.z", "-", "(α − 1/3)/SE",
       [](const Report& report) { return Number(report.alpha.z); }, WhyAlphaNotTested},
      {"mapping.p_value", "-", "two-sided, of z",
       [](const Report& report) { return Number(report.alpha.p_value); }, WhyAlphaNotTested},
      Likelihood(
          "mapping.likelihood_ratio", "-", "α = 1/3 against the fitted α, twice its logarithm",
          [](const MindlinTest& test) { return test.likelihood_ratio; }, WhyNoLikelihoodRatio),
      Likelihood(
          "mapping.likelihood_ratio_p_value", "-", "of the likelihood ratio",
          [](const MindlinTest& test) { return test.p_value; }, WhyNoLikelihoodRatio),
      Likelihood(
          "mapping.tenable_with_rig_stiffness", "N/m", "rig with which α = 1/3 fits as well",
          [](const MindlinTest& test) { return test.rig_stiffness; }, WhyNoRig),
      {"mapping.alpha_by_branch", "", "α of each kind of branch alone",
       [](const Report& report) { return List(BranchFields(), report.fit.branch_shapes); }},
      {"mapping.sigma_over_hertz_mindlin", "-", "σ/(8a/G*)", ratio(&UncertainValue::value),
       WhyNoRatio},
      {"mapping.sigma_over_hertz_mindlin_standard_error", "-", "its error",
       ratio(&UncertainValue::standard_error), WhyNoRatio},
      {"mapping.stiffness_tests", "", "σ/(8a/G*) against 1, one a known radius", StiffnessTests},
  };
  rows.insert(rows.end(), mapping.begin(), mapping.end());
}

/// Every row of the report. What a fit that failed has not is null for that reason.
const std::vector<Field<Report>>& ReportFields() {
  static const std::vector<Field<Report>> fields = [] {
    std::vector<Field<Report>> rows;
    AppendInput(rows);
    AppendFit(rows);
    AppendLoop(rows);
    AppendContact(rows);
    AppendMapping(rows);
    for (Field<Report>& row : rows) {
      row.why_null = [why = std::move(row.why_null)](const Report& report) {
        if (report.failed()) return WhyFailed(report);
        return why ? why(report) : std::string("not a finite number");
      };
    }
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
         return report.failed() ? std::optional<PropagatedValue>()
                                : report.contact.gross_slip_displacement;
       },
       WhyFailed},
  };
  return fields;
}

Value::Object Document(const Report& report) { return Render(ReportFields(), report); }

}  // namespace mindahl::report
