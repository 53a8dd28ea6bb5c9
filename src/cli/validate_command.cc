#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "cli/app.h"
#include "cli/options.h"
#include "cli/output.h"
#include "mindahl/identification/mapping_validation.h"
#include "report/table.h"

namespace mindahl::cli {

using identification::ValidationReport;
using identification::ValidationRow;
using report::Json;

namespace {

struct Validation {
  identification::ValidationOptions options;
  std::string json_path;
};

Json ErrorsJson(const ValidationRow& row, std::size_t parameter) {
  if (row.cases == 0) return {{"median", nullptr}, {"worst", nullptr}};
  return {{"median", row.errors[parameter].median}, {"worst", row.errors[parameter].worst}};
}

Json ValidationRows(const std::vector<ValidationRow>& rows) {
  Json json = Json::array();
  for (const ValidationRow& row : rows) {
    Json entry = {{"lambda", row.lambda},
                  {"noise", row.noise},
                  {"cases", row.cases},
                  {"failures", row.failures},
                  {"not_identifiable", row.undetermined},
                  {"tolerance", row.tolerance},
                  {"sigma_error", ErrorsJson(row, 0)},
                  {"alpha_error", ErrorsJson(row, 1)},
                  {"slip_force_error", ErrorsJson(row, 2)}};
    if (row.noise > 0) {
      entry["worst_standard_errors"] = row.cases == 0 ? Json() : Json(row.worst_standardized);
      entry["coverage"] = row.cases == 0 ? Json() : Json(row.coverage);
    }
    json.push_back(std::move(entry));
  }
  return json;
}

Json CoverageRows(const ValidationReport& report) {
  const auto fraction = [](const identification::IntervalCount& count) {
    return count.intervals == 0 ? Json() : Json(count.fraction());
  };
  return report::ListOf(report.coverage,
                        [&](const identification::CoverageVerdict& verdict) -> Json {
                          return {{"law", verdict.by_dahl ? "dahl" : "masing"},
                                  {"parameter", verdict.parameter},
                                  {"intervals", verdict.all.intervals},
                                  {"coverage", fraction(verdict.all)},
                                  {"sliding_intervals", verdict.sliding.intervals},
                                  {"sliding_coverage", fraction(verdict.sliding)},
                                  {"p_value", verdict.chance},
                                  {"passed", verdict.passed}};
                        });
}

void RunValidate(const Validation& validation, Console& console) {
  const ValidationReport report = identification::ValidateMapping(validation.options);
  const Json rows = ValidationRows(report.rows);
  const Json dahl_rows = ValidationRows(report.dahl_rows);
  const Json coverage = CoverageRows(report);
  std::string text = fmt::format(
      "Mindlin loops of {} contacts (seed {}), fitted with free alpha: {} fits; errors of\n"
      "sigma/(8a/G*), alpha - 1/3 and Tc/(mu N)\n\nby Masing's law:\n{}\n"
      "from their first extreme on by Dahl's own law, and translated:\n{}\n"
      "coverage of the 95 % intervals:\n{}\n",
      validation.options.cases, validation.options.seed, report.fits, report::TableText(rows),
      report::TableText(dahl_rows), report::TableText(coverage));
  if (report.failures > 0) {
    text += fmt::format("FAILED: {} of {} fits\n", report.failures, report.fits);
  }
  if (!report.failed_coverages.empty()) {
    text += fmt::format("FAILED: {} of the coverages\n", report.failed_coverages.size());
  }
  if (report.passed()) text += "passed: every case within its tolerance\n";
  WriteAnswer(
      validation.json_path, console,
      report::Document("mindahl.validate/1", {{"cases", validation.options.cases},
                                              {"seed", validation.options.seed},
                                              {"fits", report.fits},
                                              {"failures", report.failures},
                                              {"passed", report.passed()},
                                              {"rows", rows},
                                              {"dahl_rows", dahl_rows},
                                              {"coverage", coverage},
                                              {"failed_cases", report.failed_cases},
                                              {"failed_coverages", report.failed_coverages}}),
      text);
  for (const std::string& failed : report.failed_cases) console.err << failed << '\n';
  for (const std::string& failed : report.failed_coverages) console.err << failed << '\n';
  console.exit_status = report.passed() ? kDone : kNotEstablished;
}

}  // namespace

void AddValidateCommand(CLI::App& app, Console& console) {
  constexpr std::uint64_t kMostCases = 1'000'000'000;
  const auto options = std::make_shared<Validation>();
  CLI::App& command = AddCommand(
      app, "validate",
      "Tests the mapping: fits Mindlin loops of many contacts at many\n"
      "amplitudes and noise levels, by Masing's law and by Dahl's own, and\n"
      "compares sigma with 8a/G*, alpha with 1/3 and Tc with mu N. Exit\n"
      "status 3 when a case misses its tolerance, or the 95 % intervals cover\n"
      "the truth too rarely or too often.",
      {"mindahl validate --cases 5", "mindahl validate --cases 20 --seed 7 --json validate.json"});
  const OptionGroup plain(command, kPlainGroup);
  plain.AddShown("--cases", options->options.cases, "contacts to draw")
      ->check(WholeNumber(1, kMostCases));
  plain.AddShown("--seed", options->options.seed, "seed of the random numbers")
      ->check(WholeNumber(0, std::numeric_limits<std::uint64_t>::max()));
  plain.Add("--json", options->json_path, "report as JSON; - for standard output", "PATH");
  OnRun(command, [options, &console] { RunValidate(*options, console); });
}

}  // namespace mindahl::cli
