#include <cstdint>
#include <limits>
#include <memory>
#include <string>

#include "cli/app.h"
#include "cli/options.h"
#include "cli/output.h"
#include "mindahl/identification/mapping_validation.h"
#include "mindahl/request/validation.h"

namespace mindahl::cli {
namespace {

struct ValidateOptions {
  identification::ValidationOptions validation;
  std::string json_path;
};

void RunValidate(const ValidateOptions& options, Console& console) {
  RequireOutputPaths({{"--json", options.json_path, /*dash_is_stdout=*/true}}, console);
  const request::Validation validation{
      .options = options.validation, .report = identification::ValidateMapping(options.validation)};
  const identification::ValidationReport& report = validation.report;
  WriteAnswer(options.json_path, console, validation);
  for (const std::string& failed : report.failed_cases) console.err << failed << '\n';
  for (const std::string& failed : report.failed_coverages) console.err << failed << '\n';
  console.exit_status = report.passed() ? kDone : kNotEstablished;
}

}  // namespace

void AddValidateCommand(CLI::App& app, Console& console) {
  constexpr std::uint64_t kMostCases = 1'000'000'000;
  const auto options = std::make_shared<ValidateOptions>();
  CLI::App& command = AddCommand(
      app, "validate",
      "Tests the mapping: fits Mindlin loops of many contacts at many\n"
      "amplitudes and noise levels, by Masing's law and by Dahl's own, and\n"
      "compares sigma with 8a/G*, alpha with 1/3 and Tc with mu N. Exit\n"
      "status 3 when a case misses its tolerance, or the 95 % intervals cover\n"
      "the truth too rarely or too often.",
      {"mindahl validate --cases 5", "mindahl validate --cases 20 --seed 7 --json validate.json"});
  const OptionGroup plain(command, kPlainGroup);
  plain.AddShown("--cases", options->validation.cases, "contacts to draw")
      ->check(WholeNumber(1, kMostCases));
  plain.AddShown("--seed", options->validation.seed, "seed of the random numbers")
      ->check(WholeNumber(0, std::numeric_limits<std::uint64_t>::max()));
  plain.Add("--json", options->json_path, "report as JSON; - for standard output", "PATH");
  command.callback([options, &console] { RunValidate(*options, console); });
}

}  // namespace mindahl::cli
