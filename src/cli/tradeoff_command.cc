#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.h"
#include "cli/drive_options.h"
#include "cli/examples.h"
#include "cli/json_output.h"
#include "cli/law_options.h"
#include "cli/one_of.h"
#include "cli/output_path.h"
#include "cli/precision_table.h"
#include "cli/progress.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/models/excitation.h"
#include "mindahl/request/contact_parameters.h"
#include "mindahl/tradeoff/model_regions.h"
#include "mindahl/tradeoff/refit.h"
#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::cli {

using models::BranchLaw;
using models::Waveform;
using tradeoff::Criterion;
using tradeoff::LambdaRange;
using tradeoff::ModelRegion;
using tradeoff::ModelRegionOptions;
using tradeoff::WorkPrecision;

namespace {

/// An excitation of the study.
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

struct TradeoffOptions {
  LawOptions law;
  std::vector<std::string> scenes;
  std::string path;
  std::string path_unit;
  std::string csv;
  std::string regions_csv;
  std::string plot;
  std::string json;
};

/// A scene as it was measured.
struct MeasuredScene {
  std::string name;
  std::string title;
  std::size_t samples = 0;
  tradeoff::CostFloor floor;
  std::vector<WorkPrecision> points;
  std::vector<bool> front;  // by the largest force error
};

std::vector<std::string> SceneNames() {
  std::vector<std::string> names;
  names.reserve(kScenes.size());
  for (const Scene& scene : kScenes) names.emplace_back(scene.name);
  return names;
}

/// The contact of Peyret et al. (2017) §3.
BranchLaw PaperContact() {
  ContactOptions contact;
  contact.friction_coefficient = 0.3;
  contact.known.normal_load = 100;
  contact.known.contact_radius = 0.0027;
  contact.known.tangential_compliance = 4.42e-11;
  return ResolveContact(contact).law;
}

/// Returns the displacement [m] of λ = 1: gross slip, or three elastic limits where slip is only
/// approached.
double SlipReachOfLaw(const BranchLaw& law) {
  const double gross_slip = GrossSlipDisplacement(law);
  return std::isfinite(gross_slip) ? gross_slip : 3 * law.slip_force / law.tangential_stiffness;
}

MeasuredScene Measure(const BranchLaw& law, std::string name, std::string title,
                      const methods::Drive& drive) {
  const std::vector<tradeoff::Approximation> ladder =
      tradeoff::AllApproximationsAlong(law, drive, tradeoff::MakeReferenceResponse(law, drive));
  MeasuredScene measured{.name = std::move(name),
                         .title = std::move(title),
                         .samples = drive.displacement.size(),
                         .floor = tradeoff::MeasureCostFloor(drive),
                         .points = tradeoff::MeasureWorkPrecision(law, drive, ladder),
                         .front = {}};
  measured.front = tradeoff::ParetoFront(measured.points, Criterion::kMaxForce);
  return measured;
}

std::vector<MeasuredScene> MeasureScenes(const TradeoffOptions& options, const BranchLaw& law) {
  std::vector<MeasuredScene> measured;
  if (!options.path.empty()) {
    const std::vector<double> displacement =
        io::ReadDisplacementPath(options.path, {.column = "", .unit = options.path_unit});
    measured.push_back(Measure(law, "path", options.path, {.displacement = displacement}));
    return measured;
  }
  for (const Scene& scene : kScenes) {
    const bool chosen = options.scenes.empty() ||
                        std::ranges::find(options.scenes, scene.name) != options.scenes.end();
    if (!chosen) continue;
    const models::Excitation excitation =
        models::MakeExcitation({.waveform = scene.waveform,
                                .amplitude = scene.lambda * SlipReachOfLaw(law),
                                .cycles = scene.cycles});
    methods::Drive drive{.displacement = excitation.displacement};
    if (scene.waveform == Waveform::kGrowingSine) drive.envelope = excitation.envelope;
    measured.push_back(Measure(law, std::string(scene.name),
                               fmt::format("{}, lambda = {:g}", scene.title, scene.lambda), drive));
  }
  return measured;
}

void PrintScene(const MeasuredScene& scene, std::ostream& out) {
  out << fmt::format(
      "{}: {} samples; floor measured {:.2f} ns/sample for memory, {:.2f} with one square root "
      "and division\n  {}\n",
      scene.title, scene.samples, scene.floor.memory, scene.floor.arithmetic,
      PrecisionTableHead(/*is_timed=*/true));
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    out << fmt::format(
        "{} {}\n", scene.front[i] ? '*' : ' ',
        PrecisionTableRow(scene.points[i], tradeoff::ModelledCostFloor().arithmetic));
  }
  out << '\n';
}

