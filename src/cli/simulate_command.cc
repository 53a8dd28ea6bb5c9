#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/text.h"
#include "mindahl/methods/method.h"
#include "mindahl/request/motion.h"

namespace mindahl::cli {

namespace {

using methods::Method;

struct SimulateOptions {
  request::SimulationRequest simulation;
  std::string output;
};

void AddDriveOptions(CLI::App& command, request::DriveRequest& request) {
  const OptionGroup group(command, "Excitation");
  group.AddShown("--waveform", request.waveform, "imposed displacement")
      ->check(OneOf(models::WaveformNames()));
  group.Add("--lambda", request.lambda, "amplitude over the gross-slip displacement [-]", "L");
  group.Add("--amplitude", request.amplitude, "amplitude [m]", "M");
  group.AddShown("--cycles", request.excitation.cycles, "cycles [-]");
  group
      .AddShown("--samples-per-cycle", request.excitation.samples_per_cycle,
                "samples in a cycle; multiples of 4 put samples on the extremes")
      ->check(WholeNumber(4, 1'000'000'000));
  group.AddShown("--frequency", request.excitation.frequency, "frequency [Hz]");
  group.AddShown("--growth", request.excitation.growth,
                 "growing sine: last amplitude over the first [-]");
  CLI::Option* const path =
      group.Add("--path", request.path,
                "CSV file with a displacement, any sequence; one output row for\n"
                "each, time counting rows",
                "FILE");
  group
      .Add("--displacement", request.displacement,
           "its column, by header name or number, with its unit, \"[um]\", if the\nheader has "
           "none; default by its name, else the first",
           "COL")
      ->needs(path);
  group
      .Add("--normal-load-column", request.load_column,
           "column of the file with the normal load N [N], which then varies:\nTc = mu N", "COL")
      ->needs(path);
  CLI::Option* const force_path =
      group.Add("--force-path", request.force_path,
                "CSV file with a force, any sequence within the slip force: the\n"
                "displacement follows from it",
                "FILE");
  group.Add("--force", request.force, "its column, likewise", "COL")->needs(force_path);
  force_path->excludes(path);
  for (const char* name : {"--waveform", "--lambda", "--amplitude", "--cycles",
                           "--samples-per-cycle", "--frequency", "--growth"}) {
    path->excludes(command.get_option(name));
    force_path->excludes(command.get_option(name));
  }
}

std::string MethodHelp() {
  std::string help = "how the response is computed; --steps counts, by default";
  for (const Method& method : methods::Methods()) {
    help += fmt::format("\n{}: {}", method.name, method.title);
    if (!method.steps.empty()) help += fmt::format(" ({} {})", method.default_steps, method.steps);
  }
  return help;
}

void RunSimulate(const SimulateOptions& options, Console& console) {
  const request::SimulationRequest& asked = options.simulation;
  RequireOutputPaths({{"--output", options.output, /*dash_is_stdout=*/true}}, console,
                     {asked.drive.path, asked.drive.force_path});
  const request::Simulation simulation = request::Simulate(asked);
  WarnOfDoubts(asked.law.contact, "simulate", console);
  WriteText(ToCsv(simulation), options.output.empty() ? "-" : options.output, console);
}

}  // namespace

void AddSimulateCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<SimulateOptions>();
  CLI::App& command = AddCommand(
      app, "simulate",
      "Computes the tangential force along an imposed displacement, or the\n"
      "displacement under an imposed force (--force-path), exactly for any\n"
      "history. The contact is unloaded at displacement zero; a first row\n"
      "that is not zero is the first loading step. Writes time [s],\n"
      "displacement [m], force [N].",
      {"mindahl simulate --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 2 -o loop.csv",
       "mindahl simulate --model dahl --sigma 4e7 --alpha 1 --slip-force 40 \\",
       "    --path path.csv --displacement \"[um]\""});
  const OptionGroup plain(command, kPlainGroup);
  plain.AddShown("--model", options->simulation.model, "friction model")
      ->check(OneOf(request::SimulatedModels()));
  AddLawOptions(command, options->simulation.law);
  plain.AddShown(
      "--asymmetry", options->simulation.asymmetry,
      "slip forces Tc(1 + A) where the displacement grows and Tc(1 - A) where\nit falls [-]", "A");
  AddDriveOptions(command, options->simulation.drive);

  const OptionGroup noise(command, "Noise");
  noise.Add("--noise-force", options->simulation.force_noise, "standard deviation [N]", "N");
  noise.Add("--noise-displacement", options->simulation.displacement_noise,
            "standard deviation [m]", "M");
  noise
      .AddShown("--seed", options->simulation.drive.seed,
                "seed of the noise and of the random waveform")
      ->check(WholeNumber(0, std::numeric_limits<std::uint64_t>::max()));

  const OptionGroup method(command, "Method");
  method.AddShown("--method", options->simulation.method, MethodHelp())
      ->check(OneOf(NamesOf(methods::Methods(), &Method::name)));
  method
      .Add("--steps", options->simulation.steps,
           "substeps a sample, elements of iwan, intervals of table", "N")
      ->check(WholeNumber(1, 1'000'000'000));
  method.Add("--tolerance", options->simulation.tolerance,
             "largest local error of T/Tc in a step of dopri5 [-], default 1e-6", "E");
  plain.Add("-o,--output", options->output, "CSV file; default standard output", "FILE");
  command.callback([options, &console] { RunSimulate(*options, console); });
}

}  // namespace mindahl::cli
