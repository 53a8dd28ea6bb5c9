#include <cstddef>
#include <filesystem>
#include <system_error>
#include <thread>

#include "cli/command.h"
#include "mindahl/request/batch.h"

namespace mindahl::cli {

using request::BatchEntry;

namespace {

struct BatchCommandOptions {
  FitRequest request;
  Strictness strict = Strictness::kNone;
  std::size_t threads = std::max(1U, std::thread::hardware_concurrency());
  std::string output;
  std::string report_directory;
};

void RunBatch(const BatchCommandOptions& options, Console& console) {
  const FitRequest& request = options.request;
  Validate(request.contact);  // before a directory is made
  MakeFitOptions(request);
  const std::filesystem::path directory = options.report_directory;
  if (!directory.empty()) {
    std::error_code error;
    std::filesystem::create_directory(directory, error);
    if (error) Refuse("--report: cannot make '{}': {}", directory.string(), error.message());
  }
  const auto fits =
      FitFiles(request, options.strict, options.threads, directory, console.command_line);
  for (const BatchEntry& fit : fits) {
    Say("batch: note", fit.notes, console);
    if (!fit.fault.empty()) {
      Say("batch: warning", {fmt::format("{}: {}", fit.file, fit.fault)}, console);
    }
  }
  const request::BatchAnswer answer = request::AnswerOf(fits, options.output, console.command_line);
  io::WriteFileAtomically(options.output, answer.table);
  if (!directory.empty()) io::WriteFileAtomically(directory / "index.html", answer.index);
  WriteAnswer(console, answer.json, answer.text);
  console.exit_status = std::ranges::all_of(fits, &BatchEntry::done) ? kDone : kNotEstablished;
}

}  // namespace

void AddBatchCommand(CLI::App& app, Console& console) {
  const auto [command, options] = AddCommand(
      app, console, "batch",
      "Fits each file on its own, with any option of fit for all of them:\n"
      "one row a file, and the scatter between files next to their stated\n"
      "errors. A file that fails does not stop the others: exit status 3\n"
      "when any did.",
      {"mindahl batch run1.csv run2.csv run3.csv --output table.csv --normal-load 50",
       "mindahl batch run1.csv run2.csv run3.csv --output mindlin.csv --model mindlin --strict"},
      &RunBatch);
  OptionGroup(command, kPlainGroup)
      .Add("files", options.request.files, "CSV records, each a test of its own", "FILE")
      ->required();
  AddFitOptions(command, options.request);
  const OptionGroup group(command, "Results");
  group.Add("--output", options.output, "table as CSV, one row a file, in SI units", "PATH")
      ->required();
  group.AddJson(console);
  group.Add(
      "--report", options.report_directory,
      "directory for a page of HTML per file and index.html with all of\nthem; created if absent",
      "DIR");
  group.AddThreads(options.threads, "the results");
  AddStrict(command, options.strict, "a file fails too");
  ShowFirst(command, {"--displacement", "--force", "--normal-load", "--select", "--model",
                      "--terms", "--output", "--report", "--json", "--help-all"});
}

}  // namespace mindahl::cli