/// "0.003 … 0.02, > 1.2"
std::string RangesInWords(const std::vector<LambdaRange>& ranges,
                          const ModelRegionOptions& studied) {
  std::string text;
  for (const LambdaRange& range : ranges) {
    const bool from_least = range.from <= studied.least_lambda;
    const bool to_greatest = range.to >= studied.greatest_lambda;
    if (!text.empty()) text += ", ";
    if (from_least && to_greatest) {
      text += "all";
    } else if (from_least) {
      text += fmt::format("< {:.3g}", range.to);
    } else if (to_greatest) {
      text += fmt::format("> {:.3g}", range.from);
    } else {
      text += fmt::format("{:.3g} … {:.3g}", range.from, range.to);
    }
  }
  return text.empty() ? "-" : text;
}

std::string_view CriterionName(Criterion criterion) {
  return criterion == Criterion::kEnergy ? "energy" : "force";
}

void PrintRegions(const std::vector<ModelRegion>& regions, const ModelRegionOptions& studied,
                  std::ostream& out) {
  out << "lambda = X/delta_c at which a model, with the contact's sigma, alpha and Tc, is within a "
         "tolerance of the exact response\n(force: largest error of T*; energy: of that lost in "
         "the "
         "cycle), steady amplitude:\n";
  out << fmt::format("  {:<16} {:>5} {:<7}", "model", "cycle", "");
  for (const double tolerance : studied.tolerances) {
    out << fmt::format(" {:<22}", fmt::format("{:g} %", 100 * tolerance));
  }
  out << '\n';
  // Regions come in the order model, cycle, criterion, tolerance. A cycle like the one before it is
  // not repeated.
  const std::size_t tolerances = studied.tolerances.size();
  std::map<std::string, std::string> last;
  for (std::size_t i = 0; i + tolerances <= regions.size(); i += tolerances) {
    const ModelRegion& region = regions[i];
    std::string row;
    for (std::size_t k = 0; k < tolerances; ++k) {
      row += fmt::format(" {:<22}", RangesInWords(regions[i + k].ranges, studied));
    }
    const std::string key = fmt::format("{}/{}", region.model, CriterionName(region.criterion));
    if (last[key] == row) continue;
    last[key] = row;
    out << fmt::format("  {:<16} {:>5} {:<7}{}\n", region.model, region.cycle,
                       CriterionName(region.criterion), row);
  }
  out << "  (a cycle without a row is like the one before it)\n";
}

std::string PointsCsv(const std::vector<MeasuredScene>& scenes) {
  std::string text =
      "excitation,model,method,steps,tolerance,cost [ns/sample],measured [ns/sample],cost over "
      "floor [-],max force "
      "error "
      "[-],rms force error [-],energy error [-],on Pareto front,refitted sigma [N/m],refitted "
      "alpha "
      "[-],refitted Tc [N]\n";
  for (const MeasuredScene& scene : scenes) {
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const WorkPrecision& point = scene.points[i];
      const nlohmann::ordered_json json = PrecisionJson(point);
      const auto cell = [&](const char* key) {
        return json[key].is_null()     ? std::string()
               : json[key].is_string() ? json[key].get<std::string>()
                                       : json[key].dump();
      };
      const auto own = [&](const char* key) {
        return json["refitted"].contains(key) ? json["refitted"][key].dump() : std::string();
      };
      text += fmt::format(
          "{},{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", scene.name, cell("model"),
          cell("method"), cell("steps"), cell("tolerance"), point.cost,
          cell("measured_ns_per_sample"), point.cost / tradeoff::ModelledCostFloor().arithmetic,
          point.precision.max_force, point.precision.rms_force, cell("energy_error"),
          scene.front[i] ? 1 : 0, own("sigma"), own("alpha"), own("slip_force"));
    }
  }
  return text;
}

