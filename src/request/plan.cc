#include "mindahl/request/plan.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/nearest_name.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/terms.h"
#include "request/json.h"

namespace mindahl::request {

using identification::Expectation;
using identification::ExpectedFit;
using identification::FitOptions;
using identification::ParameterEstimate;
using identification::Protocol;
using identification::WantedPrecision;
using models::InitialState;

namespace {

/// Amplitudes are examined between these fractions of the displacement at gross slip.
constexpr double kLeastOfSlip = 0.1;
constexpr double kMost = 10.0;

/// Returns the displacement [m] of λ = 1: gross slip behind the rig, or three elastic limits where
/// slip is only approached.
double SlipReach(const Expectation& expected) {
  const double slip = models::GrossSlipDisplacement(expected.law, expected.rig);
  return std::isfinite(slip) ? slip
                             : 3 * expected.law.slip_force / expected.law.tangential_stiffness +
                                   expected.law.slip_force / expected.rig.stiffness;
}

FitOptions FitOptionsOf(const PlanRequest& request) {
  FitOptions fit;
  const std::vector<std::string_view> planned = identification::PlannedTerms();
  for (const std::string& name : request.with) {
    if (std::ranges::find(planned, name) == planned.end()) {
      throw InputError(
          fmt::format("--with: '{}' cannot be planned for{} must be one of {}", name,
                      DidYouMean(name, std::vector<std::string>(planned.begin(), planned.end())),
                      fmt::join(planned, ", ")));
    }
    fit.terms.push_back(name);
  }
  return fit;
}

bool IsIdentified(const identification::FitResult& fit, std::string_view name) {
  const ParameterEstimate* estimate = fit.Find(name);
  return estimate != nullptr && estimate->is_known();
}

/// Takes law and noise from the fit of a record. Where it does not identify α, that is taken to be.
/// --alpha or Mindlin's: the record has the other parameters to it.
void ExpectFromRecord(const PlanRequest& request, Expectation& expected, const Tell& warn) {
  constexpr double kMindlin = 1.0 / 3;
  const loop::Record record = request.record().record;
  FitOptions fit_options = FitOptionsOf(request);
  if (request.law.alpha) fit_options.fixed["alpha"] = *request.law.alpha;
  const bool fits_rig = std::ranges::find(request.with, "rig_stiffness") != request.with.end();
  if (request.rig_stiffness && !fits_rig) {
    RequirePositive("--rig-stiffness [N/m]", *request.rig_stiffness);
    fit_options.fixed["rig_stiffness"] = *request.rig_stiffness;
  }
  identification::FitResult fit = identification::Fit({&record, 1}, fit_options);
  const auto say = [&](const std::string& what) {
    warn(fmt::format("{}: {}", request.record_name, what));
  };
  const auto is_inadequate = [&] {
    return fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate;
  };
  if (!is_inadequate() && !IsIdentified(fit, "alpha")) {
    say("alpha is not identified: Mindlin's 1/3 is assumed; --alpha sets another value");
    fit_options.fixed["alpha"] = kMindlin;
    fit = identification::Fit({&record, 1}, fit_options);
  }
  if (!fit.converged) {
    throw InputError(fmt::format("--record: {}: the fit does not converge: see mindahl fit",
                                 request.record_name));
  }
  if (is_inadequate()) {
    say("the model does not describe this record: the plan holds for a contact that it describes");
  } else {
    for (const std::string_view name : {"sigma", "slip_force"}) {
      if (IsIdentified(fit, name)) continue;
      say(fmt::format("{} is not identified: its value is a guess", name));
    }
  }
  expected.law = fit.law;
  expected.rig = fit.rig;
  expected.force_noise = fit.force_noise;
  expected.displacement_noise = fit.records.front().displacement_noise;
}

Expectation ExpectationOf(const PlanRequest& request, const Tell& warn) {
  Expectation expected;
  if (request.record) {
    if (IsAnythingGiven(request.law)) {
      throw InputError(
          "--record excludes --sigma, --slip-force and other options that describe a contact");
    }
    ExpectFromRecord(request, expected, warn);
  } else {
    if (!request.force_noise) {
      throw InputError("--force-noise missing: give the standard deviation of the force [N]");
    }
    expected.law = ResolveLaw(request.law);
  }
  RequireNonNegative("--displacement-noise [m]", request.displacement_noise);
  if (request.force_noise) expected.force_noise = *request.force_noise;
  if (request.displacement_noise > 0) expected.displacement_noise = request.displacement_noise;
  if (request.rig_stiffness) expected.rig.stiffness = *request.rig_stiffness;
  expected.autocorrelation = request.autocorrelation;
  if (request.load_exponent) {
    if (request.load_ratios.empty()) {
      throw InputError("--load-exponent needs --load-ratio: it has no effect with one load");
    }
    expected.load_exponent = *request.load_exponent;
  }
  const bool fits_rig = std::ranges::find(request.with, "rig_stiffness") != request.with.end();
  if (fits_rig && std::isinf(expected.rig.stiffness)) {
    throw InputError("--with rig_stiffness needs --rig-stiffness, its expected value [N/m]");
  }
  return expected;
}

std::vector<double> AmplitudesOf(const PlanRequest& request, double slip) {
  if (!request.amplitudes.empty()) return request.amplitudes;
  std::vector<double> amplitudes;
  for (const double share : {0.1, 0.2, 0.3, 0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2.0, 3.0, 5.0, 10.0}) {
    amplitudes.push_back(share * slip);
  }
  return amplitudes;
}

/// Names a parameter that the table and the figure show.
struct Shown {
  std::string_view parameter;
  std::string_view name;
  bool is_exponent;  // its error as it is; of the others over the value
};

constexpr std::array<Shown, 5> kShown = {{{"sigma", "sigma", false},
                                          {"alpha", "alpha", true},
                                          {"slip_force", "Tc", false},
                                          {"load_exponent", "p", true},
                                          {"rig_stiffness", "rig", false}}};

std::vector<Shown> ShownOf(const ExpectedFit& fit) {
  std::vector<Shown> shown;
  for (const Shown& each : kShown) {
    const ParameterEstimate* estimate = fit.Find(each.parameter);
    if (estimate != nullptr && estimate->status != identification::ParameterStatus::kFixed) {
      shown.push_back(each);
    }
  }
  return shown;
}

/// Returns the error as it is shown; empty beyond 1, where the bound determines little.
std::optional<double> ErrorOf(const ExpectedFit& fit, const Shown& shown) {
  const ParameterEstimate& estimate = *fit.Find(shown.parameter);
  if (!estimate.standard_error) return std::nullopt;
  const double error =
      shown.is_exponent ? *estimate.standard_error : *estimate.standard_error / estimate.value;
  return error < 1 ? std::optional(error) : std::nullopt;
}

std::string Cell(const ExpectedFit& fit, const Shown& shown) {
  const std::optional<double> error = ErrorOf(fit, shown);
  if (!error) return "-";
  return shown.is_exponent ? fmt::format("{:.2g}", *error) : fmt::format("{:.2g} %", 100 * *error);
}

bool IsLawDecided(const ExpectedFit& fit) {
  return fit.law_evidence > identification::Thresholds().rival_past;
}

std::string WantedInWords(const WantedPrecision& wanted) {
  std::vector<std::string> parts;
  for (const auto& [name, precision] : wanted) {
    parts.push_back(precision.is_relative ? fmt::format("{} to {:g} %", name, 100 * precision.value)
                                          : fmt::format("{} to {:g}", name, precision.value));
  }
  return fmt::format("{}", fmt::join(parts, ", "));
}

/// The loops of the request, but for their amplitude.
Protocol ProtocolOf(const PlanRequest& request, InitialState state) {
  return {.cycles = request.cycles,
          .samples_per_cycle = request.samples_per_cycle,
          .initial_state = state,
          .loads = request.load_ratios};
}

constexpr std::array<std::pair<InitialState, std::string_view>, 2> kStates = {
    {{InitialState::kVirgin, "virgin"}, {InitialState::kSteady, "steady"}}};

void RequireNamesOfParameters(const WantedPrecision& wanted) {
  for (const auto& [name, precision] : wanted) {
    if (identification::FindTerm(name) != nullptr) continue;
    std::vector<std::string> names;
    for (const identification::Term& term : identification::Terms()) names.emplace_back(term.name);
    throw InputError(
        fmt::format("--want: '{}' is no parameter{} must be sigma, alpha, slip_force "
                    "or a term that --with names",
                    name, DidYouMean(name, names)));
  }
}

}  // namespace

bool Plan::established() const {
  return request.wanted.empty() || std::ranges::any_of(columns, [](const PlannedLoops& column) {
           return column.reached.has_value();
         });
}

Plan MakePlan(const PlanRequest& request, const Tell& warn) {
  RequireNamesOfParameters(request.wanted);
  Plan plan{.request = request, .expected = ExpectationOf(request, warn)};
  plan.slip = SlipReach(plan.expected);
  if (!request.record) {
    for (const std::string& doubt : DoubtsAbout(request.law.contact)) warn(doubt);
  }
  const FitOptions fit_options = FitOptionsOf(request);
  for (const auto& [state, name] : kStates) {
    if (request.initial_state.value_or(state) != state) continue;
    PlannedLoops& column = plan.columns.emplace_back();
    column.initial_state = name;
    Protocol protocol = ProtocolOf(request, state);
    for (const double amplitude : AmplitudesOf(request, plan.slip)) {
      protocol.amplitude = amplitude;
      column.loops.push_back(identification::ExpectFit(plan.expected, protocol, fit_options));
    }
    if (request.wanted.empty()) continue;
    column.reached = identification::LeastAmplitude(plan.expected, protocol, request.wanted,
                                                    kLeastOfSlip * plan.slip, kMost * plan.slip,
                                                    fit_options, &column.fewest);
  }
  return plan;
}

std::string ToText(const Plan& plan) {
  const PlanRequest& request = plan.request;
  const Expectation& expected = plan.expected;
  std::string text;
  text += fmt::format(
      "expected: sigma = {:.6g} N/m, alpha = {:.6g}, Tc = {:.6g} N{}; noise {:.4g} N and {:.4g} m "
      "a\nsample{}; a sine of {:g} cycles, {} samples each\n\n",
      expected.law.tangential_stiffness, expected.law.shape_exponent, expected.law.slip_force,
      std::isinf(expected.rig.stiffness) ? ""
                                         : fmt::format(", rig {:.6g} N/m", expected.rig.stiffness),
      expected.force_noise, expected.displacement_noise,
      expected.autocorrelation > 0
          ? fmt::format(", autocorrelated by {:g} from one to the next", expected.autocorrelation)
          : "",
      request.cycles, request.samples_per_cycle);
  if (!request.load_ratios.empty()) {
    text += fmt::format("at {:g} times the load of this contact, sigma as the load to {:.4g}\n\n",
                        fmt::join(request.load_ratios, ", "), expected.load_exponent);
  }
  const std::vector<Shown> shown = ShownOf(plan.columns.front().loops.front());
  constexpr std::size_t kCell = 9;
  constexpr std::size_t kLaw = 8;
  text += fmt::format("standard errors      ");
  for (const PlannedLoops& column : plan.columns) {
    text += fmt::format("| {:<{}} ", column.initial_state, shown.size() * kCell + kLaw);
  }
  text += fmt::format("\n{:<12}{:<9}", "X [m]", "X/slip");
  for ([[maybe_unused]] const PlannedLoops& column : plan.columns) {
    text += "| ";
    for (const Shown& each : shown) text += fmt::format("{:<{}}", each.name, kCell);
    text += fmt::format("{:<{}} ", "law", kLaw);
  }
  text += '\n';
  for (std::size_t i = 0; i < plan.columns.front().loops.size(); ++i) {
    const double amplitude = plan.columns.front().loops[i].protocol.amplitude;
    text += fmt::format("{:<12.4g}{:<9.3g}", amplitude, amplitude / plan.slip);
    for (const PlannedLoops& column : plan.columns) {
      const ExpectedFit& fit = column.loops[i];
      text += "| ";
      for (const Shown& each : shown) text += fmt::format("{:<{}}", Cell(fit, each), kCell);
      text += fmt::format("{:<{}} ", IsLawDecided(fit) ? "decided" : "open", kLaw);
    }
    text += '\n';
  }
  text += fmt::format(
      "  -: error larger than the value; law: is this loop expected to distinguish Mindlin's "
      "memory\n"
      "  rules from Dahl's (2 ln likelihood ratio above {:g})? Slip begins at {:.4g} m{}.\n",
      identification::Thresholds().rival_past, plan.slip,
      request.load_ratios.empty() ? "" : " at that load");
  if (request.wanted.empty()) return text;
  text += fmt::format("\nwanted: {}\n", WantedInWords(request.wanted));
  for (const PlannedLoops& column : plan.columns) {
    if (column.reached) {
      const double amplitude = column.reached->protocol.amplitude;
      text += fmt::format("  {}: X >= {:.3g} m, {:.3g} times the displacement at slip\n",
                          column.initial_state, amplitude, amplitude / plan.slip);
    } else if (column.fewest.amplitude > 0) {
      text += fmt::format(
          "  {}: no amplitude reaches it with {:g} cycles; X = {:.3g} m would with {:g}\n",
          column.initial_state, request.cycles, column.fewest.amplitude, column.fewest.cycles);
    } else {
      text += fmt::format("  {}: no amplitude determines it\n", column.initial_state);
    }
  }
  return text;
}

std::string ToJson(const Plan& plan) {
  const PlanRequest& request = plan.request;
  const Expectation& expected = plan.expected;
  Json json;
  json["schema"] = "mindahl.plan/1";
  json["version"] = Version();
  json["expected"] = {
      {"sigma", expected.law.tangential_stiffness},
      {"alpha", expected.law.shape_exponent},
      {"slip_force", expected.law.slip_force},
      {"rig_stiffness", NumberOrNull(expected.rig.stiffness)},
      {"force_noise", expected.force_noise},
      {"displacement_noise", expected.displacement_noise},
      {"autocorrelation", expected.autocorrelation},
      {"load_exponent", request.load_ratios.empty() ? Json() : Json(expected.load_exponent)},
      {"gross_slip_displacement", plan.slip}};
  json["protocol"] = {{"cycles", request.cycles},
                      {"samples_per_cycle", request.samples_per_cycle},
                      {"load_ratios", request.load_ratios}};
  json["loops"] = Json::array();
  for (const PlannedLoops& column : plan.columns) {
    for (const ExpectedFit& fit : column.loops) {
      Json entry = {{"initial_state", column.initial_state},
                    {"amplitude", fit.protocol.amplitude},
                    {"peak_force", fit.peak_force}};
      for (const ParameterEstimate& estimate : fit.parameters) {
        entry["parameters"][estimate.name] = {
            {"value", estimate.value},
            {"unit", estimate.unit},
            {"standard_error", NumberOrNull(estimate.standard_error)}};
      }
      entry["law_evidence"] = fit.law_evidence;
      entry["law_decided"] = IsLawDecided(fit);
      json["loops"].push_back(entry);
    }
  }
  json["wanted"] = Json::object();
  for (const auto& [name, precision] : request.wanted) {
    json["wanted"][name] = {{"standard_error", precision.value},
                            {"relative", precision.is_relative}};
  }
  json["reached"] = Json::array();
  if (request.wanted.empty()) return Dump(json);
  for (const PlannedLoops& column : plan.columns) {
    const bool any = column.fewest.amplitude > 0;
    json["reached"].push_back(
        {{"initial_state", column.initial_state},
         {"least_amplitude", column.reached ? Json(column.reached->protocol.amplitude) : nullptr},
         {"fewest_cycles", any ? Json(column.fewest.cycles) : nullptr},
         {"amplitude_of_fewest_cycles", any ? Json(column.fewest.amplitude) : nullptr}});
  }
  return Dump(json);
}

io::Plot ToPlot(const Plan& plan) {
  io::Plot plot{.title = "Standard errors that a loop of amplitude X would give"};
  for (const PlannedLoops& column : plan.columns) {
    io::PlotPanel panel{.x_label = "amplitude X over the displacement at slip [-]",
                        .y_label = "standard error [-]",
                        .log_x = true,
                        .log_y = true,
                        .title = std::string(column.initial_state)};
    for (const Shown& each : ShownOf(column.loops.front())) {
      io::PlotSeries series{
          .label = fmt::format("{}{}", each.name, each.is_exponent ? "" : ", relative"),
          .style = io::PlotStyle::kLineAndPoints};
      for (const ExpectedFit& fit : column.loops) {
        const std::optional<double> error = ErrorOf(fit, each);
        if (!error || *error <= 0) continue;
        series.x.push_back(fit.protocol.amplitude / plan.slip);
        series.y.push_back(*error);
      }
      if (!series.x.empty()) panel.series.push_back(std::move(series));
    }
    if (!panel.series.empty()) plot.panels.push_back(std::move(panel));
  }
  if (plot.panels.empty()) {
    throw InputError("--plot: no amplitude determines a parameter: there is nothing to draw");
  }
  return plot;
}

}  // namespace mindahl::request
