#include "cli/command.h"
#include "mindahl/identification/mapping_validation.h"

namespace mindahl::cli {

using identification::ValidationOptions;
using identification::ValidationRow;

namespace {

Json RowsOf(const std::vector<ValidationRow>& rows) {
  return report::ListOf(rows, [](const ValidationRow& row) {
    const auto if_drawn = [&](double value) { return row.cases == 0 ? Json() : Json(value); };
    Json entry = {{"lambda", row.lambda},
                  {"noise", row.noise},
                  {"cases", row.cases},
                  {"failures", row.failures},
                  {"not_identifiable", row.undetermined},
                  {"tolerance", row.tolerance},
                  {"sigma_error", if_drawn(row.errors[0])},
                  {"alpha_error", if_drawn(row.errors[1])},
                  {"slip_force_error", if_drawn(row.errors[2])}};
    if (row.noise > 0) {
      entry["worst_standard_errors"] = if_drawn(row.worst_standardized);
      entry["coverage"] =  // null without an interval
          NumberOrNull(static_cast<double>(row.covering) / static_cast<double>(row.intervals));
    }
    return entry;
  });
}

void RunValidate(const ValidationOptions& options, Console& console) {
  const identification::ValidationReport report = identification::ValidateMapping(options);
  const Json rows = RowsOf(report.rows);
  const std::size_t fits = options.cases * identification::kNoiseLevels.size();
  const std::size_t failures = report.failed_cases.size();
  const bool passed = failures == 0;
  WriteAnswer(
      console,
      report::Document("mindahl.validate/1", {{"cases", options.cases},
                                              {"seed", options.seed},
                                              {"fits", fits},
                                              {"failures", failures},
                                              {"passed", passed},
                                              {"rows", rows},
                                              {"failed_cases", report.failed_cases}}),
      fmt::format("Mindlin loops of {} contacts (seed {}), fitted with free alpha: {} fits;\n"
                  "largest errors of sigma/(8a/G*), alpha - 1/3 and Tc/(mu N)\n\n{}\n{}\n",
                  options.cases, options.seed, fits, report::TableText(rows),
                  passed ? "passed: every case within its tolerance"
                         : fmt::format("FAILED: {} of {} fits", failures, fits)));
  for (const std::string& failed : report.failed_cases) console.err << failed << '\n';
  console.exit_status = passed ? kDone : kNotEstablished;
}

}  // namespace

void AddValidateCommand(CLI::App& app, Console& console) {
  const auto [command, options] = AddCommand(
      app, console, "validate",
      "Tests the mapping: fits Mindlin loops of many contacts at many\n"
      "amplitudes and noise levels, and compares sigma with 8a/G*, alpha with\n"
      "1/3 and Tc with mu N. Exit status 3 when a case misses its tolerance.",
      {"mindahl validate --cases 5", "mindahl validate --cases 20 --seed 7 --json validate.json"},
      &RunValidate);
  const OptionGroup plain(command, kPlainGroup);
  plain.AddCount("--cases", options.cases, "contacts to draw");
  plain.AddCount("--seed", options.seed, "seed of the random numbers", 0);
  plain.AddJson(console);
}

}  // namespace mindahl::cli
