#include <fmt/format.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/fit_request.h"
#include "cli/options.h"
#include "cli/output.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/request/tradeoff.h"

namespace mindahl::cli {
namespace {

struct TradeoffOptions {
  request::TradeoffRequest study;
  std::string path;
  std::string path_unit;
  std::string csv;
  std::string regions_csv;
  std::string plot;
  std::string json;
};

void RunTradeoff(const TradeoffOptions& options, Console& console) {
  RequireOutputPaths({{"--csv", options.csv},
                      {"--regions-csv", options.regions_csv},
                      {"--plot", options.plot},
                      {"--json", options.json, /*dash_is_stdout=*/true}},
                     console, {options.path});
  request::TradeoffRequest asked = options.study;
  if (!options.path.empty()) {
    asked.path_name = options.path;
    asked.displacement = io::ReadDisplacementPath(
        options.path, options.path_unit.empty() ? "" : fmt::format("[{}]", options.path_unit));
  }
  const Messages messages{console.err, "tradeoff"};
  std::optional<Progress> progress;
  const request::Tradeoff study = request::MakeTradeoff(
      asked, [&](std::string_view warning) { messages.Warn(warning); },
      [&](std::string_view what) {
        if (!progress) progress.emplace(console.err, std::string(what));
        progress->Say(std::string(what));
      });
  progress.reset();

  // The plot first: it alone may still fail.
  if (!options.plot.empty()) io::WritePlot(ToPlot(study), options.plot);
  if (!options.csv.empty()) io::WriteFileAtomically(options.csv, PointsCsv(study));
  if (!options.regions_csv.empty()) {
    io::WriteFileAtomically(options.regions_csv, RegionsCsv(study));
  }
  WriteAnswer(options.json, console, study);
}

}  // namespace

void AddTradeoffCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<TradeoffOptions>();
  CLI::App& command = AddCommand(
      app, "tradeoff",
      "Compares error and cost of every method and model along five\n"
      "excitations, the cost by counted operations and as measured in this\n"
      "run, and lists the amplitudes at which each model is good enough. The\n"
      "default contact is that of Peyret et al. (2017).",
      {"mindahl tradeoff --excitation micro",
       "mindahl tradeoff --path path.csv --path-unit um --sigma 4e7 --slip-force 40 --csv "
       "points.csv"});
  AddLawOptions(command, options->study.law);
  const OptionGroup group(command, "Excitation");
  const Option scenes =
      group
          .Add("--excitation", options->study.excitations,
               "micro (sine, lambda 0.8), macro (sine, 1.2), growing, random, nested; "
               "default all")
          .OneOf(request::ExcitationNames());
  const Option path = group
                          .Add("--path", options->path,
                               "CSV file whose first column is the displacement [m]", "FILE")
                          .Excludes(scenes);
  group.Add("--path-unit", options->path_unit, "unit of that column, default the header's", "UNIT")
      .Needs(path);
  const OptionGroup output(command, "Output");
  output.Add("--csv", options->csv, "every point, as CSV", "PATH");
  output.Add("--regions-csv", options->regions_csv,
             "amplitudes at which each model is good enough, as CSV", "PATH");
  output.Add("--plot", options->plot, "work-precision diagrams, svg or png", "PATH");
  output.Add("--json", options->json, "results for scripts; - is standard output", "PATH");
  WhenCalled(command, [options, &console] { RunTradeoff(*options, console); });
}

}  // namespace mindahl::cli
