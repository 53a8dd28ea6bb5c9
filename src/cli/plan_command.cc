#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.h"
#include "cli/examples.h"
#include "cli/fit_request.h"
#include "cli/json_output.h"
#include "cli/law_options.h"
#include "cli/one_of.h"
#include "cli/output_path.h"
#include "cli/whole_number.h"
#include "core/nearest_name.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/plan.h"
#include "mindahl/identification/terms.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::cli {

using identification::Expectation;
using identification::ExpectedFit;
using identification::FitOptions;
using identification::ParameterEstimate;
using identification::Precision;
using identification::Protocol;
using identification::WantedPrecision;
using models::InitialState;

namespace {

struct PlanOptions {
  LawOptions law;
  std::string record;
  io::RecordColumns columns;
  std::optional<double> rig_stiffness;
  std::optional<double> force_noise;
  double displacement_noise = 0.0;
  double autocorrelation = 0.0;
  std::vector<double> amplitudes;
  std::vector<double> load_ratios;
  std::optional<double> load_exponent;
  std::size_t samples_per_cycle = 200;
  double cycles = 3.0;
  std::string initial_state = "both";
  std::vector<std::string> with;
  std::vector<std::string> want;
  std::string json;
  std::string plot;
};

/// The loops of one past of the contact, in the order of their amplitudes.
struct Column {
  InitialState state = InitialState::kVirgin;
  std::string_view name;
  std::vector<ExpectedFit> loops;
  std::optional<ExpectedFit> reached;  // what is wanted, at the least amplitude
  Protocol fewest;                     // that needs the fewest cycles for it
};

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

Precision ParsePrecision(const std::string& text, const std::string& whole) {
  std::size_t end = 0;
  Precision precision;
  try {
    precision.value = std::stod(text, &end);
  } catch (const std::exception&) {
    end = 0;
  }
  const std::string rest = end > 0 ? text.substr(end) : "?";
  precision.is_relative = rest == "%";
  if (precision.is_relative) precision.value /= 100;
  if ((!rest.empty() && !precision.is_relative) || !(precision.value > 0) ||
      !std::isfinite(precision.value)) {
    throw InputError(fmt::format(
        "--want: '{}' is no precision: must be NAME=ERROR with a standard error > 0 in the "
        "parameter's unit, or in percent of it, as alpha=0.01 or slip_force=1%",
        whole));
  }
  return precision;
}

WantedPrecision ParseWanted(const std::vector<std::string>& texts) {
  WantedPrecision wanted;
  for (const std::string& text : texts) {
    const std::size_t equals = text.find('=');
    const std::string name = text.substr(0, equals);
    const std::string value = equals == std::string::npos ? "" : text.substr(equals + 1);
    if (!wanted.emplace(name, ParsePrecision(value, text)).second) {
      throw InputError(fmt::format("--want: {} is given twice: give it once", name));
    }
  }
  return wanted;
}

/// Lists the terms that may be fitted in addition to the law before there is a record.
constexpr std::array<std::string_view, 4> kTerms = {"rig_stiffness", "plateau_slope", "viscous",
                                                    "force_drift"};

FitOptions FitOptionsOf(const PlanOptions& options) {
  FitOptions fit;
  for (const std::string& name : options.with) {
    if (std::ranges::find(kTerms, name) == kTerms.end()) {
      throw InputError(
          fmt::format("--with: '{}' cannot be planned for{} must be one of {}", name,
                      DidYouMean(name, std::vector<std::string>(kTerms.begin(), kTerms.end())),
                      fmt::join(kTerms, ", ")));
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
void ExpectFromRecord(const PlanOptions& options, Expectation& expected, Console& console) {
  constexpr double kMindlin = 1.0 / 3;
  const io::RecordFile file = io::ReadRecord(options.record, options.columns);
  for (const std::string& note : file.notes) {
    console.err << fmt::format("mindahl plan: note: {}: {}\n", options.record, note);
  }
  FitOptions fit_options = FitOptionsOf(options);
  if (options.law.alpha) fit_options.fixed["alpha"] = *options.law.alpha;
  identification::FitResult fit = identification::Fit({&file.record, 1}, fit_options);
  const auto say = [&](const std::string& what) {
    console.err << fmt::format("mindahl plan: warning: {}: {}\n", options.record, what);
  };
  const auto is_inadequate = [&] {
    return fit.adequacy.verdict == identification::AdequacyVerdict::kInadequate;
  };
  if (!is_inadequate() && !IsIdentified(fit, "alpha")) {
    say("alpha is not identified: taken to be 1/3, Mindlin's; --alpha takes another");
    fit_options.fixed["alpha"] = kMindlin;
    fit = identification::Fit({&file.record, 1}, fit_options);
  }
  if (!fit.converged) {
    throw InputError(fmt::format("--record: {}: the fit does not converge: mindahl fit says more",
                                 options.record));
  }
  if (is_inadequate()) {
    say("the model does not describe this record; what follows is of a contact that it does");
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

Expectation ExpectationOf(const PlanOptions& options, Console& console) {
  Expectation expected;
  const bool is_law_given = IsAnythingGiven(options.law);
  if (!options.record.empty()) {
    if (is_law_given) {
      throw InputError("--record excludes --sigma, --slip-force and whatever describes a contact");
    }
    ExpectFromRecord(options, expected, console);
  } else {
    RequireNoColumns(options.columns);
    if (!options.force_noise) {
      throw InputError("--force-noise missing: give the standard deviation of the force [N]");
    }
    Validate(options.law);
    expected.law = ResolveLaw(options.law);
  }
  RequireNonNegative("--displacement-noise [m]", options.displacement_noise);
  if (options.force_noise) expected.force_noise = *options.force_noise;
  if (options.displacement_noise > 0) expected.displacement_noise = options.displacement_noise;
  if (options.rig_stiffness) expected.rig.stiffness = *options.rig_stiffness;
  expected.autocorrelation = options.autocorrelation;
  if (options.load_exponent) {
    if (options.load_ratios.empty()) {
      throw InputError("--load-exponent needs --load-ratio: of one load it says nothing");
    }
    expected.load_exponent = *options.load_exponent;
  }
  const bool fits_rig = std::ranges::find(options.with, "rig_stiffness") != options.with.end();
  if (fits_rig && std::isinf(expected.rig.stiffness)) {
    throw InputError("--with rig_stiffness needs --rig-stiffness: what it is expected to be [N/m]");
  }
  return expected;
}

std::vector<double> AmplitudesOf(const PlanOptions& options, double slip) {
  if (!options.amplitudes.empty()) return options.amplitudes;
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

void PrintPlan(const PlanOptions& options, const Expectation& expected, double slip,
               const std::vector<Column>& columns, const WantedPrecision& wanted,
               std::ostream& out) {
  out << fmt::format(
      "expected: sigma = {:.6g} N/m, alpha = {:.6g}, Tc = {:.6g} N{}; noise {:.4g} N and {:.4g} m "
      "a\nsample{}; a sine of {:g} cycles, {} samples each\n\n",
      expected.law.tangential_stiffness, expected.law.shape_exponent, expected.law.slip_force,
      std::isinf(expected.rig.stiffness) ? ""
                                         : fmt::format(", rig {:.6g} N/m", expected.rig.stiffness),
      expected.force_noise, expected.displacement_noise,
      expected.autocorrelation > 0
          ? fmt::format(", autocorrelated by {:g} from one to the next", expected.autocorrelation)
          : "",
      options.cycles, options.samples_per_cycle);
  if (!options.load_ratios.empty()) {
    out << fmt::format("at {:g} times the load of this contact, sigma as the load to {:.4g}\n\n",
                       fmt::join(options.load_ratios, ", "), expected.load_exponent);
  }
  const std::vector<Shown> shown = ShownOf(columns.front().loops.front());
  constexpr std::size_t kCell = 9;
  constexpr std::size_t kLaw = 8;
  out << fmt::format("standard errors      ");
  for (const Column& column : columns) {
    out << fmt::format("| {:<{}} ", column.name, shown.size() * kCell + kLaw);
  }
  out << fmt::format("\n{:<12}{:<9}", "X [m]", "X/slip");
  for ([[maybe_unused]] const Column& column : columns) {
    out << "| ";
    for (const Shown& each : shown) out << fmt::format("{:<{}}", each.name, kCell);
    out << fmt::format("{:<{}} ", "law", kLaw);
  }
  out << '\n';
  for (std::size_t i = 0; i < columns.front().loops.size(); ++i) {
    const double amplitude = columns.front().loops[i].protocol.amplitude;
    out << fmt::format("{:<12.4g}{:<9.3g}", amplitude, amplitude / slip);
    for (const Column& column : columns) {
      const ExpectedFit& fit = column.loops[i];
      out << "| ";
      for (const Shown& each : shown) out << fmt::format("{:<{}}", Cell(fit, each), kCell);
      out << fmt::format("{:<{}} ", IsLawDecided(fit) ? "decided" : "open", kLaw);
    }
    out << '\n';
  }
  out << fmt::format(
      "  -: larger than the value, nothing is known of it; law: is this loop expected to tell "
      "Mindlin's\n  rules from Dahl's (2 ln likelihood ratio above {:g})? Slip begins at {:.4g} "
      "m{}.\n",
      identification::Thresholds().rival_past, slip,
      options.load_ratios.empty() ? "" : " at that load");
  if (wanted.empty()) return;
  out << fmt::format("\nwanted: {}\n", WantedInWords(wanted));
  for (const Column& column : columns) {
    if (column.reached) {
      const double amplitude = column.reached->protocol.amplitude;
      out << fmt::format("  {}: X >= {:.3g} m, {:.3g} of the displacement at slip\n", column.name,
                         amplitude, amplitude / slip);
    } else if (column.fewest.amplitude > 0) {
      out << fmt::format(
          "  {}: no amplitude reaches it with {:g} cycles; X = {:.3g} m would with {:g}\n",
          column.name, options.cycles, column.fewest.amplitude, column.fewest.cycles);
    } else {
      out << fmt::format("  {}: no amplitude determines it\n", column.name);
    }
  }
}

nlohmann::ordered_json PlanJson(const PlanOptions& options, const Expectation& expected,
                                double slip, const std::vector<Column>& columns,
                                const WantedPrecision& wanted) {
  nlohmann::ordered_json json;
  json["schema"] = "mindahl.plan/1";
  json["version"] = Version();
  json["expected"] = {{"sigma", expected.law.tangential_stiffness},
                      {"alpha", expected.law.shape_exponent},
                      {"slip_force", expected.law.slip_force},
                      {"rig_stiffness", NumberOrNull(expected.rig.stiffness)},
                      {"force_noise", expected.force_noise},
                      {"displacement_noise", expected.displacement_noise},
                      {"autocorrelation", expected.autocorrelation},
                      {"load_exponent", options.load_ratios.empty()
                                            ? nlohmann::ordered_json(nullptr)
                                            : nlohmann::ordered_json(expected.load_exponent)},
                      {"gross_slip_displacement", slip}};
  json["protocol"] = {{"cycles", options.cycles},
                      {"samples_per_cycle", options.samples_per_cycle},
                      {"load_ratios", options.load_ratios}};
  json["loops"] = nlohmann::ordered_json::array();
  for (const Column& column : columns) {
    for (const ExpectedFit& fit : column.loops) {
      nlohmann::ordered_json entry = {{"initial_state", column.name},
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
  json["wanted"] = nlohmann::ordered_json::object();
  for (const auto& [name, precision] : wanted) {
    json["wanted"][name] = {{"standard_error", precision.value},
                            {"relative", precision.is_relative}};
  }
  json["reached"] = nlohmann::ordered_json::array();
  if (wanted.empty()) return json;
  for (const Column& column : columns) {
    const bool any = column.fewest.amplitude > 0;
    json["reached"].push_back(
        {{"initial_state", column.name},
         {"least_amplitude",
          column.reached ? nlohmann::ordered_json(column.reached->protocol.amplitude) : nullptr},
         {"fewest_cycles", any ? nlohmann::ordered_json(column.fewest.cycles) : nullptr},
         {"amplitude_of_fewest_cycles",
          any ? nlohmann::ordered_json(column.fewest.amplitude) : nullptr}});
  }
  return json;
}

/// The loops of the options, but for their amplitude.
Protocol ProtocolOf(const PlanOptions& options, InitialState state) {
  return {.cycles = options.cycles,
          .samples_per_cycle = options.samples_per_cycle,
          .initial_state = state,
          .loads = options.load_ratios};
}

/// Plots the expected standard errors against the amplitude, one panel per initial state.
io::Plot ErrorPlot(const Expectation& expected, const PlanOptions& options, double slip) {
  constexpr int kPoints = 60;
  io::Plot plot{.title = "Standard errors that a loop of amplitude X would give", .panels = {}};
  plot.columns = 1;
  const FitOptions fit_options = FitOptionsOf(options);
  for (const auto& [state, name] :
       {std::pair(InitialState::kVirgin, "virgin"), {InitialState::kSteady, "steady"}}) {
    if (options.initial_state != "both" && options.initial_state != name) continue;
    io::PlotPanel panel{.x_label = "amplitude X over the displacement at slip [-]",
                        .y_label = "standard error [-]",
                        .series = {}};
    panel.log_x = true;
    panel.log_y = true;
    panel.title = name;
    Protocol protocol = ProtocolOf(options, state);
    std::vector<Shown> shown;
    std::vector<io::PlotSeries> series;
    for (int i = 0; i <= kPoints; ++i) {
      const double share =
          kLeastOfSlip * std::pow(kMost / kLeastOfSlip, static_cast<double>(i) / kPoints);
      protocol.amplitude = share * slip;
      const ExpectedFit fit = identification::ExpectFit(expected, protocol, fit_options);
      if (i == 0) {
        shown = ShownOf(fit);
        for (const Shown& each : shown) {
          series.push_back(
              {.label = fmt::format("{}{}", each.name, each.is_exponent ? "" : ", relative"),
               .x = {},
               .y = {}});
        }
      }
      for (std::size_t k = 0; k < shown.size(); ++k) {
        const std::optional<double> error = ErrorOf(fit, shown[k]);
        if (!error || *error <= 0) continue;
        series[k].x.push_back(share);
        series[k].y.push_back(*error);
      }
    }
    for (io::PlotSeries& each : series) {
      if (!each.x.empty()) panel.series.push_back(std::move(each));
    }
    if (!panel.series.empty()) plot.panels.push_back(std::move(panel));
  }
  if (plot.panels.empty()) {
    throw InputError("--plot: no amplitude determines a parameter: there is nothing to draw");
  }
  return plot;
}

void RunPlan(const PlanOptions& options, Console& console) {
  std::vector<std::string> inputs = console.inputs;
  inputs.push_back(options.record);
  RequireOutputPaths({{"--json", options.json, /*dash_is_stdout=*/true}, {"--plot", options.plot}},
                     inputs);
  const WantedPrecision wanted = ParseWanted(options.want);
  for (const auto& [name, precision] : wanted) {
    if (identification::FindTerm(name) == nullptr) {
      std::vector<std::string> names;
      for (const identification::Term& term : identification::Terms()) {
        names.emplace_back(term.name);
      }
      throw InputError(
          fmt::format("--want: '{}' is no parameter{} must be sigma, alpha, slip_force "
                      "or a term that --with names",
                      name, DidYouMean(name, names)));
    }
  }
  const Expectation expected = ExpectationOf(options, console);
  if (options.record.empty()) WarnOfDoubts(options.law.contact, "plan", console);
  const FitOptions fit_options = FitOptionsOf(options);
  const double slip = SlipReach(expected);
  std::vector<Column> columns;
  for (const auto& [state, name] : {std::pair(InitialState::kVirgin, std::string_view("virgin")),
                                    {InitialState::kSteady, "steady"}}) {
    if (options.initial_state != "both" && options.initial_state != name) continue;
    Column& column = columns.emplace_back();
    column.state = state;
    column.name = name;
    Protocol protocol = ProtocolOf(options, state);
    for (const double amplitude : AmplitudesOf(options, slip)) {
      protocol.amplitude = amplitude;
      column.loops.push_back(identification::ExpectFit(expected, protocol, fit_options));
    }
    if (wanted.empty()) continue;
    column.reached = identification::LeastAmplitude(expected, protocol, wanted, kLeastOfSlip * slip,
                                                    kMost * slip, fit_options, &column.fewest);
  }
  if (!options.plot.empty()) io::WritePlot(ErrorPlot(expected, options, slip), options.plot);
  if (options.json != "-") PrintPlan(options, expected, slip, columns, wanted, console.out);
  if (!options.json.empty()) {
    WriteJson(PlanJson(options, expected, slip, columns, wanted), options.json, console);
  }
  const bool reached =
      std::ranges::any_of(columns, [](const Column& column) { return column.reached.has_value(); });
  if (!wanted.empty() && !reached) console.exit_status = kNotEstablished;
}

}  // namespace

void AddPlanCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App* command =
      app.add_subcommand("plan",
                         "What should be measured: the standard errors that a loop of\n"
                         "each amplitude would give, and the least that reaches a wanted\n"
                         "precision. Exit status 3 when none does.");
  AddExamples(
      *command, app,
      {"mindahl plan --sigma 4e7 --slip-force 40 --force-noise 0.1 --want alpha=0.01,slip_force=1%",
       "mindahl plan --record loop.csv --cycles 10 --json plan.json",
       "mindahl plan --sigma 4e7 --slip-force 40 --force-noise 0.1 --load-ratio 0.5,1,2"});
  AddLawOptions(*command, options->law);
  const std::string expected = "What is expected";
  command
      ->add_option("--record", options->record,
                   "take contact and noise from a fit of this record; --alpha is used\n"
                   "where the record does not determine it")
      ->type_name("FILE")
      ->group(expected);
  AddColumnOptions(*command, options->columns);
  AddOptional(*command, "--rig-stiffness", options->rig_stiffness,
              "of the rig in series [N/m]; known, but for --with rig_stiffness", "K")
      ->group(expected);
  AddOptional(*command, "--force-noise", options->force_noise,
              "standard deviation of the force noise [N]", "S")
      ->group(expected);
  command
      ->add_option("--displacement-noise", options->displacement_noise,
                   "standard deviation of the displacement noise [m], white; default 0")
      ->type_name("S")
      ->group(expected);
  command
      ->add_option("--autocorrelation", options->autocorrelation,
                   "of the force noise between samples, in [0, 1) [-]; default 0")
      ->type_name("RHO")
      ->group(expected);
  AddOptional(*command, "--load-exponent", options->load_exponent,
              "p of sigma ~ N^p between these loads [-]; default 1/3, Hertz's", "P")
      ->group(expected);
  const std::string loop = "The loop";
  command
      ->add_option("--amplitude", options->amplitudes,
                   "amplitude X [m], repeatable; default 13 about slip")
      ->type_name("X")
      ->group(loop);
  command
      ->add_option("--load-ratio", options->load_ratios,
                   "loads over this contact's own [-], a loop at each: 0.5,1,2")
      ->type_name("R")
      ->delimiter(',')
      ->group(loop);
  command->add_option("--cycles", options->cycles, "cycles of the sine, >= 1")
      ->capture_default_str()
      ->type_name("M")
      ->group(loop);
  command->add_option("--samples-per-cycle", options->samples_per_cycle, "samples of each cycle")
      ->capture_default_str()
      ->check(WholeNumber(4, 1'000'000))
      ->group(loop);
  command
      ->add_option("--initial-state", options->initial_state,
                   "virgin: with the first loading; steady: begun later")
      ->capture_default_str()
      ->check(OneOf({"virgin", "steady", "both"}))
      ->group(loop);
  const std::string fit = "The fit";
  command
      ->add_option("--with", options->with,
                   "terms that are fitted too: rig_stiffness, plateau_slope …")
      ->type_name("TERM")
      ->delimiter(',')
      ->group(fit);
  command->add_option("--want", options->want, "wanted standard errors: alpha=0.01,slip_force=1%")
      ->type_name("NAME=ERROR")
      ->delimiter(',')
      ->group(fit);
  const std::string output = "Output";
  command->add_option("--json", options->json, "results for scripts; - is standard output")
      ->type_name("PATH")
      ->group(output);
  command->add_option("--plot", options->plot, "errors against the amplitude, svg or png")
      ->type_name("PATH")
      ->group(output);
  command->callback([options, &console] { RunPlan(*options, console); });
}

}  // namespace mindahl::cli
