#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.h"
#include "cli/examples.h"
#include "cli/fit_records.h"
#include "cli/fit_request.h"
#include "cli/output_path.h"
#include "cli/provenance.h"
#include "cli/text_output.h"
#include "mindahl/core/error.h"
#include "mindahl/identification/backbone_estimate.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/report/backbone.h"
#include "mindahl/report/figure.h"
#include "mindahl/report/json.h"
#include "mindahl/report/page.h"
#include "mindahl/report/report.h"
#include "mindahl/report/residual_table.h"
#include "mindahl/report/text.h"
#include "mindahl/request/fit_records.h"

namespace mindahl::cli {
namespace {

struct FitCommandOptions {
  FitRequest request;
  Strictness strict = Strictness::kNone;
  std::string json_path;
  std::string residuals_path;
  std::string backbone_path;
  std::string plot_path;
  std::string report_path;
};

/// Estimates the backbone of the records without any law's shape.
identification::BackboneEstimate BackboneOf(const FitRequest& request,
                                            const report::Report& report) {
  if (!identification::HasBackbone(report.fit)) {
    throw InputError(
        "--backbone is of a contact of Masing's memory under one load, by its forces: leave out "
        "--model dahl, --lag, --asymmetry and --noise-in displacement, and fit records of other "
        "loads apart");
  }
  std::vector<loop::RecordView> records;
  records.reserve(report.records.size());
  for (const io::RecordFile& input : report.records) records.emplace_back(input.record);
  identification::FitOptions options = MakeFitOptions(request);
  request::LeaveOutTrimmed(report.trims, options);
  return identification::EstimateBackbone(records, options, report.fit);
}

/// @param provenance  asked for where a page is written: it reads the files once more
/// Findings that stand where the model does not: those of the record. What else there is to say of
/// an inadequate fit is in its text.
bool IsOfTheRecord(std::string_view code) {
  constexpr std::array<std::string_view, 7> kOfTheRecord = {
      "reversals_uncertain", "glitches_left_out", "path_too_long",      "no_closed_cycle",
      "few_places",          "loop_not_seen",     "weights_not_settled"};
  return std::ranges::find(kOfTheRecord, code) != kOfTheRecord.end();
}

void WriteFitOutputs(const FitCommandOptions& options, const report::Report& report,
                     const std::function<report::Provenance()>& provenance,
                     const Messages& messages, Console& console) {
  const bool is_inadequate =
      report.fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate;
  for (const report::Warning& warning : report.fit_warnings) {
    if (warning.code == "fit_failed") continue;  // an error, below
    if (is_inadequate && !IsOfTheRecord(warning.code)) continue;
    messages.Warn(warning.message);
  }
  for (const report::Warning& warning : report.contact_warnings) {
    if (warning.code != "contact_implausible") continue;  // the others are in the text
    messages.Warn(warning.message);
  }
  if (report.failed()) {  // no curve to draw, no residual to list
    console.err << fmt::format("mindahl fit: the fit failed: {}\n", report.fit.solver.message);
    if (!options.report_path.empty()) {
      io::WriteFileAtomically(options.report_path, report::ToPage(report, provenance()));
    }
    if (!options.json_path.empty()) WriteText(report::ToJson(report), options.json_path, console);
    return;
  }
  // The plot first: it alone may still fail.
  if (!options.plot_path.empty()) io::WritePlot(report::ToPlot(report), options.plot_path);
  if (!options.report_path.empty()) {
    io::WriteFileAtomically(options.report_path, report::ToPage(report, provenance()));
  }
  if (!options.residuals_path.empty()) {
    io::WriteFileAtomically(options.residuals_path, report::ResidualsCsv(report));
  }
  if (!options.json_path.empty()) WriteText(report::ToJson(report), options.json_path, console);
  if (report.backbone) {
    io::WriteFileAtomically(options.backbone_path,
                            report::BackboneCsv(*report.backbone, report.units));
  }
  if (options.json_path != "-") {
    console.out << report::ToText(report, {.has_colours = console.has_colours});
  }
  if (options.json_path != "-" && report.backbone) {
    console.out << report::BackboneText(*report.backbone, report.fit, report.units);
  }
}

void RunFit(const FitCommandOptions& options, const CLI::App& command, Console& console) {
  const FitRequest& request = options.request;
  Validate(request.contact);
  RequireDistinctFiles(request.files);
  std::vector<std::string> read = console.inputs;
  read.insert(read.end(), request.files.begin(), request.files.end());
  RequireOutputPaths({{"--json", options.json_path, /*dash_is_stdout=*/true},
                      {"--residuals", options.residuals_path},
                      {"--backbone", options.backbone_path},
                      {"--plot", options.plot_path},
                      {"--report", options.report_path}},
                     read);
  const Messages messages{console.err, "fit"};
  report::Report report = FitRecords(request, messages);
  if (!options.backbone_path.empty() && !report.failed()) {
    report.backbone = BackboneOf(request, report);
    for (identification::Cause& cause : report.fit.adequacy.causes) {
      // Refused together with a backbone.
      const std::string_view option = cause.option;
      if (option.starts_with("--lag") || option.starts_with("--asymmetry")) cause.option.clear();
    }
  }
  console.exit_status = Established(report.fit, options.strict) ? kDone : kNotEstablished;
  const auto provenance = [&] { return ProvenanceOf(command, console, request.files); };
  WriteFitOutputs(options, report, provenance, messages, console);
}

}  // namespace

void AddFitCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<FitCommandOptions>();
  CLI::App* command = app.add_subcommand("fit",
                                         "Fits sigma, alpha and Tc to one or more records of a "
                                         "contact (several files: one joint fit)\n"
                                         "and translates them into the contact. Exit status 3 when "
                                         "the fit does not converge or, with\n"
                                         "--strict, the model is not adequate or a parameter not "
                                         "identifiable.");
  AddExamples(*command, app,
              {"mindahl fit loop.csv --normal-load 50",
               "mindahl fit loop.csv --displacement 2 --force 3 --json fit.json --plot fit.svg",
               "mindahl fit 20N.csv 50N.csv 120N.csv --normal-load 20,50,120"});
  command->add_option("files", options->request.files, "CSV records of one contact")
      ->type_name("FILE")
      ->required();
  AddFitOptions(*command, options->request, NormalLoads::kOneAFile);
  const std::string group = "Results";
  command->add_option("--json", options->json_path, "result as JSON; - for standard output alone")
      ->type_name("PATH")
      ->group(group);
  command
      ->add_option("--residuals", options->residuals_path,
                   "measured and fitted force of every sample as CSV")
      ->type_name("PATH")
      ->group(group);
  command
      ->add_option("--backbone", options->backbone_path,
                   "the force over the displacement of first loading, of no law's\n"
                   "shape, with its 95 % band and the law beside it, as CSV")
      ->type_name("PATH")
      ->group(group);
  command->add_option("--plot", options->plot_path, "loop and residuals as svg or png")
      ->type_name("PATH")
      ->group(group);
  command
      ->add_option("--report", options->report_path,
                   "everything as one page of HTML with its figures, to read,\n"
                   "send and print; it loads nothing")
      ->type_name("PATH")
      ->group(group);
  AddStrict(*command, options->strict, "exit status 3", group);
  command->callback([options, command, &console] { RunFit(*options, *command, console); });
}

}  // namespace mindahl::cli
