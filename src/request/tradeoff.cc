#include "mindahl/request/tradeoff.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/text.h"
#include "mindahl/core/version.h"
#include "mindahl/models/excitation.h"
#include "mindahl/tradeoff/recommendation.h"
#include "request/json.h"

namespace mindahl::request {

using models::BranchLaw;
using models::Waveform;
using tradeoff::Criterion;
using tradeoff::LambdaRange;
using tradeoff::ModelRegion;
using tradeoff::ModelRegionOptions;
using tradeoff::WorkPrecision;

namespace {

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

MeasuredExcitation Measure(const BranchLaw& law, std::string name, std::string title,
                           const methods::Drive& drive) {
  const std::vector<tradeoff::Approximation> ladder =
      tradeoff::AllApproximationsAlong(law, drive, tradeoff::MakeReferenceResponse(law, drive));
  MeasuredExcitation measured{.name = std::move(name),
                              .title = std::move(title),
                              .samples = drive.displacement.size(),
                              .floor = tradeoff::MeasureCostFloor(drive),
                              .points = tradeoff::MeasureWorkPrecision(law, drive, ladder)};
  measured.front = tradeoff::ParetoFront(measured.points, Criterion::kMaxForce);
  return measured;
}

std::vector<MeasuredExcitation> MeasureScenes(const TradeoffRequest& request,
                                              const BranchLaw& law) {
  std::vector<MeasuredExcitation> measured;
  if (!request.displacement.empty()) {
    measured.push_back(
        Measure(law, "path", request.path_name, {.displacement = request.displacement}));
    return measured;
  }
  for (const Scene& scene : kScenes) {
    const bool chosen =
        request.excitations.empty() ||
        std::ranges::find(request.excitations, scene.name) != request.excitations.end();
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

std::string SceneText(const MeasuredExcitation& scene) {
  std::string text = fmt::format(
      "{}: {} samples; floor measured {:.2f} ns/sample for memory, {:.2f} with one square root "
      "and division\n  {}\n",
      scene.title, scene.samples, scene.floor.memory, scene.floor.arithmetic,
      PrecisionTableHead(/*is_timed=*/true));
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    text +=
        fmt::format("{} {}\n", scene.front[i] ? '*' : ' ',
                    PrecisionTableRow(scene.points[i], tradeoff::ModelledCostFloor().arithmetic));
  }
  return text + '\n';
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

std::string RegionsText(const std::vector<ModelRegion>& regions,
                        const ModelRegionOptions& studied) {
  std::string text =
      "lambda = X/delta_c at which a model, with the contact's sigma, alpha and Tc, is within a "
      "tolerance of the exact response\n(force: largest error of T*; energy: of that lost in the "
      "cycle), steady amplitude:\n";
  text += fmt::format("  {:<16} {:>5} {:<7}", "model", "cycle", "");
  for (const double tolerance : studied.tolerances) {
    text += fmt::format(" {:<22}", fmt::format("{:g} %", 100 * tolerance));
  }
  text += '\n';
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
    text += fmt::format("  {:<16} {:>5} {:<7}{}\n", region.model, region.cycle,
                        CriterionName(region.criterion), row);
  }
  return text + "  (a cycle without a row is like the one before it)\n";
}

}  // namespace

std::vector<std::string_view> ExcitationNames() { return NamesOf(kScenes, &Scene::name); }

Tradeoff MakeTradeoff(const TradeoffRequest& request, const Tell& warn, const Tell& progress) {
  const bool is_contact_given = IsAnythingGiven(request.law) || request.law.alpha;
  Tradeoff study{.law = is_contact_given ? ResolveLaw(request.law) : PaperContact()};
  for (const std::string& doubt : DoubtsAbout(request.law.contact)) warn(doubt);
  if (progress) progress("timing every method");
  study.excitations = MeasureScenes(request, study.law);
  if (progress) progress("searching where each model is good enough");
  if (study.law.shape_exponent < 1) {
    study.regions = tradeoff::FindModelRegions(study.law, study.studied);
  }
  return study;
}

std::string ToText(const Tradeoff& study) {
  std::string text = fmt::format(
      "sigma = {:g} N/m, alpha = {:g}, Tc = {:g} N; * is on the Pareto front "
      "of cost and largest force error\n\n",
      study.law.tangential_stiffness, study.law.shape_exponent, study.law.slip_force);
  for (const MeasuredExcitation& scene : study.excitations) text += SceneText(scene);
  if (!study.regions.empty()) text += RegionsText(study.regions, study.studied);
  return text;
}

std::string PointsCsv(const Tradeoff& study) {
  std::string text =
      "excitation,model,method,steps,tolerance,cost [ns/sample],measured [ns/sample],cost over "
      "floor [-],max force error "
      "[-],rms force error [-],energy error [-],on Pareto front,refitted sigma [N/m],refitted "
      "alpha [-],refitted Tc [N]\n";
  for (const MeasuredExcitation& scene : study.excitations) {
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      const WorkPrecision& point = scene.points[i];
      const Json json = PrecisionJson(point);
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

std::string RegionsCsv(const Tradeoff& study) {
  std::string text = "model,cycle,criterion,tolerance [-],lambda from [-],lambda to [-]\n";
  for (const ModelRegion& region : study.regions) {
    for (const LambdaRange& range : region.ranges) {
      text += fmt::format("{},{},{},{},{},{}\n", region.model, region.cycle,
                          CriterionName(region.criterion), region.tolerance, range.from, range.to);
    }
  }
  return text;
}

io::Plot ToPlot(const Tradeoff& study) {
  const std::vector<MeasuredExcitation>& scenes = study.excitations;
  constexpr double kRounding = 1e-17;  // an error of 0 has no place on a logarithmic axis
  io::Plot plot{.title = "Work and precision: largest force error against cost"};
  plot.columns = scenes.size() > 1 ? 2 : 1;
  const int rows = static_cast<int>((scenes.size() + 1) / 2);
  plot.width = plot.columns == 2 ? 1500 : 900;
  plot.height = 60 + 460 * rows;
  for (const MeasuredExcitation& scene : scenes) {
    io::PlotPanel panel{.x_label = "cost [ns/sample]", .y_label = "largest error of T over T*"};
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

std::string ToJson(const Tradeoff& study) {
  Json json;
  json["schema"] = "mindahl.tradeoff/1";
  json["version"] = Version();
  json["law"] = LawJson(study.law);
  json["excitations"] = Json::array();
  for (const MeasuredExcitation& scene : study.excitations) {
    Json entry;
    entry["name"] = scene.name;
    entry["samples"] = scene.samples;
    entry["cost_floor"] = FloorJson(scene.floor);
    entry["points"] = Json::array();
    for (std::size_t i = 0; i < scene.points.size(); ++i) {
      Json point = PrecisionJson(scene.points[i]);
      point["pareto"] = static_cast<bool>(scene.front[i]);
      entry["points"].push_back(point);
    }
    json["excitations"].push_back(entry);
  }
  json["model_regions"] = Json::array();
  for (const ModelRegion& region : study.regions) {
    Json entry = {{"model", region.model},
                  {"cycle", region.cycle},
                  {"criterion", CriterionName(region.criterion)},
                  {"tolerance", region.tolerance},
                  {"lambda", Json::array()}};
    for (const LambdaRange& range : region.ranges)
      entry["lambda"].push_back({range.from, range.to});
    json["model_regions"].push_back(entry);
  }
  return Dump(json);
}

}  // namespace mindahl::request
