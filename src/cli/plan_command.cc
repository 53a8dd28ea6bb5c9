#include <array>
#include <cmath>

#include "cli/command.h"
#include "mindahl/identification/fit.h"
#include "mindahl/identification/plan.h"

namespace mindahl::cli {

using identification::Expectation;
using identification::ExpectedFit;
using identification::ParameterEstimate;
using identification::Protocol;
using identification::WantedPrecision;

namespace {

struct PlanOptions {
  LawRequest law;
  const models::FrictionModel* model = models::FindFrictionModel("mindlin-dahl");
  std::string record;
  io::RecordColumns columns;
  std::optional<double> rig_stiffness;
  std::optional<double> force_noise;
  std::optional<double> displacement_noise;
  std::vector<double> amplitudes;
  Protocol protocol;
  std::vector<std::string> want;
  std::string plot;
};

struct Plan {
  Expectation expected = {};
  double slip = 0.0;                    // displacement [m] of λ = 1
  std::vector<ExpectedFit> loops = {};  // by their amplitudes
  Json reached = {};                    // null where nothing is wanted
  std::vector<std::string> notes = {};
};

/// Takes law and noise from a fit of a record by the better law; by Mindlin's α, if α is open.
void TakeRecord(const PlanOptions& options, Plan& plan) {
  if (IsAnythingGiven(options.law)) Refuse("--record excludes --sigma, --alpha and --slip-force");
  const io::RecordFile file = io::ReadRecord(options.record, options.columns);
  plan.notes = file.notes;
  identification::FitOptions fit_options;
  if (options.rig_stiffness) fit_options.fixed["rig_stiffness"] = *options.rig_stiffness;
  identification::FitResult fit = identification::Fit({&file.record, 1}, fit_options);
  if (fit.prefers_other_law()) {
    identification::FitOptions of_other = fit_options;
    of_other.model = fit.law_choice->alternative;
    identification::FitResult other = identification::Fit({&file.record, 1}, of_other);
    if (other.converged && !other.prefers_other_law()) {
      plan.notes.emplace_back("Dahl's own law fits better than Masing's: the plan is by that");
      fit_options = std::move(of_other);
      fit = std::move(other);
    }
  }
  if (fit.converged && !fit.Find("alpha")->is_known()) {
    plan.notes.emplace_back("alpha is not identified: Mindlin's 1/3 is assumed");
    fit_options.fixed["alpha"] = contact::kMindlinShapeExponent;
    fit = identification::Fit({&file.record, 1}, fit_options);
  }
  if (!fit.converged) {
    Refuse("--record: {}: the fit does not converge: see mindahl fit", options.record);
  }
  if (fit.adequacy.verdict != identification::AdequacyVerdict::kAdequate) {
    plan.notes.emplace_back(
        "the law does not describe this record: what it misses counts as noise");
  }
  for (const std::string_view name : {"sigma", "slip_force"}) {
    if (fit.Find(name)->is_known()) continue;
    plan.notes.push_back(fmt::format("{} is not identified: its value is a guess", name));
  }
  plan.expected.law = fit.law;
  plan.expected.model = fit.model;
  // n samples of which m are effective give the errors of white noise √(n/m) times as large.
  constexpr double kWhite = 1.1;
  const auto samples = static_cast<double>(fit.residuals.samples);
  const double longer = std::sqrt(samples / fit.residuals.effective_samples);
  plan.expected.force_noise = fit.force_noise * std::max(longer, 1.0);
  if (longer > kWhite && !options.force_noise) {
    plan.notes.push_back(
        fmt::format("the noise is autocorrelated: {:.3g} N counts as {:.3g} N of white noise",
                    fit.force_noise, plan.expected.force_noise));
  }
  plan.expected.displacement_noise = fit.records.front().displacement_noise;
}

WantedPrecision ParseWanted(const std::vector<std::string>& texts) {
  WantedPrecision wanted;
  for (const std::string& text : texts) {
    const std::size_t equals = std::min(text.find('='), text.size() - 1);
    const auto precision = ParseQuantity(std::string_view(text).substr(equals + 1), "-");
    if (!precision || !(*precision > 0)) {
      Refuse(
          "--want: '{}' is no precision: must be NAME=ERROR with a standard error > 0 in the "
          "parameter's unit, or in percent of it, as alpha=0.01 or slip_force=1%",
          text);
    }
    wanted[text.substr(0, equals)] = {*precision, text.ends_with('%')};
  }
  return wanted;
}

Plan MakePlan(const PlanOptions& options) {
  Plan plan;
  const WantedPrecision wanted = ParseWanted(options.want);
  Expectation& expected = plan.expected;
  if (options.rig_stiffness) expected.rig.stiffness = *options.rig_stiffness;
  if (!options.record.empty()) {
    TakeRecord(options, plan);
  } else {
    expected.law = ResolveLaw(options.law);
    expected.model = options.model;
    if (!options.force_noise) {
      Refuse(
          "--force-noise missing: give the standard deviation of the force's noise, or --record");
    }
  }
  if (options.force_noise) expected.force_noise = *options.force_noise;
  if (options.displacement_noise) expected.displacement_noise = *options.displacement_noise;
  // A steady loop of Dahl's own law is one of Masing's of 2^α times the stiffness.
  models::BranchLaw masing = expected.law;
  if (expected.model->memory == models::Memory::kNone) {
    masing.tangential_stiffness *= std::exp2(masing.shape_exponent);
  }
  plan.slip = SlipReach(masing, expected.rig);
  std::vector<double> amplitudes = options.amplitudes;
  constexpr double kMargin = 1.03;  // of an amplitude that is to reach slip
  constexpr std::array kShares = {0.1, 0.2, 0.3, 0.5, 0.7, 0.85, kMargin,
                                  1.2, 1.5, 2.,  3.,  5.,  10.};
  if (amplitudes.empty()) {
    for (const double share : kShares) amplitudes.push_back(share * plan.slip);
  }
  Protocol protocol = options.protocol;
  for (const double amplitude : amplitudes) {
    protocol.amplitude = amplitude;
    plan.loops.push_back(ExpectFit(expected, protocol));
  }
  if (wanted.empty()) return plan;
  // Just short of slip the error of a sharp knee's Tc is many times that at slip: an amplitude that
  // reaches slip is to give the wanted precision even if it is smaller by the margin.
  const auto factor_of = [&](const ExpectedFit& fit) {
    const double factor = CyclesFactor(fit, wanted);
    Protocol smaller = fit.protocol;
    smaller.amplitude /= kMargin;
    if (fit.protocol.amplitude < plan.slip) return factor;
    return std::max(factor, CyclesFactor(ExpectFit(expected, smaller), wanted));
  };
  std::optional<double> least;
  for (const ExpectedFit& fit : plan.loops) {
    const double amplitude = fit.protocol.amplitude;
    if (factor_of(fit) <= 1) least = std::min(least.value_or(amplitude), amplitude);
  }
  const ExpectedFit& fewest = *std::ranges::min_element(plan.loops, {}, factor_of);
  const double factor = factor_of(fewest);
  plan.reached = {
      {"least_amplitude", NumberOrNull(least)},
      {"fewest_cycles", NumberOrNull(std::max(1.0, std::ceil(factor * protocol.cycles)))},
      {"amplitude_of_fewest_cycles",
       std::isfinite(factor) ? Json(fewest.protocol.amplitude) : Json()}};
  return plan;
}

/// Returns the standard error over the value, of a pure number as it is; empty beyond 1.
std::optional<double> ErrorOf(const ExpectedFit& fit, std::string_view parameter) {
  const ParameterEstimate* estimate = fit.Find(parameter);
  if (!estimate->standard_error) return std::nullopt;
  const double error = *estimate->standard_error / (estimate->unit == "-" ? 1.0 : estimate->value);
  return error < 1 ? std::optional(error) : std::nullopt;
}

std::string ToText(const PlanOptions& options, const Plan& plan) {
  constexpr int kDigits = 3;
  const Expectation& expected = plan.expected;
  const models::BranchLaw& law = expected.law;
  std::string text = fmt::format("expected: {}sigma = {:.6g} N/m, alpha = {:.6g}, Tc = {:.6g} N",
                                 expected.model->name == "dahl" ? "Dahl's own law, " : "",
                                 law.tangential_stiffness, law.shape_exponent, law.slip_force);
  if (options.rig_stiffness) text += fmt::format(", rig {:.6g} N/m", *options.rig_stiffness);
  text += fmt::format(
      "; noise {:.4g} N and {:.4g} m a\nsample; a sine of {:g} cycles, {} samples each\n",
      expected.force_noise, expected.displacement_noise, options.protocol.cycles,
      options.protocol.samples_per_cycle);
  for (const std::string& note : plan.notes) text += "note: " + note + '\n';
  const Json errors = report::ListOf(plan.loops, [&](const ExpectedFit& fit) {
    Json row = {{"X [m]", fit.protocol.amplitude}, {"X/slip", fit.protocol.amplitude / plan.slip}};
    for (const char* parameter : report::kLawParameters) {
      row[parameter] = NumberOrNull(ErrorOf(fit, parameter));
    }
    return row;
  });
  text += fmt::format(
      "\nstandard errors, of sigma and slip_force over the value\n{}"
      "  -: larger than the value. Slip begins at {:.4g} m. A fit often leaves slip_force open\n"
      "  where its error is above 0.07, alpha above 0.05.\n",
      report::TableText(errors, kDigits), plan.slip);
  if (options.want.empty()) return text;
  return text + fmt::format("\nwanted: {} (amplitudes in m)\n{}", fmt::join(options.want, ", "),
                            report::TableText(Json::array({plan.reached}), kDigits));
}

std::string ToJson(const Plan& plan) {
  const Expectation& expected = plan.expected;
  Json contact = report::LawJson(expected.law);
  contact.update({{"model", expected.model->name},
                  {"rig_stiffness", NumberOrNull(expected.rig.stiffness)},
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
    return {{"amplitude", fit.protocol.amplitude},
            {"peak_force", fit.peak_force},
            {"parameters", std::move(parameters)}};
  });
  return report::Document("mindahl.plan/1", {{"expected", std::move(contact)},
                                             {"loops", std::move(loops)},
                                             {"reached", plan.reached},
                                             {"notes", plan.notes}});
}

/// Draws the expected errors against the amplitude.
io::Plot ToPlot(const Plan& plan) {
  io::PlotPanel panel{.x_label = "amplitude X over the displacement at slip [-]",
                      .y_label = "standard error, of sigma and slip_force over the value [-]",
                      .log_x = true,
                      .log_y = true};
  for (const char* parameter : report::kLawParameters) {
    io::PlotSeries series{.label = parameter, .style = io::PlotStyle::kLineAndPoints};
    for (const ExpectedFit& fit : plan.loops) {
      const std::optional<double> error = ErrorOf(fit, parameter);
      if (!error || *error <= 0) continue;
      series.x.push_back(fit.protocol.amplitude / plan.slip);
      series.y.push_back(*error);
    }
    if (!series.x.empty()) panel.series.push_back(std::move(series));
  }
  if (panel.series.empty()) {
    Refuse("--plot: no amplitude determines a parameter: there is nothing to draw");
  }
  return {.title = "Standard errors that a loop of amplitude X would give", .panels = {panel}};
}

void RunPlan(const PlanOptions& options, Console& console) {
  const Plan plan = MakePlan(options);
  if (!options.plot.empty()) io::WritePlot(ToPlot(plan), options.plot);
  WriteAnswer(console, ToJson(plan), ToText(options, plan));
  const bool fails = !options.want.empty() && plan.reached["least_amplitude"].is_null();
  if (fails) console.exit_status = kNotEstablished;
}

}  // namespace

void AddPlanCommand(CLI::App& app, Console& console) {
  const auto [command, options] = AddCommand(
      app, console, "plan",
      "Plans a measurement: the standard errors that a loop of each\n"
      "amplitude would give, and the smallest of these that reaches a wanted\n"
      "precision. Exit status 3 when none does.",
      {"mindahl plan --sigma 4e7 --slip-force 40 --force-noise 0.1 --want alpha=0.01,slip_force=1%",
       "mindahl plan --record loop.csv --cycles 10 --json plan.json"},
      &RunPlan);
  const OptionGroup parameters(command, "Parameters");
  AddLawParameters(parameters, options.law);
  CLI::Option* const model = parameters.AddChoice(
      "--model", options.model,
      {{"mindlin-dahl", options.model}, {"dahl", models::FindFrictionModel("dahl")}},
      "law of these parameters: Masing's, or Dahl's own, as of a joint");
  const OptionGroup expected(command, "What is expected");
  CLI::Option* const record = expected.Add(
      "--record", options.record, "take law and noise from a fit of this record instead", "FILE");
  model->excludes(record);
  AddColumnOptions(command, options.columns);
  for (const char* name : {"--displacement", "--force", "--time", "--normal-load-column",
                           "--sample-rate", "--encoding"}) {
    command.get_option(name)->needs(record);
  }
  expected.AddQuantity("--rig-stiffness", options.rig_stiffness,
                       "known stiffness of the rig in series [N/m], of --record too", "K", "N/m");
  expected.AddQuantity("--force-noise", options.force_noise,
                       "standard deviation of the force noise [N]", "S", "N");
  expected.AddQuantity("--displacement-noise", options.displacement_noise,
                       "standard deviation of the displacement noise [m], white; default 0", "S",
                       "m");
  const OptionGroup loop(command, "The loop");
  loop.AddQuantity("--amplitude", options.amplitudes,
                   "amplitude X [m], repeatable; default 13 around the onset of slip", "X", "m");
  loop.AddShown("--cycles", options.protocol.cycles, "cycles of the sine, >= 1", "M");
  loop.AddCount("--samples-per-cycle", options.protocol.samples_per_cycle, "samples of each cycle",
                4, 1'000'000);
  loop.Add("--want", options.want, "wanted standard errors: alpha=0.01,slip_force=1%", "NAME=ERROR")
      ->delimiter(',');
  const OptionGroup output(command, "Output");
  output.AddJson(console);
  output.Add("--plot", options.plot, "errors against the amplitude, svg or png", "PATH");
}

}  // namespace mindahl::cli