std::string RegionsCsv(const std::vector<ModelRegion>& regions) {
  std::string text = "model,cycle,criterion,tolerance [-],lambda from [-],lambda to [-]\n";
  for (const ModelRegion& region : regions) {
    for (const LambdaRange& range : region.ranges) {
      text += fmt::format("{},{},{},{},{},{}\n", region.model, region.cycle,
                          CriterionName(region.criterion), region.tolerance, range.from, range.to);
    }
  }
  return text;
}

/// Errors against cost, one panel a scene: a curve for each method with its resolutions, a marker
/// for each model.
io::Plot WorkPrecisionPlot(const std::vector<MeasuredScene>& scenes) {
  constexpr double kRounding = 1e-17;  // an error of 0 has no place on a logarithmic axis
  io::Plot plot{.title = "Work and precision: largest force error against cost", .panels = {}};
  plot.columns = scenes.size() > 1 ? 2 : 1;
  const int rows = static_cast<int>((scenes.size() + 1) / 2);
  plot.width = plot.columns == 2 ? 1500 : 900;
  plot.height = 60 + 460 * rows;
  for (const MeasuredScene& scene : scenes) {
    io::PlotPanel panel{
        .x_label = "cost [ns/sample]", .y_label = "largest error of T over T*", .series = {}};
    panel.log_x = true;
    panel.log_y = true;
    panel.title = scene.title;
    std::vector<std::string> order;
    std::map<std::string, io::PlotSeries> curves;
    for (const WorkPrecision& point : scene.points) {
      const tradeoff::Approximation& approximation = point.approximation;
      const bool other_model = approximation.model != scene.points.back().approximation.model;
      const std::string label = !other_model        ? approximation.method
                                : approximation.law ? approximation.model + " refitted"
                                                    : approximation.model;
      if (!curves.contains(label)) {
        order.push_back(label);
        curves[label] = {
            .label = label,
            .x = {},
            .y = {},
            .style = other_model ? io::PlotStyle::kMarkers : io::PlotStyle::kLineAndPoints};
      }
      curves[label].x.push_back(point.cost);
      curves[label].y.push_back(std::max(point.precision.max_force, kRounding));
    }
    // One legend serves all panels: their curves are the same.
    const bool has_legend = &scene == &scenes.back();
    for (const std::string& label : order) {
      panel.series.push_back(curves[label]);
      if (!has_legend) panel.series.back().label.clear();
    }
    plot.panels.push_back(std::move(panel));
  }
  return plot;
}

nlohmann::ordered_json TradeoffJson(const BranchLaw& law, const std::vector<MeasuredScene>& scenes,
                                    const std::vector<ModelRegion>& regions) {
  nlohmann::ordered_json json;
  json["schema"] = "mindahl.tradeoff/1";
  json["version"] = Version();
  json["law"] = {{"sigma", law.tangential_stiffness},
                 {"alpha", law.shape_exponent},
                 {"slip_force", law.slip_force}};
  json["excitations"] = nlohmann::ordered_json::array();
  for (const MeasuredScene& scene : scenes) {
    nlohmann::ordered_json entry;
    entry["name"] = scene.name;
    entry["samples"] = scene.samples;
    entry["cost_floor"] = {{"memory_ns_per_sample", scene.floor.memory},
                           {"arithmetic_ns_per_sample", scene.floor.arithmetic}};
    entry["points"] = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      nlohmann::ordered_json point = PrecisionJson(scene.points[i]);
      point["pareto"] = static_cast<bool>(scene.front[i]);
      entry["points"].push_back(point);
    }
    json["excitations"].push_back(entry);
  }
  json["model_regions"] = nlohmann::ordered_json::array();
  for (const ModelRegion& region : regions) {
    nlohmann::ordered_json entry = {{"model", region.model},
                                    {"cycle", region.cycle},
                                    {"criterion", CriterionName(region.criterion)},
                                    {"tolerance", region.tolerance},
                                    {"lambda", nlohmann::ordered_json::array()}};
    for (const LambdaRange& range : region.ranges)
      entry["lambda"].push_back({range.from, range.to});
    json["model_regions"].push_back(entry);
  }
  return json;
}

