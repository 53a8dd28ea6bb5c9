#include <fmt/ranges.h>

#include <array>
#include <cmath>

#include "cli/command.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/plan.h"
#include "mindahl/io/plot.h"
#include "report/statements.h"

namespace mindahl::cli {

using identification::Expectation;
using identification::ExpectedFit;
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
  Expectation expected;
  std::optional<double> force_noise;
  std::vector<double> amplitudes;
  Protocol protocol;
  std::vector<std::string> want;
  std::string json;
  std::string plot;
};

struct Plan {
  Expectation expected;
  WantedPrecision wanted;
  double slip = 0.0;                    // displacement [m] of λ = 1
  std::vector<ExpectedFit> loops = {};  // by their initial states and amplitudes
  Json reached = Json::array();         // one an initial state, if anything is wanted
  std::vector<std::string> notes = {};
};

constexpr std::array kStates = {InitialState::kVirgin, InitialState::kSteady};

/// Takes law and noise from a fit of a record by Masing's law; where it does not identify α, with
/// Mindlin's.
void TakeRecord(const PlanOptions& options, Expectation& expected,
                std::vector<std::string>& notes) {
  if (IsAnythingGiven(options.law) || options.law.alpha) {
    Refuse("--record excludes --sigma, --alpha and --slip-force");
  }
  const io::RecordFile file = io::ReadRecord(options.record, options.columns);
  notes = file.notes;
  identification::FitOptions fit_options;
  if (!std::isinf(expected.rig.stiffness))
    fit_options.fixed["rig_stiffness"] = expected.rig.stiffness;
  identification::FitResult fit = identification::Fit({&file.record, 1}, fit_options);
  if (fit.converged && !fit.Find("alpha")->is_known()) {
    notes.emplace_back("alpha is not identified: Mindlin's 1/3 is assumed");
    fit_options.fixed["alpha"] = contact::kMindlinShapeExponent;
    fit = identification::Fit({&file.record, 1}, fit_options);
  }
  if (!fit.converged) {
    Refuse("--record: {}: the fit does not converge: see mindahl fit", options.record);
  }
  if (fit.adequacy.verdict != identification::AdequacyVerdict::kAdequate) {
    notes.emplace_back(
        "Masing's law does not describe this record: what it misses counts as noise");
  }
  for (const std::string_view name : {"sigma", "slip_force"}) {
    if (fit.Find(name)->is_known()) continue;
    notes.push_back(fmt::format("{} is not identified: its value is a guess", name));
  }
  expected.law = fit.law;
  expected.force_noise = fit.force_noise;
  if (expected.displacement_noise > 0) return;
  expected.displacement_noise = fit.records.front().displacement_noise;
}

Expectation Expect(const PlanOptions& options, std::vector<std::string>& notes) {
  Expectation expected = options.expected;
  Validate(expected.rig);
  RequireNonNegative("--displacement-noise [m]", expected.displacement_noise);
  if (!options.record.empty()) {
    TakeRecord(options, expected, notes);
  } else if (options.force_noise) {
    expected.law = ResolveLaw(options.law);
  } else {
    Refuse("--force-noise missing: give the standard deviation of the force [N]");
  }
  if (options.force_noise) expected.force_noise = *options.force_noise;
  return expected;
}

WantedPrecision ParseWanted(const std::vector<std::string>& texts) {
  WantedPrecision wanted;
  for (const std::string& text : texts) {
    const std::size_t equals = std::min(text.find('='), text.size());
    const std::string name = text.substr(0, equals);
    const auto precision =
        ParseShare(std::string_view(text).substr(std::min(equals + 1, text.size())));
    if (!precision) {
      Refuse(
          "--want: '{}' is no precision: must be NAME=ERROR with a standard error > 0 in the "
          "parameter's unit, or in percent of it, as alpha=0.01 or slip_force=1%",
          text);
    }
    RequireOneOf("--want", name, std::vector<std::string_view>{"sigma", "alpha", "slip_force"});
    if (!wanted.emplace(name, Precision{*precision, text.ends_with('%')}).second) {
      Refuse("--want: {} is given twice: give it once", name);
    }
  }
  return wanted;
}

