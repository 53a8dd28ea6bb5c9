#include "cli/command.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::cli {

using tradeoff::WorkPrecision;

namespace {

struct TradeoffOptions {
  LawOptions law;  // default: the contact of Peyret et al. (2017) §3
  std::string path;
  std::string column;
  std::string csv;
  std::string plot;
  std::string json;
  double tolerance = 0.01;
};

/// The contact of Peyret et al. (2017) §3.
models::BranchLaw PaperContact() {
  return contact::MapMindlinToDahl({.contact_radius = 0.0027,
                                    .tangential_compliance = 4.42e-11,
                                    .slip_force = contact::GrossSlipForce(0.3, 100)});
}

Json RowOf(const WorkPrecision& point) {
  const tradeoff::Approximation& approximation = point.approximation;
  const methods::Method* method = methods::FindMethod(approximation.method);
  const bool has_steps = method != nullptr && !method->steps.empty();
  const bool is_adaptive = method != nullptr && method->adaptive;
  return {{"model", approximation.model},
          {"method", method == nullptr ? Json() : Json(approximation.method)},
          {"steps", has_steps ? Json(approximation.resolution.steps) : Json()},
          {"tolerance", is_adaptive ? Json(approximation.resolution.tolerance) : Json()},
          {"cost_ns_per_sample", point.cost},
          {"max_force_error", point.precision.max_force},
          {"energy_error", NumberOrNull(point.precision.energy)}};
}

io::Plot ToPlot(const Json& points) {
  constexpr double kRounding = 1e-17;  // an error of 0 has no place on a logarithmic axis
  io::PlotPanel panel{.x_label = "cost [ns/sample]",
                      .y_label = "largest error of T over T*",
                      .log_x = true,
                      .log_y = true};
  for (const Json& point : points) {
    const bool other_model = point["model"] != points.back()["model"];
    const std::string label = point[other_model ? "model" : "method"];
    if (panel.series.empty() || panel.series.back().label != label) {
      panel.series.push_back({.label = label, .style = io::PlotStyle::kLineAndPoints});
    }
    panel.series.back().x.push_back(point["cost_ns_per_sample"]);
    panel.series.back().y.push_back(std::max(point["max_force_error"].get<double>(), kRounding));
  }
  return {.title = "Work and precision: largest force error against cost",
          .panels = {std::move(panel)}};
}

void RunTradeoff(const TradeoffOptions& options, Console& console) {
  const bool is_contact_given = IsAnythingGiven(options.law) || options.law.alpha;
  const models::BranchLaw law = is_contact_given ? ResolveLaw(options.law) : PaperContact();
  const std::vector<double> displacement = io::ImposedDisplacement(options.path, options.column);
  const std::vector<WorkPrecision> measured =
      tradeoff::MeasureWorkPrecision(law, {.displacement = displacement});
  const Json cheapest = RowOf(measured[tradeoff::CheapestWithin(options.tolerance, measured)]);
  const Json points = report::ListOf(measured, RowOf);
  // The plot first: it alone may still fail.
  if (!options.plot.empty()) io::WritePlot(ToPlot(points), options.plot);
  if (!options.csv.empty()) io::WriteFileAtomically(options.csv, report::TableCsv(points));
  constexpr int kDigits = 3;
  WriteAnswer(
      options.json, console,
      report::Document("mindahl.tradeoff/1", {{"law", report::LawJson(law)},
                                              {"tolerance", options.tolerance},
                                              {"samples", displacement.size()},
                                              {"cheapest", cheapest},
                                              {"points", points}}),
      fmt::format("sigma = {:g} N/m, alpha = {:g}, Tc = {:g} N; {} samples\n"
                  "cheapest within {:g} % of the peak force and of the energy:\n{}\n{}",
                  law.tangential_stiffness, law.shape_exponent, law.slip_force, displacement.size(),
                  100 * options.tolerance, report::TableText(Json::array({cheapest}), kDigits),
                  report::TableText(points, kDigits)));
}

}  // namespace

void AddTradeoffCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<TradeoffOptions>();
  CLI::App& command =
      AddCommand(app, "tradeoff",
                 "Compares error and cost of every model and method along an excitation,\n"
                 "and names the cheapest whose force and dissipated energy are within a\n"
                 "tolerance of the exact ones. By default the contact is that of Peyret\n"
                 "et al. (2017).",
                 {"mindahl tradeoff --path path.csv --displacement \"[um]\" --sigma 4e7 "
                  "--slip-force 40 --tolerance 1%",
                  "mindahl tradeoff --path path.csv --displacement \"[um]\" --csv points.csv"});
  AddLawParameters(OptionGroup(command, "Parameters"), options->law);
  const OptionGroup group(command, "Excitation");
  AddPath(group, options->path, options->column)->required();
  group
      .AddQuantity("--tolerance", options->tolerance,
                   "largest error allowed, of the peak force and of the energy: 0.01 or\n1%", "E",
                   "-")
      ->capture_default_str();
  const OptionGroup output(command, "Output");
  output.Add("--csv", options->csv, "every point, as CSV", "PATH");
  output.Add("--plot", options->plot, "work-precision diagram, svg or png", "PATH");
  output.AddJson(options->json);
  OnRun(command, [options, &console] { RunTradeoff(*options, console); });
}

}  // namespace mindahl::cli
