#include "mindahl/request/validation.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "mindahl/core/version.h"
#include "request/json.h"

namespace mindahl::request {
namespace {

Json RowsToJson(const std::vector<identification::ValidationRow>& rows) {
  Json json = Json::array();
  for (const identification::ValidationRow& row : rows) {
    const auto of_cases = [&row](double value) { return row.cases == 0 ? Json() : Json(value); };
    Json entry = {{"lambda", row.lambda},
                  {"noise", row.noise},
                  {"cases", row.cases},
                  {"failures", row.failures},
                  {"not_identifiable", row.undetermined},
                  {"tolerance", row.tolerance},
                  {"sigma_error",
                   {{"median", of_cases(row.median_sigma_error)},
                    {"worst", of_cases(row.worst_sigma_error)}}},
                  {"alpha_error",
                   {{"median", of_cases(row.median_alpha_error)},
                    {"worst", of_cases(row.worst_alpha_error)}}},
                  {"slip_force_error",
                   {{"median", of_cases(row.median_slip_force_error)},
                    {"worst", of_cases(row.worst_slip_force_error)}}}};
    if (row.noise > 0) {
      entry["worst_standard_errors"] = of_cases(row.worst_standardized);
      entry["coverage"] = of_cases(row.coverage);
    }
    json.push_back(std::move(entry));
  }
  return json;
}

Json CoverageToJson(const std::vector<identification::CoverageVerdict>& verdicts) {
  const auto fraction = [](const identification::IntervalCount& count) {
    return count.intervals == 0 ? Json() : Json(count.fraction());
  };
  Json json = Json::array();
  for (const identification::CoverageVerdict& verdict : verdicts) {
    json.push_back({{"law", verdict.by_dahl ? "dahl" : "masing"},
                    {"parameter", verdict.parameter},
                    {"intervals", verdict.all.intervals},
                    {"coverage", fraction(verdict.all)},
                    {"sliding_intervals", verdict.sliding.intervals},
                    {"sliding_coverage", fraction(verdict.sliding)},
                    {"p_value", verdict.chance},
                    {"passed", verdict.passed}});
  }
  return json;
}

std::string Table(const std::vector<identification::ValidationRow>& rows) {
  std::string text =
      "noise    lambda  cases  |sigma/(8a/G*)-1|      |alpha-1/3|           |Tc/(mu N)-1|         "
      "not    coverage  worst   failed\n"
      "of T*                   median   worst        median   worst        median   worst        "
      "ident.   of 95%   error\n";
  for (const identification::ValidationRow& row : rows) {
    const auto error = [&row](double value) {
      return row.cases == 0 ? std::string("-") : fmt::format("{:.1e}", value);
    };
    const std::string worst = row.noise > 0 && row.cases > 0
                                  ? fmt::format("{:5.1f} SE", row.worst_standardized)
                                  : error(std::max({row.worst_sigma_error, row.worst_alpha_error,
                                                    row.worst_slip_force_error}));
    text += fmt::format(
        "{:<8g} {:<6g} {:6}   {:>7}  {:>7}     {:>7}  {:>7}     {:>7}  {:>7}     {:5}   {:>7} "
        "{:>9} {:6}\n",
        row.noise, row.lambda, row.cases, error(row.median_sigma_error),
        error(row.worst_sigma_error), error(row.median_alpha_error), error(row.worst_alpha_error),
        error(row.median_slip_force_error), error(row.worst_slip_force_error), row.undetermined,
        row.noise > 0 && row.cases > 0 ? fmt::format("{:.1f} %", 100 * row.coverage) : "-", worst,
        row.failures);
  }
  return text;
}

std::string CoverageText(const std::vector<identification::CoverageVerdict>& verdicts) {
  std::string text;
  for (const identification::CoverageVerdict& verdict : verdicts) {
    if (verdict.all.intervals == 0) continue;
    text += fmt::format("{} {}{} {:.1f} % of {}", text.empty() ? "" : ",", verdict.parameter,
                        verdict.by_dahl ? " (Dahl)" : "", 100 * verdict.all.fraction(),
                        verdict.all.intervals);
  }
  return text;
}

}  // namespace

std::string ToJson(const Validation& validation) {
  const identification::ValidationOptions& options = validation.options;
  const identification::ValidationReport& report = validation.report;
  Json json = {
      {"schema", "mindahl.validate/1"}, {"version", Version()}, {"cases", options.cases},
      {"seed", options.seed},           {"fits", report.fits},  {"failures", report.failures},
      {"passed", report.passed()}};
  json["rows"] = RowsToJson(report.rows);
  json["dahl_rows"] = RowsToJson(report.dahl_rows);
  json["coverage"] = CoverageToJson(report.coverage);
  json["failed_cases"] = report.failed_cases;
  json["failed_coverages"] = report.failed_coverages;
  return Dump(json);
}

std::string ToText(const Validation& validation) {
  const identification::ValidationReport& report = validation.report;
  std::string text = fmt::format(
      "Mindlin loops of {} contacts (seed {}), fitted with free alpha: {} fits\n\n"
      "by Masing's law:\n{}\n"
      "from their first extreme on by Dahl's own law, and translated:\n{}\n",
      validation.options.cases, validation.options.seed, report.fits, Table(report.rows),
      Table(report.dahl_rows));
  text += fmt::format(
      "Tolerance: noise-free {:g} relative for lambda >= 0.5 and {:g} below; with noise the truth "
      "within\n{:g} standard errors (likelihood ratio). A parameter may be reported as not "
      "identifiable with noise only.\n",
      identification::NoiseFreeTolerance(0.5), identification::NoiseFreeTolerance(0.3),
      identification::kStandardErrorsTolerated);
  if (const std::string coverage = CoverageText(report.coverage); !coverage.empty()) {
    text += fmt::format(
        "Coverage of the 95 % intervals:{}.\nIt is judged by binomial tests against {:g} %, and, "
        "at lambda > 1, {:g} %; chance of a false alarm {:g}.\n",
        coverage, 100 * identification::kLowestCoverage, 100 * identification::kHighestCoverage,
        identification::kCoverageFalseAlarm);
  }
  if (report.failures > 0) {
    text += fmt::format("FAILED: {} of {} fits\n", report.failures, report.fits);
  }
  if (!report.failed_coverages.empty()) {
    text += fmt::format("FAILED: {} of the coverages\n", report.failed_coverages.size());
  }
  if (report.passed()) text += "passed: every case within its tolerance\n";
  return text;
}

}  // namespace mindahl::request