Plan MakePlan(const PlanOptions& options) {
  Plan plan;
  plan.wanted = ParseWanted(options.want);
  plan.expected = Expect(options, plan.notes);
  plan.slip = SlipReach(plan.expected.law, plan.expected.rig);
  std::vector<double> amplitudes = options.amplitudes;
  constexpr std::array kShares = {0.1, 0.2, 0.3, 0.5, 0.7, 0.85, 1.0, 1.2, 1.5, 2., 3., 5., 10.};
  if (amplitudes.empty()) {
    for (const double share : kShares) amplitudes.push_back(share * plan.slip);
  }
  for (const InitialState state : kStates) {
    Protocol protocol = options.protocol;
    protocol.initial_state = state;
    for (const double amplitude : amplitudes) {
      protocol.amplitude = amplitude;
      plan.loops.push_back(identification::ExpectFit(plan.expected, protocol));
    }
    if (plan.wanted.empty()) continue;
    Protocol fewest;
    const std::optional<ExpectedFit> least = identification::LeastAmplitude(
        plan.expected, protocol, plan.wanted, kShares.front() * plan.slip,
        kShares.back() * plan.slip, &fewest);
    const bool any = fewest.amplitude > 0;
    plan.reached.push_back({{"initial_state", report::Name(state)},
                            {"least_amplitude", least ? Json(least->protocol.amplitude) : Json()},
                            {"fewest_cycles", any ? Json(fewest.cycles) : Json()},
                            {"amplitude_of_fewest_cycles", any ? Json(fewest.amplitude) : Json()}});
  }
  return plan;
}

/// Names a parameter that the table and the figure show.
struct ShownError {
  std::string_view parameter;
  std::string_view name;
  bool is_exponent;  // its error as it is; of the others over the value
};

constexpr auto kShownErrors = std::to_array<ShownError>(
    {{"sigma", "sigma", false}, {"alpha", "alpha", true}, {"slip_force", "Tc", false}});

/// Returns the error as it is shown; empty beyond 1, where the bound determines little.
std::optional<double> ErrorOf(const ExpectedFit& fit, const ShownError& shown) {
  const ParameterEstimate* estimate = fit.Find(shown.parameter);
  if (!estimate->standard_error) return std::nullopt;
  const double error =
      shown.is_exponent ? *estimate->standard_error : *estimate->standard_error / estimate->value;
  return error < 1 ? std::optional(error) : std::nullopt;
}

bool IsLawDecided(const ExpectedFit& fit) {
  return fit.law_evidence > identification::Thresholds().undecided;
}

Json ErrorRows(const Plan& plan) {
  return report::ListOf(plan.loops, [&](const ExpectedFit& fit) {
    Json row = {{"start", report::Name(fit.protocol.initial_state)},
                {"X [m]", fit.protocol.amplitude},
                {"X/slip", fit.protocol.amplitude / plan.slip}};
    for (const ShownError& each : kShownErrors) {
      const std::optional<double> error = ErrorOf(fit, each);
      row[each.name] = !error             ? "-"
                       : each.is_exponent ? fmt::format("{:.2g}", *error)
                                          : fmt::format("{:.2g} %", 100 * *error);
    }
    row["law"] = IsLawDecided(fit) ? "decided" : "open";
    return row;
  });
}

std::string ToText(const PlanOptions& options, const Plan& plan) {
  const Expectation& expected = plan.expected;
  const models::BranchLaw& law = expected.law;
  std::string text = fmt::format("expected: sigma = {:.6g} N/m, alpha = {:.6g}, Tc = {:.6g} N",
                                 law.tangential_stiffness, law.shape_exponent, law.slip_force);
  if (!std::isinf(expected.rig.stiffness)) {
    text += fmt::format(", rig {:.6g} N/m", expected.rig.stiffness);
  }
  text += fmt::format(
      "; noise {:.4g} N and {:.4g} m a\nsample; a sine of {:g} cycles, {} samples each\n",
      expected.force_noise, expected.displacement_noise, options.protocol.cycles,
      options.protocol.samples_per_cycle);
  for (const std::string& note : plan.notes) text += "note: " + note + '\n';
  text += fmt::format(
      "\nstandard errors\n{}"
      "  -: error larger than the value; law: is this loop expected to distinguish Mindlin's "
      "memory\n  rules from Dahl's (2 ln likelihood ratio above {:g})? Slip begins at {:.4g} m. A "
      "fit often\n  leaves Tc open where its error is above 7 %, alpha above 0.05.\n",
      report::TableText(ErrorRows(plan)), identification::Thresholds().undecided, plan.slip);
  if (plan.wanted.empty()) return text;
  constexpr int kDigits = 3;
  return text + fmt::format("\nwanted: {} (amplitudes in m)\n{}", fmt::join(options.want, ", "),
                            report::TableText(plan.reached, kDigits));
}

