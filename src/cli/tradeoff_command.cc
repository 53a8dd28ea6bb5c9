#include <memory>
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
  std::string displacement;
  std::string csv;
  std::string plot;
  std::string json;
  std::string tolerance = "1%";
};

void RunTradeoff(const TradeoffOptions& options, Console& console) {
  RequireOutputPaths({{"--csv", options.csv},
                      {"--plot", options.plot},
                      {"--json", options.json, /*dash_is_stdout=*/true}},
                     console, {options.path});
  request::TradeoffRequest asked = options.study;
  if (!options.path.empty()) {
    asked.path_name = options.path;
    asked.displacement = io::ImposedColumn(io::ReadCsvTable(options.path),
                                           io::Imposed::kDisplacement, options.displacement);
  }
  asked.tolerance = ParseTolerance(options.tolerance);
  const Messages messages{console.err, "tradeoff"};
  const request::Tradeoff study =
      request::MakeTradeoff(asked, [&](std::string_view warning) { messages.Warn(warning); });

  // The plot first: it alone may still fail.
  if (!options.plot.empty()) io::WritePlot(ToPlot(study), options.plot);
  if (!options.csv.empty()) io::WriteFileAtomically(options.csv, PointsCsv(study));
  WriteAnswer(options.json, console, study);
}

}  // namespace

void AddTradeoffCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<TradeoffOptions>();
  CLI::App& command =
      AddCommand(app, "tradeoff",
                 "Compares error and cost of every model and method along an excitation,\n"
                 "and names the cheapest whose force is within a tolerance of the exact\n"
                 "one, and whose dissipated energy is too. The default contact is\n"
                 "that of Peyret et al. (2017).",
                 {"mindahl tradeoff --path path.csv --displacement \"[um]\" --sigma 4e7 "
                  "--slip-force 40 --tolerance 1%",
                  "mindahl tradeoff --excitation micro --csv points.csv"});
  AddLawOptions(command, options->study.law);
  const OptionGroup group(command, "Excitation");
  CLI::Option* const scenes =
      group
          .Add("--excitation", options->study.excitations,
               "micro (sine, lambda 0.8), macro (sine, 1.2), growing, random, nested; "
               "default all")
          ->check(OneOf(request::ExcitationNames()));
  CLI::Option* const path =
      group.Add("--path", options->path, "CSV file with a displacement, any sequence", "FILE")
          ->excludes(scenes);
  group
      .Add("--displacement", options->displacement,
           "its column, by header name or number, with its unit, \"[um]\", if the\nheader has "
           "none; default by its name, else the first",
           "COL")
      ->needs(path);
  OptionGroup(command, kPlainGroup)
      .AddShown("--tolerance", options->tolerance,
                "largest error allowed, of the peak force and of the energy: 0.01 or\n1%", "E");
  const OptionGroup output(command, "Output");
  output.Add("--csv", options->csv, "every point, as CSV", "PATH");
  output.Add("--plot", options->plot, "work-precision diagrams, svg or png", "PATH");
  output.Add("--json", options->json, "results for scripts; - is standard output", "PATH");
  command.callback([options, &console] { RunTradeoff(*options, console); });
}

}  // namespace mindahl::cli
