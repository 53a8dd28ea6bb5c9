#include <array>

#include "cli/command.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/models/excitation.h"
#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::cli {

using methods::Method;
using models::BranchLaw;
using models::Waveform;
using tradeoff::WorkPrecision;

namespace {

/// An excitation along which all was measured, with what is said of it.
struct MeasuredExcitation {
  std::string title;
  Json document;
  std::string text;
};

struct TradeoffOptions {
  LawOptions law;                        // default: the contact of Peyret et al. (2017) §3
  std::vector<std::string> excitations;  // empty: all
  std::string path;
  std::string column;
  std::string csv;
  std::string plot;
  std::string json;
  double tolerance = 0.01;
};

struct Scene {
  std::string_view name;
  std::string_view title;
  Waveform waveform;
  double lambda;  // of the largest extreme
  double cycles;
};

constexpr std::array kScenes = {
    Scene{"micro", "micro-slip, sine", Waveform::kSine, 0.8, 5},
    Scene{"macro", "macro-slip, sine", Waveform::kSine, 1.2, 5},
    Scene{"growing", "growing sine", Waveform::kGrowingSine, 1.5, 10},
};

/// The contact of Peyret et al. (2017) §3.
BranchLaw PaperContact() {
  return contact::MapMindlinToDahl({.contact_radius = 0.0027,
                                    .tangential_compliance = 4.42e-11,
                                    .slip_force = contact::GrossSlipForce(0.3, 100)});
}

/// States a choice: "spring, 1.5 ns/sample".
std::string ChoiceText(const WorkPrecision& chosen) {
  return fmt::format("{}, {:.1f} ns/sample", Describe(chosen.approximation), chosen.cost);
}

/// Returns the points as rows of text, CSV and JSON.
Json PointRows(const std::vector<WorkPrecision>& points) {
  return report::ListOf(points, [](const WorkPrecision& point) -> Json {
    const tradeoff::Approximation& approximation = point.approximation;
    const Method* method = methods::FindMethod(approximation.method);
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
}

MeasuredExcitation Measure(std::string_view name, const std::string& title,
                           const methods::Drive& drive, const BranchLaw& law, double tolerance) {
  const std::vector<WorkPrecision> points = tradeoff::MeasureWorkPrecision(law, drive);
  const std::size_t cheapest = tradeoff::CheapestWithin(tolerance, /*energy_counts=*/false, points);
  const std::size_t with_energy =
      tradeoff::CheapestWithin(tolerance, /*energy_counts=*/true, points);
  const Json rows = PointRows(points);
  const std::size_t samples = drive.displacement.size();
  std::string text = fmt::format("\n{}: {} samples\ncheapest within {:g} % of the peak force: {}\n",
                                 title, samples, 100 * tolerance, ChoiceText(points[cheapest]));
  if (with_energy != cheapest) {
    text += fmt::format("and of the dissipated energy: {}\n", ChoiceText(points[with_energy]));
  }
  return {.title = title,
          .document = {{"name", name},
                       {"samples", samples},
                       {"cheapest", rows[cheapest]},
                       {"cheapest_with_energy", rows[with_energy]},
                       {"points", rows}},
          .text = text + report::TableText(rows, 3)};
}

std::vector<MeasuredExcitation> MeasureScenes(const TradeoffOptions& request,
                                              const BranchLaw& law) {
  std::vector<MeasuredExcitation> measured;
  if (!request.path.empty()) {
    const std::vector<double> displacement = io::ImposedDisplacement(request.path, request.column);
    measured.push_back(
        Measure("path", request.path, {.displacement = displacement}, law, request.tolerance));
    return measured;
  }
  for (const Scene& scene : kScenes) {
    const bool chosen =
        request.excitations.empty() ||
        std::ranges::find(request.excitations, scene.name) != request.excitations.end();
    if (!chosen) continue;
    const models::Excitation excitation =
        models::MakeExcitation({.waveform = scene.waveform,
                                .amplitude = scene.lambda * SlipReach(law),
                                .cycles = scene.cycles});
    methods::Drive drive{.displacement = excitation.displacement};
    if (scene.waveform == Waveform::kGrowingSine) drive.envelope = excitation.envelope;
    measured.push_back(Measure(scene.name,
                               fmt::format("{}, lambda = {:g}", scene.title, scene.lambda), drive,
                               law, request.tolerance));
  }
  return measured;
}

/// Returns every point as CSV.
std::string PointsCsv(const std::vector<MeasuredExcitation>& scenes) {
  Json rows = Json::array();
  for (const MeasuredExcitation& scene : scenes) {
    for (const Json& point : scene.document["points"]) {
      rows.push_back({{"excitation", scene.document["name"]}});
      rows.back().update(point);
    }
  }
  return report::TableCsv(rows);
}

io::Plot ToPlot(const std::vector<MeasuredExcitation>& scenes) {
  constexpr double kRounding = 1e-17;  // an error of 0 has no place on a logarithmic axis
  io::Plot plot{.title = "Work and precision: largest force error against cost"};
  for (const MeasuredExcitation& scene : scenes) {
    io::PlotPanel panel{.x_label = "cost [ns/sample]",
                        .y_label = "largest error of T over T*",
                        .log_x = true,
                        .log_y = true,
                        .title = scene.title};
    std::vector<std::string> labels;
    const Json& points = scene.document["points"];
    for (const Json& point : points) {
      const bool other_model = point["model"] != points.back()["model"];
      const std::string label = point[other_model ? "model" : "method"];
      auto place = static_cast<std::size_t>(std::ranges::find(labels, label) - labels.begin());
      if (place == labels.size()) {
        labels.push_back(label);
        panel.series.push_back({.label = label, .style = io::PlotStyle::kLineAndPoints});
      }
      panel.series[place].x.push_back(point["cost_ns_per_sample"]);
      panel.series[place].y.push_back(std::max(point["max_force_error"].get<double>(), kRounding));
    }
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

void RunTradeoff(const TradeoffOptions& options, Console& console) {
  if (!(options.tolerance > 0 && options.tolerance <= 1)) {
    ThrowInvalid("--tolerance [-]", options.tolerance, "must be in (0, 1]");
  }
  const bool is_contact_given = IsAnythingGiven(options.law) || options.law.alpha;
  const BranchLaw law = is_contact_given ? ResolveLaw(options.law) : PaperContact();
  const std::vector<MeasuredExcitation> measured = MeasureScenes(options, law);
  // The plot first: it alone may still fail.
  if (!options.plot.empty()) io::WritePlot(ToPlot(measured), options.plot);
  if (!options.csv.empty()) io::WriteFileAtomically(options.csv, PointsCsv(measured));
  std::string text = fmt::format("sigma = {:g} N/m, alpha = {:g}, Tc = {:g} N\n",
                                 law.tangential_stiffness, law.shape_exponent, law.slip_force);
  Json scenes = Json::array();
  for (const MeasuredExcitation& scene : measured) {
    text += scene.text;
    scenes.push_back(scene.document);
  }
  WriteAnswer(options.json, console,
              report::Document("mindahl.tradeoff/1", {{"law", report::LawJson(law)},
                                                      {"tolerance", options.tolerance},
                                                      {"excitations", std::move(scenes)}}),
              text);
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
  AddLawParameters(OptionGroup(command, "Parameters"), options->law);
  const OptionGroup group(command, "Excitation");
  CLI::Option* const scenes =
      group
          .Add("--excitation", options->excitations,
               "micro (sine, lambda 0.8), macro (sine, 1.2), growing; default all")
          ->check(OneOf(NamesOf(kScenes, &Scene::name)));
  AddPath(group, options->path, options->column, "")->excludes(scenes);
  AddTolerance(OptionGroup(command, kPlainGroup), options->tolerance,
               "largest error allowed, of the peak force and of the energy: 0.01 or\n1%");
  const OptionGroup output(command, "Output");
  output.Add("--csv", options->csv, "every point, as CSV", "PATH");
  output.Add("--plot", options->plot, "work-precision diagrams, svg or png", "PATH");
  output.Add("--json", options->json, "results for scripts; - is standard output", "PATH");
  OnRun(command, [options, &console] { RunTradeoff(*options, console); });
}

}  // namespace mindahl::cli