std::string ToJson(const Plan& plan) {
  const Expectation& expected = plan.expected;
  Json contact = report::LawJson(expected.law);
  contact.update({{"rig_stiffness", NumberOrNull(expected.rig.stiffness)},
                  {"force_noise", expected.force_noise},
                  {"displacement_noise", expected.displacement_noise},
                  {"gross_slip_displacement", plan.slip}});
  Json loops = report::ListOf(plan.loops, [](const ExpectedFit& fit) -> Json {
    Json parameters = Json::object();
    for (const ParameterEstimate& estimate : fit.parameters) {
      parameters[estimate.name] = {{"value", estimate.value},
                                   {"unit", estimate.unit},
                                   {"standard_error", NumberOrNull(estimate.standard_error)}};
    }
    return {{"initial_state", report::Name(fit.protocol.initial_state)},
            {"amplitude", fit.protocol.amplitude},
            {"peak_force", fit.peak_force},
            {"parameters", std::move(parameters)},
            {"law_decided", IsLawDecided(fit)}};
  });
  return report::Document("mindahl.plan/1", {{"expected", std::move(contact)},
                                             {"loops", std::move(loops)},
                                             {"reached", plan.reached},
                                             {"notes", plan.notes}});
}

/// Draws the expected errors against the amplitude, one panel per initial state.
io::Plot ToPlot(const Plan& plan) {
  io::Plot plot{.title = "Standard errors that a loop of amplitude X would give"};
  for (const InitialState state : kStates) {
    io::PlotPanel panel{.x_label = "amplitude X over the displacement at slip [-]",
                        .y_label = "standard error [-]",
                        .log_x = true,
                        .log_y = true,
                        .title = std::string(report::Name(state))};
    for (const ShownError& each : kShownErrors) {
      io::PlotSeries series{
          .label = fmt::format("{}{}", each.name, each.is_exponent ? "" : ", relative"),
          .style = io::PlotStyle::kLineAndPoints};
      for (const ExpectedFit& fit : plan.loops) {
        const std::optional<double> error = ErrorOf(fit, each);
        if (fit.protocol.initial_state != state || !error || *error <= 0) continue;
        series.x.push_back(fit.protocol.amplitude / plan.slip);
        series.y.push_back(*error);
      }
      if (!series.x.empty()) panel.series.push_back(std::move(series));
    }
    if (!panel.series.empty()) plot.panels.push_back(std::move(panel));
  }
  if (plot.panels.empty()) {
    Refuse("--plot: no amplitude determines a parameter: there is nothing to draw");
  }
  return plot;
}

void RunPlan(const PlanOptions& options, Console& console) {
  const Plan plan = MakePlan(options);
  if (!options.plot.empty()) io::WritePlot(ToPlot(plan), options.plot);
  WriteAnswer(options.json, console, ToJson(plan), ToText(options, plan));
  const auto fails = [](const Json& reached) { return reached["least_amplitude"].is_null(); };
  if (!plan.wanted.empty() && std::ranges::all_of(plan.reached, fails)) {
    console.exit_status = kNotEstablished;
  }
}

}  // namespace

void AddPlanCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<PlanOptions>();
  CLI::App& command = AddCommand(
      app, "plan",
      "Plans a measurement: the standard errors that a loop of each\n"
      "amplitude would give, and the smallest amplitude that reaches a wanted\n"
      "precision. Exit status 3 when none does.",
      {"mindahl plan --sigma 4e7 --slip-force 40 --force-noise 0.1 --want alpha=0.01,slip_force=1%",
       "mindahl plan --record loop.csv --cycles 10 --json plan.json"});
  AddLawParameters(OptionGroup(command, "Parameters"), options->law);
  const OptionGroup expected(command, "What is expected");
  CLI::Option* const record = expected.Add(
      "--record", options->record, "take law and noise from a fit of this record instead", "FILE");
  AddColumnOptions(command, options->columns);
  for (const char* name : {"--displacement", "--force", "--time", "--normal-load-column"}) {
    command.get_option(name)->needs(record);
  }
  expected.AddQuantity("--rig-stiffness", options->expected.rig.stiffness,
                       "known stiffness of the rig in series [N/m], of --record too", "K", "N/m");
  expected.AddQuantity("--force-noise", options->force_noise,
                       "standard deviation of the force noise [N]", "S", "N");
  expected.AddQuantity("--displacement-noise", options->expected.displacement_noise,
                       "standard deviation of the displacement noise [m], white; default 0", "S",
                       "m");
  const OptionGroup loop(command, "The loop");
  loop.AddQuantity("--amplitude", options->amplitudes,
                   "amplitude X [m], repeatable; default 13 around the onset of slip", "X", "m");
  loop.AddShown("--cycles", options->protocol.cycles, "cycles of the sine, >= 1", "M");
  loop.AddCount("--samples-per-cycle", options->protocol.samples_per_cycle, "samples of each cycle",
                4, 1'000'000);
  loop.Add("--want", options->want, "wanted standard errors: alpha=0.01,slip_force=1%",
           "NAME=ERROR")
      ->delimiter(',');
  const OptionGroup output(command, "Output");
  output.Add("--json", options->json, "results for scripts; - is standard output", "PATH");
  output.Add("--plot", options->plot, "errors against the amplitude, svg or png", "PATH");
  OnRun(command, [options, &console] { RunPlan(*options, console); });
}

}  // namespace mindahl::cli
