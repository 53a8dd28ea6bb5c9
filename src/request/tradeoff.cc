#include "mindahl/request/tradeoff.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>

#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/models/excitation.h"
#include "request/json.h"

namespace mindahl::request {

using methods::Method;
using models::BranchLaw;
using models::Waveform;
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
                           const methods::Drive& drive, double tolerance) {
  MeasuredExcitation measured{.name = std::move(name),
                              .title = std::move(title),
                              .samples = drive.displacement.size(),
                              .points = tradeoff::MeasureWorkPrecision(law, drive)};
  measured.cheapest = tradeoff::CheapestWithin(tolerance, /*energy_counts=*/false, measured.points);
  measured.cheapest_with_energy =
      tradeoff::CheapestWithin(tolerance, /*energy_counts=*/true, measured.points);
  return measured;
}

std::vector<MeasuredExcitation> MeasureScenes(const TradeoffRequest& request,
                                              const BranchLaw& law) {
  std::vector<MeasuredExcitation> measured;
  if (!request.displacement.empty()) {
    measured.push_back(Measure(law, "path", request.path_name,
                               {.displacement = request.displacement}, request.tolerance));
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
                               fmt::format("{}, lambda = {:g}", scene.title, scene.lambda), drive,
                               request.tolerance));
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

std::string SceneText(const MeasuredExcitation& scene, double tolerance) {
  std::string text =
      fmt::format("{}: {} samples\ncheapest within {:g} % of the peak force: {}\n", scene.title,
                  scene.samples, 100 * tolerance, ChoiceText(scene, scene.cheapest));
  if (scene.cheapest_with_energy != scene.cheapest) {
    text += fmt::format("and of the dissipated energy: {}\n",
                        ChoiceText(scene, scene.cheapest_with_energy));
  }
  text += fmt::format("  {:<36} {:>10}  {:>8} {:>8} {:>8}\n", "", "ns/sample", "max dT", "rms dT",
                      "energy");
  for (const WorkPrecision& point : scene.points) {
    const std::string energy =
        point.precision.energy ? fmt::format("{:.1e}", *point.precision.energy) : "-";
    text += fmt::format("{} {:<36} {:>10.2f}  {:>8.1e} {:>8.1e} {:>8}\n",
                        point.is_on_front ? '*' : ' ', Describe(point.approximation), point.cost,
                        point.precision.max_force, point.precision.rms_force, energy);
  }
  return text + '\n';
}

/// Returns the keys of a point, which are the columns of the CSV too.
Json PointJson(const WorkPrecision& point) {
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
          {"rms_force_error", point.precision.rms_force},
          {"energy_error", NumberOrNull(point.precision.energy)},
          {"pareto", point.is_on_front}};
}

}  // namespace

std::vector<std::string_view> ExcitationNames() { return NamesOf(kScenes, &Scene::name); }

Tradeoff MakeTradeoff(const TradeoffRequest& request, const Tell& warn) {
  if (!(request.tolerance > 0 && request.tolerance <= 1)) {
    ThrowInvalid("--tolerance [-]", request.tolerance, "must be in (0, 1]");
  }
  const bool is_contact_given = IsAnythingGiven(request.law) || request.law.alpha;
  Tradeoff study{.law = is_contact_given ? ResolveLaw(request.law) : PaperContact(),
                 .tolerance = request.tolerance};
  for (const std::string& doubt : DoubtsAbout(request.law.contact)) warn(doubt);
  study.excitations = MeasureScenes(request, study.law);
  return study;
}

std::string ToText(const Tradeoff& study) {
  std::string text = fmt::format(
      "sigma = {:g} N/m, alpha = {:g}, Tc = {:g} N; * is on the Pareto front "
      "of cost and largest force error\n\n",
      study.law.tangential_stiffness, study.law.shape_exponent, study.law.slip_force);
  for (const MeasuredExcitation& scene : study.excitations) {
    text += SceneText(scene, study.tolerance);
  }
  return text;
}

std::string PointsCsv(const Tradeoff& study) {
  std::string text =
      "excitation,model,method,steps,tolerance,cost [ns/sample],max force error [-],"
      "rms force error [-],energy error [-],on Pareto front\n";
  for (const MeasuredExcitation& scene : study.excitations) {
    for (const WorkPrecision& point : scene.points) {
      text += scene.name;
      for (const Json& cell : PointJson(point)) {
        text += ',';
        if (cell.is_string()) {
          text += cell.get<std::string>();
        } else if (cell.is_boolean()) {
          text += cell.get<bool>() ? "1" : "0";
        } else if (!cell.is_null()) {
          text += cell.dump();
        }
      }
      text += '\n';
    }
  }
  return text;
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
    std::vector<std::string> order;
    std::map<std::string, io::PlotSeries> curves;
    for (const WorkPrecision& point : scene.points) {
      const tradeoff::Approximation& approximation = point.approximation;
      const bool other_model = approximation.model != scene.points.back().approximation.model;
      const std::string label = other_model ? approximation.model : approximation.method;
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
    const bool has_legend = &scene == &scenes.front();
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
  json["law"] = {{"sigma", study.law.tangential_stiffness},
                 {"alpha", study.law.shape_exponent},
                 {"slip_force", study.law.slip_force}};
  json["tolerance"] = study.tolerance;
  json["excitations"] = Json::array();
  for (const MeasuredExcitation& scene : study.excitations) {
    Json points = Json::array();
    for (const WorkPrecision& point : scene.points) points.push_back(PointJson(point));
    json["excitations"].push_back({{"name", scene.name},
                                   {"samples", scene.samples},
                                   {"cheapest", points[scene.cheapest]},
                                   {"cheapest_with_energy", points[scene.cheapest_with_energy]},
                                   {"points", points}});
  }
  return Dump(json);
}

}  // namespace mindahl::request
