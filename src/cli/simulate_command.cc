#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/drive_options.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/text.h"
#include "mindahl/methods/method.h"
#include "mindahl/request/motion.h"

namespace mindahl::cli {

namespace {

using methods::Method;
using request::AddedForces;

struct SimulateOptions {
  request::SimulationRequest simulation;
  std::string output;
};

void AddAddedForceOptions(CLI::App& command, AddedForces& forces) {
  const OptionGroup group(command, "Forces in addition to the contact's");
  const auto add = [&](const char* name, auto& value, const char* help, const char* unit) {
    group.Add(name, value, help, unit);
  };
  add("--viscous", forces.viscous, "C of a viscous force C·dδ/dt [N s/m]", "C");
  add("--speed-exponent", forces.speed_exponent, "exponent of C·sgn(v)|v|^M instead, v in m/s [-]",
      "M");
  add("--inertia", forces.inertia, "mass of a force M·d²δ/dt² [kg]", "M");
  add("--slip-slope", forces.slip_slope,
      "m1 of forces times 1 + m1·x + m2·x², x the position from −1\nto 1 [-]", "M1");
  add("--slip-curvature", forces.slip_curvature, "m2, likewise [-]", "M2");
  add("--slip-trend", forces.slip_trend,
      "K of forces times 1 + K·τ, τ the time from −1 at the record's\nbeginning to 1 at its end "
      "[-]",
      "K");
  add("--plateau-slope", forces.plateau_slope, "slope of a force slope·δ [N/m]", "K");
  add("--plateau-curvature", forces.plateau_curvature, "curvature of a force curvature·δ² [N/m²]",
      "K");
  add("--ripple", forces.ripple, "period of a force over the position [m]", "PERIOD");
  add("--ripple-amplitude", forces.ripple_amplitude, "amplitude of that force [N]", "A");
  add("--ripple-phase-up", forces.ripple_phase_up, "phase where the displacement grows [rad]",
      "PHI");
  add("--ripple-phase-down", forces.ripple_phase_down, "phase where the displacement falls [rad]",
      "PHI");
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
       "mindahl simulate --model dahl --sigma 4e7 --alpha 1 --slip-force 40 --path "
       "path.csv --path-unit um"});
  const OptionGroup plain(command, kPlainGroup);
  plain.AddShown("--model", options->simulation.model, "friction model")
      .OneOf(request::SimulatedModels());
  AddLawOptions(command, options->simulation.law);
  plain.AddShown(
      "--asymmetry", options->simulation.asymmetry,
      "slip forces Tc(1 + A) where the displacement grows and Tc(1 - A) where\nit falls [-]", "A");
  plain.AddShown("--backlash", options->simulation.backlash,
                 "width of a gap before the contact that is crossed at zero force [m]", "G");
  AddAddedForceOptions(command, options->simulation.forces);
  AddDriveOptions(command, options->simulation.drive);
  AddLoadColumnOptions(command, options->simulation.drive);
  AddForcePathOptions(command, options->simulation.drive);

  const OptionGroup noise(command, "Noise");
  noise.Add("--noise-force", options->simulation.force_noise, "standard deviation [N]", "N");
  noise.Add("--noise-displacement", options->simulation.displacement_noise,
            "standard deviation [m]", "M");
  noise
      .AddShown("--seed", options->simulation.drive.seed,
                "seed of the noise and of the random waveform")
      .WholeNumber(0, std::numeric_limits<std::uint64_t>::max());

  const OptionGroup method(command, "Method");
  method.AddShown("--method", options->simulation.method, MethodHelp())
      .OneOf(NamesOf(methods::Methods(), &Method::name));
  method
      .Add("--steps", options->simulation.steps,
           "substeps a sample, elements of iwan, intervals of table", "N")
      .WholeNumber(1, 1'000'000'000);
  method.Add("--tolerance", options->simulation.tolerance,
             "largest local error of T/Tc in a step of dopri5 [-], default 1e-6", "E");
  plain.Add("-o,--output", options->output, "CSV file; default standard output", "FILE");
  WhenCalled(command, [options, &console] { RunSimulate(*options, console); });
}

}  // namespace mindahl::cli