void RequireOutputs(const TradeoffOptions& options, std::vector<std::string> inputs) {
  inputs.push_back(options.path);
  RequireOutputPaths({{"--csv", options.csv},
                      {"--regions-csv", options.regions_csv},
                      {"--plot", options.plot},
                      {"--json", options.json, /*dash_is_stdout=*/true}},
                     inputs);
}

void RunTradeoff(const TradeoffOptions& options, Console& console) {
  Validate(options.law);
  RequireOutputs(options, console.inputs);
  const bool is_contact_given = IsAnythingGiven(options.law) || options.law.alpha;
  const BranchLaw law = is_contact_given ? ResolveLaw(options.law) : PaperContact();
  WarnOfDoubts(options.law.contact, "tradeoff", console);
  const ModelRegionOptions studied;
  std::vector<MeasuredScene> scenes;
  std::vector<ModelRegion> regions;
  {
    Progress progress(console.err, "timing every method");
    scenes = MeasureScenes(options, law);
    progress.Say("looking where each model serves");
    if (law.shape_exponent < 1) regions = tradeoff::FindModelRegions(law, studied);
  }

  // The plot first: it alone may still fail.
  if (!options.plot.empty()) io::WritePlot(WorkPrecisionPlot(scenes), options.plot);
  if (!options.csv.empty()) io::WriteFileAtomically(options.csv, PointsCsv(scenes));
  if (!options.regions_csv.empty())
    io::WriteFileAtomically(options.regions_csv, RegionsCsv(regions));
  if (options.json != "-") {
    console.out << fmt::format(
        "sigma = {:g} N/m, alpha = {:g}, Tc = {:g} N; * is on the Pareto front "
        "of cost and largest force error\n\n",
        law.tangential_stiffness, law.shape_exponent, law.slip_force);
    for (const MeasuredScene& scene : scenes) PrintScene(scene, console.out);
    if (!regions.empty()) PrintRegions(regions, studied, console.out);
  }
  if (!options.json.empty()) WriteJson(TradeoffJson(law, scenes, regions), options.json, console);
}

}  // namespace

void AddTradeoffCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<TradeoffOptions>();
  CLI::App* command = app.add_subcommand(
      "tradeoff",
      "Error against cost of every method and model along five excitations, the cost by counted\n"
      "operations and as measured in this run,\n"
      "and the amplitudes at which each model is good enough. The contact is that of Peyret et "
      "al.\n"
      "(2017) unless another is given.");
  AddExamples(*command, app,
              {"mindahl tradeoff --excitation micro",
               "mindahl tradeoff --path path.csv --path-unit um --sigma 4e7 --slip-force 40 --csv "
               "points.csv"});
  AddLawOptions(*command, options->law);
  const std::string group = "Excitation";
  CLI::Option* scenes =
      command
          ->add_option("--excitation", options->scenes,
                       "micro (sine, lambda 0.8), macro (sine, 1.2), growing, random, nested; "
                       "default all")
          ->check(OneOf(SceneNames()))
          ->group(group);
  CLI::Option* path = command
                          ->add_option("--path", options->path,
                                       "CSV file whose first column is the displacement [m]")
                          ->type_name("FILE")
                          ->excludes(scenes)
                          ->group(group);
  command
      ->add_option("--path-unit", options->path_unit, "unit of that column, default the header's")
      ->type_name("UNIT")
      ->needs(path)
      ->group(group);
  const std::string output = "Output";
  command->add_option("--csv", options->csv, "every point, as CSV")
      ->type_name("PATH")
      ->group(output);
  command
      ->add_option("--regions-csv", options->regions_csv,
                   "amplitudes at which models serve, as CSV")
      ->type_name("PATH")
      ->group(output);
  command->add_option("--plot", options->plot, "work-precision diagrams, svg or png")
      ->type_name("PATH")
      ->group(output);
  command->add_option("--json", options->json, "results for scripts; - is standard output")
      ->type_name("PATH")
      ->group(output);
  command->callback([options, &console] { RunTradeoff(*options, console); });
}

}  // namespace mindahl::cli
