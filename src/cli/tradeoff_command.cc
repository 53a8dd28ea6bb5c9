#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/models/excitation.h"
#include "mindahl/tradeoff/work_precision.h"
#include "report/table.h"

namespace mindahl::cli {

using methods::Method;
using models::BranchLaw;
using models::Waveform;
using report::Json;
using tradeoff::WorkPrecision;

namespace {

/// An excitation as it was measured.
struct MeasuredExcitation {
  std::string name;
  std::string title;
  std::size_t samples = 0;
  std::vector<WorkPrecision> points;
  std::size_t cheapest = 0;              // point whose force is within the tolerance
  std::size_t cheapest_with_energy = 0;  // and the dissipated energy too
};

struct Tradeoff {
  BranchLaw law;
  double tolerance = 0.01;
  std::vector<MeasuredExcitation> excitations = {};
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
    Scene{"random", "random extremes", Waveform::kRandom, 1.2, 20},
    Scene{"nested", "nested loops", Waveform::kNested, 0.95, 20},
};

/// The contact of Peyret et al. (2017) §3.
BranchLaw PaperContact() {
  return contact::MapMindlinToDahl({.contact_radius = 0.0027,
                                    .tangential_compliance = 4.42e-11,
                                    .slip_force = contact::GrossSlipForce(0.3, 100)});
}

std::vector<MeasuredExcitation> MeasureScenes(const TradeoffOptions& request,
                                              const BranchLaw& law) {
  std::vector<MeasuredExcitation> measured;
  const auto measure = [&](std::string_view name, std::string title, const methods::Drive& drive) {
    measured.push_back({.name = std::string(name),
                        .title = std::move(title),
                        .samples = drive.displacement.size(),
                        .points = tradeoff::MeasureWorkPrecision(law, drive)});
    MeasuredExcitation& made = measured.back();
    made.cheapest =
        tradeoff::CheapestWithin(request.tolerance, /*energy_counts=*/false, made.points);
    made.cheapest_with_energy =
        tradeoff::CheapestWithin(request.tolerance, /*energy_counts=*/true, made.points);
  };
  if (!request.path.empty()) {
    const std::vector<double> displacement =
        io::ImposedDisplacement(io::ReadCsvTable(request.path), request.column);
    measure("path", request.path, {.displacement = displacement});
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
    measure(scene.name, fmt::format("{}, lambda = {:g}", scene.title, scene.lambda), drive);
  }
  return measured;
}

/// States a choice: "spring, 1.5 ns/sample, 4.7 times as fast as mindlin by exact".
std::string ChoiceText(const MeasuredExcitation& scene, std::size_t choice) {
  const WorkPrecision& chosen = scene.points[choice];
  const auto exact = std::ranges::find_if(scene.points, [&](const WorkPrecision& point) {
    return point.approximation.model == scene.points.back().approximation.model;
  });
  const std::string text =
      fmt::format("{}, {:.1f} ns/sample", Describe(chosen.approximation), chosen.cost);
  if (&*exact == &chosen) return text + ": nothing cheaper is within it";
  return text + fmt::format(", {:.1f} times as fast as {}", exact->cost / chosen.cost,
                            Describe(exact->approximation));
}

/// Returns the points as rows of text, CSV and JSON.
Json PointRows(const MeasuredExcitation& scene) {
  Json rows = Json::array();
  for (const WorkPrecision& point : scene.points) {
    const tradeoff::Approximation& approximation = point.approximation;
    const Method* method = methods::FindMethod(approximation.method);
    const bool has_steps = method != nullptr && !method->steps.empty();
    const bool is_adaptive = method != nullptr && method->adaptive;
    rows.push_back({{"model", approximation.model},
                    {"method", method == nullptr ? Json() : Json(approximation.method)},
                    {"steps", has_steps ? Json(approximation.resolution.steps) : Json()},
                    {"tolerance", is_adaptive ? Json(approximation.resolution.tolerance) : Json()},
                    {"cost_ns_per_sample", point.cost},
                    {"max_force_error", point.precision.max_force},
                    {"rms_force_error", point.precision.rms_force},
                    {"energy_error", report::NumberOrNull(point.precision.energy)},
                    {"pareto", point.is_on_front}});
  }
  return rows;
}

Tradeoff MakeTradeoff(const TradeoffOptions& request) {
  if (!(request.tolerance > 0 && request.tolerance <= 1)) {
    ThrowInvalid("--tolerance [-]", request.tolerance, "must be in (0, 1]");
  }
  const bool is_contact_given = IsAnythingGiven(request.law) || request.law.alpha;
  Tradeoff study{.law = is_contact_given ? ResolveLaw(request.law) : PaperContact(),
                 .tolerance = request.tolerance};
  study.excitations = MeasureScenes(request, study.law);
  return study;
}

std::string ToText(const Tradeoff& study) {
  std::string text =
      fmt::format("sigma = {:g} N/m, alpha = {:g}, Tc = {:g} N\n", study.law.tangential_stiffness,
                  study.law.shape_exponent, study.law.slip_force);
  for (const MeasuredExcitation& scene : study.excitations) {
    text +=
        fmt::format("\n{}: {} samples\ncheapest within {:g} % of the peak force: {}\n", scene.title,
                    scene.samples, 100 * study.tolerance, ChoiceText(scene, scene.cheapest));
    if (scene.cheapest_with_energy != scene.cheapest) {
      text += fmt::format("and of the dissipated energy: {}\n",
                          ChoiceText(scene, scene.cheapest_with_energy));
    }
    text += report::TableText(PointRows(scene), 3);
  }
  return text;
}

/// Returns every point as CSV.
std::string PointsCsv(const Tradeoff& study) {
  Json rows = Json::array();
  for (const MeasuredExcitation& scene : study.excitations) {
    for (const Json& point : PointRows(scene)) {
      rows.push_back({{"excitation", scene.name}});
      rows.back().update(point);
    }
  }
  return report::TableCsv(rows);
}

io::Plot ToPlot(const Tradeoff& study) {
  const std::vector<MeasuredExcitation>& scenes = study.excitations;
  constexpr double kRounding = 1e-17;  // an error of 0 has no place on a logarithmic axis
  io::Plot plot{.title = "Work and precision: largest force error against cost"};
  plot.height = 60 + 460 * static_cast<int>(scenes.size());
  for (const MeasuredExcitation& scene : scenes) {
    io::PlotPanel panel{.x_label = "cost [ns/sample]", .y_label = "largest error of T over T*"};
    panel.log_x = true;
    panel.log_y = true;
    panel.title = scene.title;
    // One legend serves all panels: their curves are the same.
    const bool has_legend = &scene == &scenes.front();
    std::vector<std::string> labels;
    for (const WorkPrecision& point : scene.points) {
      const tradeoff::Approximation& approximation = point.approximation;
      const bool other_model = approximation.model != scene.points.back().approximation.model;
      const std::string& label = other_model ? approximation.model : approximation.method;
      auto place = static_cast<std::size_t>(std::ranges::find(labels, label) - labels.begin());
      if (place == labels.size()) {
        labels.push_back(label);
        panel.series.push_back(
            {.label = has_legend ? label : "",
             .style = other_model ? io::PlotStyle::kMarkers : io::PlotStyle::kLineAndPoints});
      }
      panel.series[place].x.push_back(point.cost);
      panel.series[place].y.push_back(std::max(point.precision.max_force, kRounding));
    }
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

std::string ToJson(const Tradeoff& study) {
  Json scenes = Json::array();
  for (const MeasuredExcitation& scene : study.excitations) {
    const Json points = PointRows(scene);
    scenes.push_back({{"name", scene.name},
                      {"samples", scene.samples},
                      {"cheapest", points[scene.cheapest]},
                      {"cheapest_with_energy", points[scene.cheapest_with_energy]},
                      {"points", points}});
  }
  return report::Dump({{"schema", "mindahl.tradeoff/1"},
                       {"version", Version()},
                       {"law",
                        {{"sigma", study.law.tangential_stiffness},
                         {"alpha", study.law.shape_exponent},
                         {"slip_force", study.law.slip_force}}},
                       {"tolerance", study.tolerance},
                       {"excitations", std::move(scenes)}});
}

void RunTradeoff(const TradeoffOptions& options, Console& console) {
  const Tradeoff study = MakeTradeoff(options);
  Say("tradeoff: warning", DoubtsAbout(options.law.contact), console);
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
  AddLawOptions(command, options->law);
  const OptionGroup group(command, "Excitation");
  CLI::Option* const scenes =
      group
          .Add("--excitation", options->excitations,
               "micro (sine, lambda 0.8), macro (sine, 1.2), growing, random, nested; "
               "default all")
          ->check(OneOf(NamesOf(kScenes, &Scene::name)));
  CLI::Option* const path =
      group.Add("--path", options->path, "CSV file with a displacement, any sequence", "FILE")
          ->excludes(scenes);
  group
      .Add("--displacement", options->column,
           "its column, by header name or number, with its unit, \"[um]\", if the\nheader has "
           "none; default by its name, else the first",
           "COL")
      ->needs(path);
  AddTolerance(OptionGroup(command, kPlainGroup), options->tolerance,
               "largest error allowed, of the peak force and of the energy: 0.01 or\n1%");
  const OptionGroup output(command, "Output");
  output.Add("--csv", options->csv, "every point, as CSV", "PATH");
  output.Add("--plot", options->plot, "work-precision diagrams, svg or png", "PATH");
  output.Add("--json", options->json, "results for scripts; - is standard output", "PATH");
  OnRun(command, [options, &console] { RunTradeoff(*options, console); });
}

}  // namespace mindahl::cli
