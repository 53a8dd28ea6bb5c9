#include "cli/command.h"

namespace mindahl::cli {
namespace {

struct FitCommandOptions {
  FitRequest request;
  Strictness strict = Strictness::kNone;
  std::string residuals_path;
  std::string plot_path;
  std::string report_path;
  bool has_details = false;
};

void RunFit(const FitCommandOptions& options, Console& console) {
  const FitRequest& request = options.request;
  const report::Report report = request::FitRecords(request, request::ReadRecords(request));
  const bool failed = report.failed();  // then there is no curve to draw, no residual to list
  const std::string fault = WhyNotEstablished(report.fit, options.strict);
  if (!fault.empty()) {
    console.exit_status = kNotEstablished;
    Say("fit", {(failed ? "the fit failed: " : "") + fault}, console);
  }
  // The plot first: it alone may still fail.
  if (!failed && !options.plot_path.empty()) io::WritePlot(ToPlot(report), options.plot_path);
  if (!options.report_path.empty()) {
    io::WriteFileAtomically(options.report_path, ToPage(report, console.command_line));
  }
  if (!failed && !options.residuals_path.empty()) {
    io::WriteFileAtomically(options.residuals_path, report::ResidualsCsv(report));
  }
  if (!failed && console.json_path == "-") Say("fit: note", report.notes, console);
  const auto detail = options.has_details ? report::Detail::kAll : report::Detail::kAnswer;
  WriteAnswer(console, console.json_path.empty() ? "" : report::ToJson(report),
              failed ? "" : report::ToText(report, detail));
}

}  // namespace

void AddFitCommand(CLI::App& app, Console& console) {
  const auto [command, options] =
      AddCommand(app, console, "fit",
                 "Fits sigma, alpha and Tc to one or more records of a contact (several\n"
                 "files: one joint fit) and translates them into the contact. Exit\n"
                 "status 3 when the fit does not converge or, with --strict, the model\n"
                 "is not adequate or a parameter not identifiable.",
                 {"mindahl fit loop.csv --normal-load 50",
                  "mindahl fit loop.csv --displacement 2 --force 3 --json fit.json --plot fit.svg",
                  "mindahl fit 20N.csv 50N.csv 120N.csv --normal-load 20,50,120"},
                 &RunFit);
  OptionGroup(command, kPlainGroup)
      .Add("files", options.request.files, "CSV records of one contact", "FILE")
      ->required();
  AddFitOptions(command, options.request);
  const OptionGroup group(command, "Results");
  group.AddFlag("--details", options.has_details, "print what the answer leaves out");
  group.AddJson(console);
  group.Add("--residuals", options.residuals_path,
            "measured and fitted force of every sample as CSV", "PATH");
  group.Add("--plot", options.plot_path, "loop and residuals as svg or png", "PATH");
  group.Add("--report", options.report_path,
            "everything with its figures on one self-contained page of HTML", "PATH");
  AddStrict(command, options.strict, "exit status 3");
  ShowFirst(command, {"--displacement", "--force", "--normal-load", "--select", "--model",
                      "--terms", "--rig-stiffness", "--fix", "--report", "--json", "--help-all"});
}

}  // namespace mindahl::cli
