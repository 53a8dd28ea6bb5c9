#include <array>

#include "cli/command.h"
#include "mindahl/models/excitation.h"
#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::cli {

using models::BranchLaw;
using models::Waveform;
using tradeoff::WorkPrecision;

namespace {

struct TradeoffOptions {
  LawRequest law;    // default: the contact of Peyret et al. (2017) §3
  std::string path;  // a file with a displacement, in place of the scenes
  std::string column;
  std::string csv;
  std::string plot;
  double tolerance = 0.01;
};

struct Scene {
  std::string_view name;
  double lambda;  // of the largest extreme
  models::ExcitationOptions excitation;
};

constexpr std::array kScenes = {
    Scene{"micro-slip, sine", 0.8, {.waveform = Waveform::kSine, .cycles = 5}},
    Scene{"macro-slip, sine", 1.2, {.waveform = Waveform::kSine, .cycles = 5}},
    Scene{"growing sine", 1.5, {.waveform = Waveform::kGrowingSine, .cycles = 10}},
};

/// Returns what was measured along an excitation, for text, CSV and JSON.
Json Measure(const std::string& name, const methods::Drive& drive, const BranchLaw& law,
             double tolerance) {
  const std::vector<WorkPrecision> points = tradeoff::MeasureWorkPrecision(law, drive);
  const Json rows = report::ListOf(points, [](const WorkPrecision& point) -> Json {
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
  });
  return {{"name", name},
          {"samples", drive.displacement.size()},
          {"cheapest", rows[tradeoff::CheapestWithin(tolerance, points)]},
          {"points", rows}};
}

Json MeasureAll(const TradeoffOptions& request, const BranchLaw& law) {
  if (!request.path.empty()) {
    const std::vector<double> motion = io::ImposedDisplacement(request.path, request.column);
    return Json::array({Measure(request.path, {.displacement = motion}, law, request.tolerance)});
  }
  return report::ListOf(kScenes, [&](const Scene& scene) {
    models::ExcitationOptions options = scene.excitation;
    options.amplitude = scene.lambda * SlipReach(law);
    const models::Excitation excitation = models::MakeExcitation(options);
    methods::Drive drive{.displacement = excitation.displacement};
    if (options.waveform == Waveform::kGrowingSine) drive.envelope = excitation.envelope;
    return Measure(fmt::format("{}, lambda = {:g}", scene.name, scene.lambda), drive, law,
                   request.tolerance);
  });
}

std::string ToText(const Json& excitations, const BranchLaw& law, double tolerance) {
  std::string text = fmt::format("sigma = {:g} N/m, alpha = {:g}, Tc = {:g} N\n",
                                 law.tangential_stiffness, law.shape_exponent, law.slip_force);
  for (const Json& excitation : excitations) {
    text += fmt::format(
        "\n{}: {} samples\ncheapest within {:g} % of the peak force and of the energy:\n{}\n{}",
        excitation["name"].get<std::string>(), excitation["samples"].get<std::size_t>(),
        100 * tolerance, report::TableText(Json::array({excitation["cheapest"]}), 3),
        report::TableText(excitation["points"], 3));
  }
  return text;
}

io::Plot ToPlot(const Json& excitations) {
  constexpr double kRounding = 1e-17;  // an error of 0 has no place on a logarithmic axis
  io::Plot plot{.title = "Work and precision: largest force error against cost"};
  for (const Json& excitation : excitations) {
    io::PlotPanel panel{.x_label = "cost [ns/sample]",
                        .y_label = "largest error of T over T*",
                        .log_x = true,
                        .log_y = true,
                        .title = excitation["name"]};
    const Json& points = excitation["points"];
    for (const Json& point : points) {
      const bool other_model = point["model"] != points.back()["model"];
      const std::string label = point[other_model ? "model" : "method"];
      if (panel.series.empty() || panel.series.back().label != label) {
        panel.series.push_back({.label = label, .style = io::PlotStyle::kLineAndPoints});
      }
      panel.series.back().x.push_back(point["cost_ns_per_sample"]);
      panel.series.back().y.push_back(std::max(point["max_force_error"].get<double>(), kRounding));
    }
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

void RunTradeoff(const TradeoffOptions& options, Console& console) {
  const BranchLaw law =
      IsAnythingGiven(options.law)
          ? ResolveLaw(options.law)
          : contact::MapMindlinToDahl({.contact_radius = 0.0027,
                                       .tangential_compliance = 4.42e-11,
                                       .slip_force = contact::GrossSlipForce(0.3, 100)});
  const Json excitations = MeasureAll(options, law);
  // The plot first: it alone may still fail.
  if (!options.plot.empty()) io::WritePlot(ToPlot(excitations), options.plot);
  if (!options.csv.empty()) {
    Json points = Json::array();
    for (const Json& excitation : excitations) {
      for (const Json& point : excitation["points"]) {
        points.push_back({{"excitation", excitation["name"]}});
        points.back().update(point);
      }
    }
    io::WriteFileAtomically(options.csv, report::TableCsv(points));
  }
  WriteAnswer(console,
              report::Document("mindahl.tradeoff/1", {{"law", report::LawJson(law)},
                                                      {"tolerance", options.tolerance},
                                                      {"excitations", excitations}}),
              ToText(excitations, law, options.tolerance));
}

}  // namespace

void AddTradeoffCommand(CLI::App& app, Console& console) {
  const auto [command, options] =
      AddCommand(app, console, "tradeoff",
                 "Compares error and cost of every model and method along an excitation,\n"
                 "and names the cheapest whose force and dissipated energy are within a\n"
                 "tolerance of the exact ones. By default the contact and three\n"
                 "excitations are those of Peyret et al. (2017).",
                 {"mindahl tradeoff --path path.csv --displacement \"[um]\" --sigma 4e7 "
                  "--slip-force 40 --tolerance 1%",
                  "mindahl tradeoff --csv points.csv"},
                 &RunTradeoff);
  AddLawParameters(OptionGroup(command, "Parameters"), options.law);
  const OptionGroup group(command, "Excitation");
  group.AddPath(options.path, options.column);
  group
      .AddQuantity("--tolerance", options.tolerance,
                   "largest error allowed, of the peak force and of the energy: 0.01 or\n1%", "E",
                   "-")
      ->capture_default_str();
  const OptionGroup output(command, "Output");
  output.Add("--csv", options.csv, "every point, as CSV", "PATH");
  output.Add("--plot", options.plot, "work-precision diagrams, svg or png", "PATH");
  output.AddJson(console);
}

}  // namespace mindahl::cli
