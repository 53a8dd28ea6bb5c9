#include <fmt/format.h>

#include <cmath>

#include "report/field_table.h"
#include "report/names.h"

namespace mindahl::report {

using identification::StartReport;
using models::BranchLaw;

namespace {

std::vector<Field<StartReport>> StartLawFields(const std::string& prefix, const char* where,
                                               BranchLaw StartReport::*law) {
  const auto why = "the solver reached no finite value from this start";
  const auto row = [&](const char* name, const char* unit, double BranchLaw::*member) {
    return Field<StartReport>{
        prefix + "." + name, unit, fmt::format("{} of the law {}", name, where),
        [law, member](const StartReport& item) { return item.*law.*member; }, why};
  };
  return {row("sigma", "N/m", &BranchLaw::tangential_stiffness),
          row("alpha", "-", &BranchLaw::shape_exponent),
          row("slip_force", "N", &BranchLaw::slip_force)};
}

const std::vector<Field<StartReport>>& StartFields() {
  using Item = StartReport;
  static const std::vector<Field<Item>> fields = [] {
    const auto why = "the cost is not finite at this start";
    std::vector<Field<Item>> rows = {
        {"from", "", "grid, or seed where it was drawn",
         [](const Item& item) { return item.drawn ? "seed" : "grid"; }}};
    const auto append = [&](const std::vector<Field<Item>>& more) {
      rows.insert(rows.end(), more.begin(), more.end());
    };
    append(StartLawFields("start", "at the start", &Item::start));
    append(
        {{"initial_rms", "N", "root mean square residual at the start", &Item::initial_rms, why}});
    append(StartLawFields("reached", "where it ended", &Item::reached));
    append({{"final_rms", "N", "root mean square residual where it ended", &Item::final_rms, why},
            {"converged", "", "true if the solver converged from this start", &Item::converged}});
    return rows;
  }();
  return fields;
}

}  // namespace

void AddSolverFields(FieldTable& table) {
  table.Add({
      {"solver.converged", "", "true if the solver converged",
       [](const Report& report) { return report.fit.converged; }},
      {"solver.iterations", "", "number of iterations",
       [](const Report& report) { return report.fit.solver.iterations; }},
      {"solver.solver", "",
       "which search of Ceres solved: tiny_solver, solve (with bounds), or none",
       [](const Report& report) { return report.fit.solver.solver; }},
      {"solver.termination", "", "Ceres' termination type",
       [](const Report& report) { return report.fit.solver.termination; }},
      {"solver.message", "", "why it stopped",
       [](const Report& report) { return report.fit.solver.message; }},
      {"solver.initial_cost", "", "half the sum of the squared weighted residuals at the start",
       [](const Report& report) { return report.fit.solver.initial_cost; },
       "the residuals at the start are not finite"},
      {"solver.final_cost", "", "half the sum of the squared weighted residuals at the end",
       [](const Report& report) { return report.fit.solver.final_cost; },
       "the residuals at the end are not finite"},
      {"solver.starts", "", "the starting points that were refined",
       [](const Report& report) { return List(StartFields(), report.fit.starts); }},
  });
  table.Describe("solver.starts[].", StartFields());
}

using identification::ParameterEstimate;
using identification::ParameterStatus;

namespace {

struct ReportedParameter {
  const Report& report;
  const ParameterEstimate& estimate;
};

constexpr auto kEstimate = [](const ReportedParameter& item) -> const ParameterEstimate& {
  return item.estimate;
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
  return "the record does not determine it";
}

std::string WhyIntervalOpen(const ReportedParameter& item) {
  if (item.report.failed()) return WhyFailed(item.report);
  return item.estimate.status == ParameterStatus::kFixed ? "held, not fitted"
                                                         : "the record sets no limit there";
}

const std::vector<Field<identification::IntervalPart>>& IntervalFields() {
  using Item = identification::IntervalPart;
  const auto why = "open at this end";
  static const std::vector<Field<Item>> fields = {
      {"source", "",
       "origin of this part of ci95: parabola, profile, initial_state, other_minimum, "
       "omitted_terms, plateau, small_alpha, discrepancy or carried_force",
       &Item::source},
      {"ci95[0]", "of the parameter", "lower end of the contribution", &Item::lower, why},
      {"ci95[1]", "of the parameter", "upper end of the contribution", &Item::upper, why},
  };
  return fields;
}

const std::vector<Field<ReportedParameter>>& ParameterFields() {
  using Item = ReportedParameter;
  static const std::vector<Field<Item>> fields = {
      {"value", "of the parameter", "estimate", At(kEstimate, &ParameterEstimate::value),
       [](const Item& item) { return WhyFailed(item.report); }},
      {"unit", "", "unit of value, error and interval", At(kEstimate, &ParameterEstimate::unit)},
      {"standard_error", "of the parameter", "standard error",
       At(kEstimate, &ParameterEstimate::standard_error), WhyNoError},
      {"repeat_error", "of the parameter",
       "standard deviation that repeats of the test would have: standard_error of an adequate "
       "model, else from leaving out parts of the record's cycles",
       At(kEstimate, &ParameterEstimate::repeat_error),
       [](const Item& item) {
         return item.estimate.repeat_error || item.estimate.standard_error
                    ? std::string("fewer than three cycles")
                    : WhyNoError(item);
       }},
      {"ci95[0]", "of the parameter", "lower end of the interval",
       At(kEstimate, &ParameterEstimate::lower95), WhyIntervalOpen},
      {"ci95[1]", "of the parameter", "upper end of the interval",
       At(kEstimate, &ParameterEstimate::upper95), WhyIntervalOpen},
      {"ci95_parts", "", "contributions whose union is ci95",
       [](const Item& item) { return List(IntervalFields(), item.estimate.interval); }},
      {"prior.value", "of the parameter", "centre of its prior; absent without one",
       IfAny(kEstimate, &ParameterEstimate::prior, &identification::Prior::value)},
      {"prior.standard_uncertainty", "of the parameter", "standard uncertainty of the prior",
       IfAny(kEstimate, &ParameterEstimate::prior, &identification::Prior::standard_uncertainty)},
      {"without_priors.value", "of the parameter",
       "estimate of a fit without any prior; absent without priors",
       IfAny(kEstimate, &ParameterEstimate::without_priors, &identification::WithoutPriors::value)},
      {"without_priors.standard_error", "of the parameter", "its standard error",
       IfAny(kEstimate, &ParameterEstimate::without_priors,
             [](const auto& without) { return OrNull{without.standard_error}; }),
       "held, or not determined without the priors"},
      {"without_priors.moved", "-",
       "value minus the estimate without priors, over its standard error",
       IfAny(
           [](const Item& item) {
             return If(item.estimate.without_priors.has_value(), item.estimate);
           },
           [](const ParameterEstimate& estimate) { return OrNull{estimate.MovedByPriors()}; }),
       "held, or not determined without the priors"},
      {"status", "", "free, fixed, at_lower_bound or at_upper_bound",
       At(kEstimate, &ParameterEstimate::status)},
      {"identifiability", "",
       "identifiable, effective, extrapolated, bounded_below or not_identifiable",
       At(kEstimate, &ParameterEstimate::identifiability)},
  };
  return fields;
}

const std::vector<Field<identification::ConfidenceRegion>>& RegionFields() {
  using Item = identification::ConfidenceRegion;
  static const std::vector<Field<Item>> fields = {
      {"parameters[0]", "", "name of the first parameter",
       [](const Item& item) { return item.parameters[0]; }},
      {"parameters[1]", "", "name of the second",
       [](const Item& item) { return item.parameters[1]; }},
      {"closed", "", "true if the boundary was reached in every direction, or alpha = 0 before it",
       &Item::closed},
      {"boundary", "of the parameters", "points [first, second], once around the estimate",
       &Item::boundary},
  };
  return fields;
}

Value Regions(const std::vector<identification::ConfidenceRegion>& regions) {
  return regions.empty() ? Missing() : List(RegionFields(), regions);
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
  Value members{.json = Json::object(), .is_absent = false};
  for (const ParameterEstimate& estimate : report.failed() ? missing : report.fit.parameters) {
    members.Set(estimate.name, Render(ParameterFields(), {report, estimate}));
  }
  return members;
}

Value Correlations(const Report& report) {
  const identification::FitResult& fit = report.fit;
  const std::size_t count = fit.parameters.size();
  const auto undefined = [&](std::size_t i) {
    return !std::isfinite(fit.correlation[i * count + i]);
  };
  Value members{.json = Json::object(), .is_absent = false};
  for (std::size_t i = 0; i < count; ++i) {
    if (fit.parameters[i].status == ParameterStatus::kFixed) continue;
    Value row{.json = Json::object(), .is_absent = false};
    for (std::size_t j = 0; j < count; ++j) {
      if (fit.parameters[j].status == ParameterStatus::kFixed) continue;
      const double value = fit.correlation[i * count + j];
      row.Set(fit.parameters[j].name,
              std::isfinite(value)
                  ? ToValue(value)
                  : Missing(fmt::format("{} is at a bound or undetermined",
                                        fit.parameters[undefined(i) ? i : j].name)));
    }
    members.Set(fit.parameters[i].name, std::move(row));
  }
  return members;
}

}  // namespace

void AddParameterFields(FieldTable& table) {
  table.Add({
      {"model", "", "name of the model",
       [](const Report& report) { return report.fit.model->name; }},
      {"initial_state", "",
       "virgin or steady: the contact before the record; mixed where records differ",
       [](const Report& report) {
         return report.fit.has_mixed_states() ? "mixed" : Name(report.fit.initial_state);
       }},
      {"confidence", "-", "confidence of every interval",
       [](const Report& report) { return report.fit.confidence; }},
      {"parameters", "", "one member per parameter, by name", Parameters},
      {"correlation", "-", "correlation of the errors of free parameters, by their names",
       Correlations},
      {"regions", "",
       "joint confidence regions of sigma and alpha and of slip_force and alpha, of the noise "
       "alone; absent without --regions or --report",
       IfAny(&Report::fit, &identification::FitResult::regions, &Regions),
       [](const Report& report) {
         return report.failed() ? WhyFailed(report)
                                : std::string(
                                      "the model is inadequate, or alpha is held, at a "
                                      "bound or not determined");
       }},
  });
  table.Describe("parameters.NAME.", ParameterFields());
  table.Describe("parameters.NAME.ci95_parts[].", IntervalFields());
  table.Describe("regions[].", RegionFields());
  table.items.push_back({.path = "correlation.NAME.NAME",
                         .unit = "-",
                         .label = "of the errors of two free parameters",
                         .type = SchemaOf<double>(),
                         .may_be_null = true});
}

}  // namespace mindahl::report
