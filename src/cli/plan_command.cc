#include <fmt/format.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/fit_request.h"
#include "cli/options.h"
#include "cli/output.h"
#include "mindahl/core/error.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/request/plan.h"

namespace mindahl::cli {

using identification::Precision;
using identification::WantedPrecision;

namespace {

struct PlanOptions {
  request::PlanRequest plan;
  std::string record;
  io::RecordColumns columns;
  std::string initial_state = "both";
  std::vector<std::string> want;
  std::string json;
  std::string plot;
};

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

void RunPlan(const PlanOptions& options, Console& console) {
  RequireOutputPaths({{"--json", options.json, /*dash_is_stdout=*/true}, {"--plot", options.plot}},
                     console, {options.record});
  const Messages messages{console.err, "plan"};
  request::PlanRequest asked = options.plan;
  asked.wanted = ParseWanted(options.want);
  if (options.initial_state != "both") {
    asked.initial_state = options.initial_state == "virgin" ? models::InitialState::kVirgin
                                                            : models::InitialState::kSteady;
  }
  if (options.record.empty()) {
    RequireNoColumns(options.columns);
  } else {
    asked.record_name = options.record;
    asked.record = [&] {
      io::RecordFile file = io::ReadRecord(options.record, options.columns);
      for (const std::string& note : file.notes) {
        messages.Note(fmt::format("{}: {}", options.record, note));
      }
      return file;
    };
  }
  const request::Plan plan =
      request::MakePlan(asked, [&](std::string_view warning) { messages.Warn(warning); });
  if (!options.plot.empty()) io::WritePlot(ToPlot(plan), options.plot);
  WriteAnswer(options.json, console, plan);
  if (!plan.established()) console.exit_status = kNotEstablished;
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
       "mindahl plan --record loop.csv --cycles 10 --json plan.json",
       "mindahl plan --sigma 4e7 --slip-force 40 --force-noise 0.1 --load-ratio 0.5,1,2"});
  AddLawOptions(command, options->plan.law);
  const OptionGroup expected(command, "What is expected");
  expected.Add("--record", options->record,
               "take contact and noise from a fit of this record; --alpha is used\n"
               "where the record does not determine it",
               "FILE");
  AddColumnOptions(command, options->columns);
  expected
      .Add("--rig-stiffness", options->plan.rig_stiffness,
           "stiffness of the rig in series [N/m], of the fit of --record too;\nknown "
           "unless --with fits it",
           "K")
      ->transform(InUnit("N/m"));
  expected
      .Add("--force-noise", options->plan.force_noise, "standard deviation of the force noise [N]",
           "S")
      ->transform(InUnit("N"));
  expected
      .Add("--displacement-noise", options->plan.displacement_noise,
           "standard deviation of the displacement noise [m], white; default 0", "S")
      ->transform(InUnit("m"));
  expected.Add("--autocorrelation", options->plan.autocorrelation,
               "autocorrelation of the force noise between samples [-], in [0, 1);\ndefault 0",
               "RHO");
  expected.Add("--load-exponent", options->plan.load_exponent,
               "exponent p of sigma ~ N^p between the loads [-]; default 1/3, Hertz's", "P");
  const OptionGroup loop(command, "The loop");
  loop.Add("--amplitude", options->plan.amplitudes,
           "amplitude X [m], repeatable; default 13 around the onset of slip", "X")
      ->transform(InUnit("m"));
  loop.Add("--load-ratio", options->plan.load_ratios,
           "loads relative to this contact's own [-], one loop at each: 0.5,1,2", "R")
      ->delimiter(',');
  loop.AddShown("--cycles", options->plan.cycles, "cycles of the sine, >= 1", "M");
  loop.AddShown("--samples-per-cycle", options->plan.samples_per_cycle, "samples of each cycle")
      ->check(WholeNumber(4, 1'000'000));
  loop.AddShown("--initial-state", options->initial_state,
                "virgin: the loop includes the first loading; steady: it does not")
      ->check(OneOf({"virgin", "steady", "both"}));
  const OptionGroup fit(command, "The fit");
  fit.Add("--with", options->plan.with,
          "further terms that are fitted: rig_stiffness, plateau_slope …", "TERM")
      ->delimiter(',');
  fit.Add("--want", options->want, "wanted standard errors: alpha=0.01,slip_force=1%", "NAME=ERROR")
      ->delimiter(',');
  const OptionGroup output(command, "Output");
  output.Add("--json", options->json, "results for scripts; - is standard output", "PATH");
  output.Add("--plot", options->plot, "errors against the amplitude, svg or png", "PATH");
  command.callback([options, &console] { RunPlan(*options, console); });
}

}  // namespace mindahl::cli
