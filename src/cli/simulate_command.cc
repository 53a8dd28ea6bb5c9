#include <fmt/format.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/excitation.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/joint_friction.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "mindahl/models/variable_load.h"
#include "mindahl/tradeoff/approximation.h"

namespace mindahl::cli {

using methods::Method;
using models::FrictionModel;
using tradeoff::Approximation;

namespace {

struct SimulateOptions {
  std::string model = "mindlin";
  LawOptions law;
  models::ExcitationOptions excitation{.cycles = 1.0};
  std::optional<double> lambda;
  std::optional<double> amplitude;
  std::string path;                 // a file with the motion, instead
  std::string displacement;         // column of that file; "": the first, or by its name
  std::string load_column;          // likewise, of the normal load; "": the load is constant
  std::string force_path;           // a file that imposes the force instead
  std::string force;                // column of that file, likewise
  double asymmetry = 0.0;           // A of slip forces Tc(1 ± A) [-]
  double force_noise = 0.0;         // standard deviation [N]
  double displacement_noise = 0.0;  // standard deviation [m]
  std::string method = "exact";
  std::optional<std::size_t> steps;
  std::optional<double> tolerance;
  std::string output;
};

/// One entry a row of output.
struct Simulation {
  std::vector<double> time = {};          // [s]
  std::vector<double> displacement = {};  // [m]
  std::vector<double> envelope = {};      // [m]; empty unless the amplitude changes along the way
  std::vector<double> normal_load = {};   // [N]; empty unless a file gives it
  std::vector<double> force = {};         // [N]
};

/// Time counts rows.
std::vector<double> CountRows(std::size_t rows) {
  std::vector<double> time(rows);
  std::iota(time.begin(), time.end(), 0.0);
  return time;
}

Simulation MotionFromFile(const SimulateOptions& options) {
  Simulation motion;
  const io::CsvTable table = io::ReadCsvTable(options.path);
  motion.displacement = io::ImposedColumn(table, io::Imposed::kDisplacement, options.displacement);
  if (!options.load_column.empty()) {
    motion.normal_load = io::ImposedColumn(table, io::Imposed::kNormalLoad, options.load_column);
  }
  motion.time = CountRows(motion.displacement.size());
  return motion;
}

Simulation MakeMotion(const SimulateOptions& options, const models::BranchLaw& law) {
  if (!options.path.empty()) return MotionFromFile(options);
  models::ExcitationOptions excitation = options.excitation;
  if (options.lambda.has_value() == options.amplitude.has_value()) {
    throw InputError("--lambda or --amplitude, one of the two, must be given (or --path)");
  }
  if (options.lambda) {
    RequirePositive("--lambda [-]", *options.lambda);
    const double gross_slip = GrossSlipDisplacement(law);
    if (!std::isfinite(gross_slip)) {
      throw InputError(fmt::format(
          "--lambda needs a finite gross-slip displacement, which does not exist for alpha = {} >= "
          "1: give --amplitude",
          law.shape_exponent));
    }
    excitation.amplitude = *options.lambda * gross_slip;
  } else {
    RequirePositive("--amplitude [m]", *options.amplitude);
    excitation.amplitude = *options.amplitude;
  }
  models::Excitation made = models::MakeExcitation(excitation);
  Simulation motion{.time = std::move(made.time), .displacement = std::move(made.displacement)};
  if (excitation.waveform == models::Waveform::kGrowingSine) {
    motion.envelope = std::move(made.envelope);
  }
  return motion;
}

/// Returns a force within the slip force, which a file imposes.
std::vector<double> ReadImposedForce(const SimulateOptions& options, const models::BranchLaw& law) {
  const io::CsvTable table = io::ReadCsvTable(options.force_path);
  std::vector<double> force = io::ImposedColumn(table, io::Imposed::kForce, options.force);
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (std::abs(force[i]) < law.slip_force) continue;
    throw InputError(fmt::format(
        "{}:{}: a force of {} N is not within the slip force, {} N, at which the contact slides "
        "any distance: keep forces below it, or impose the displacement with --path",
        options.force_path, table.lines[i], force[i], law.slip_force));
  }
  return force;
}

Approximation ResolveMethod(const SimulateOptions& options) {
  const methods::Method& method = *methods::FindMethod(options.method);
  if (options.steps && method.steps.empty()) {
    throw InputError(fmt::format(
        "--steps {} has no effect with --method {}, which takes no steps: choose another method",
        *options.steps, method.name));
  }
  if (options.tolerance && !method.adaptive) {
    throw InputError(
        fmt::format("--tolerance {} has no effect with --method {}: it belongs to --method dopri5",
                    *options.tolerance, method.name));
  }
  const bool is_limit = models::FindLimitLaw(options.model) != nullptr;
  if (is_limit && method.name != "exact") {
    throw InputError(fmt::format("--method {} cannot compute --model {}, which has no branches",
                                 method.name, options.model));
  }
  Approximation approximation{options.model, is_limit ? "" : options.method, {}};
  approximation.resolution.steps = options.steps.value_or(method.default_steps);
  if (options.tolerance) approximation.resolution.tolerance = *options.tolerance;
  return approximation;
}

/// Returns the model of an option that needs the closed form of a law, by the exact method.
const FrictionModel& RequireClosedForm(const SimulateOptions& options, std::string_view option) {
  const FrictionModel* model = models::FindFrictionModel(options.model);
  if (model != nullptr && !model->scaled_by_peak && options.method == "exact") return *model;
  throw InputError(
      fmt::format("{} cannot be used with --model {} --method {}: use --model mindlin, "
                  "mindlin-dahl, jenkins or dahl and --method exact",
                  option, options.model, options.method));
}

/// Returns the law at the reference load, for which σ and the slip force are given.
models::BranchLaw LawOf(const SimulateOptions& options, bool at_reference) {
  LawOptions law = options.law;
  if (at_reference && (law.sigma || law.slip_force)) law.contact.known.normal_load.reset();
  const FrictionModel* model = models::FindFrictionModel(options.model);
  return ResolveLaw(law, options.model, model == nullptr ? std::nullopt : model->shape_exponent);
}

/// Computes the displacement that an imposed force makes.
Simulation FollowForce(const SimulateOptions& options) {
  const FrictionModel& model = RequireClosedForm(options, "--force-path");
  if (options.asymmetry != 0) {
    throw InputError("--asymmetry cannot be used with --force-path: leave one of the two out");
  }
  const models::BranchLaw law = LawOf(options, /*at_reference=*/false);
  Simulation made{.force = ReadImposedForce(options, law)};
  made.time = CountRows(made.force.size());
  made.displacement.resize(made.force.size());
  models::EvaluateDisplacement(model, law, made.force, made.displacement);
  return made;
}

/// Computes the force of a contact whose slip force follows a load, or differs between the
/// directions: Dahl's own law does both.
Simulation FollowLoad(const SimulateOptions& options) {
  const bool is_loaded = !options.load_column.empty();
  const FrictionModel& model =
      RequireClosedForm(options, is_loaded ? "--normal-load-column" : "--asymmetry");
  const std::optional<contact::UncertainValue>& given = options.law.contact.known.normal_load;
  if (is_loaded && !given) {
    throw InputError(
        "--normal-load missing: with --normal-load-column it is the load for which sigma and the "
        "slip force are given");
  }
  const models::BranchLaw law = LawOf(options, is_loaded);
  const double load = is_loaded ? given->value : 1.0;
  Simulation made = MakeMotion(options, law);
  const std::vector<double>& displacement = made.displacement;
  made.force.resize(displacement.size());
  if (model.memory == models::Memory::kNone) {
    const std::vector<double> constant(displacement.size(), load);
    models::EvaluateJointFriction(
        {.law = law, .reference_load = load, .asymmetry = options.asymmetry}, displacement,
        is_loaded ? made.normal_load : constant, made.force);
  } else if (!is_loaded) {
    models::EvaluateForce(
        model, law,
        models::MakeLoadingPath(displacement, loop::FindReversals(displacement, 0.0), model.memory,
                                {.asymmetry = options.asymmetry}),
        displacement, made.force);
  } else if (options.asymmetry != 0) {
    throw InputError(
        "--asymmetry cannot be used with --normal-load-column: leave one of the two out");
  } else {
    models::EvaluateForceUnderLoad({.friction_coefficient = law.slip_force / load,
                                    .reference_load = load,
                                    .reference_stiffness = law.tangential_stiffness,
                                    .shape_exponent = law.shape_exponent},
                                   displacement, made.normal_load, made.force);
  }
  return made;
}

void AddNoise(std::vector<double>& values, double standard_deviation,
              boost::random::mt19937_64& engine) {
  if (standard_deviation == 0) return;
  boost::random::normal_distribution<double> normal(0.0, standard_deviation);
  for (double& value : values) value += normal(engine);
}

Simulation Simulate(const SimulateOptions& options) {
  Validate(options.law.contact);
  RequireNonNegative("--noise-force [N]", options.force_noise);
  RequireNonNegative("--noise-displacement [m]", options.displacement_noise);
  if (!(std::abs(options.asymmetry) < 1)) {
    ThrowInvalid("--asymmetry [-]", options.asymmetry, "must be in (-1, 1)");
  }
  const Approximation approximation = ResolveMethod(options);
  Simulation made;
  if (!options.force_path.empty()) {
    made = FollowForce(options);
  } else if (options.asymmetry != 0 || !options.load_column.empty()) {
    made = FollowLoad(options);
  } else {
    const models::BranchLaw law = LawOf(options, /*at_reference=*/false);
    made = MakeMotion(options, law);
    made.force.resize(made.displacement.size());
    Prepare(approximation, law)({made.displacement, made.envelope}, made.force);
  }
  boost::random::mt19937_64 engine(options.excitation.seed);
  AddNoise(made.force, options.force_noise, engine);
  AddNoise(made.displacement, options.displacement_noise, engine);
  return made;
}

std::string ToCsv(const Simulation& made) {
  std::vector<io::CsvColumn> columns = {
      {"time [s]", made.time}, {"displacement [m]", made.displacement}, {"force [N]", made.force}};
  if (!made.normal_load.empty()) columns.push_back({"normal load [N]", made.normal_load});
  return io::CsvText(columns);
}

std::vector<std::string> SimulatedModels() {
  std::vector<std::string> names;
  for (const FrictionModel& model : models::FrictionModels()) names.emplace_back(model.name);
  for (const models::LimitLaw& law : models::LimitLaws()) names.emplace_back(law.name);
  return names;
}

void AddDriveOptions(CLI::App& command, SimulateOptions& request) {
  const OptionGroup group(command, "Excitation");
  std::vector<std::pair<std::string, models::Waveform>> waveforms;
  for (const auto& name : models::WaveformNames()) {
    waveforms.emplace_back(name, *models::FindWaveform(name));
  }
  group.AddChoice("--waveform", request.excitation.waveform, std::move(waveforms),
                  "imposed displacement");
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
  const Simulation simulation = Simulate(options);
  Say("simulate: warning", DoubtsAbout(options.law.contact), console);
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
  plain.AddShown("--model", options->model, "friction model")->check(OneOf(SimulatedModels()));
  AddLawOptions(command, options->law);
  plain.AddShown(
      "--asymmetry", options->asymmetry,
      "slip forces Tc(1 + A) where the displacement grows and Tc(1 - A) where\nit falls [-]", "A");
  AddDriveOptions(command, *options);

  const OptionGroup noise(command, "Noise");
  noise.Add("--noise-force", options->force_noise, "standard deviation [N]", "N");
  noise.Add("--noise-displacement", options->displacement_noise, "standard deviation [m]", "M");
  noise
      .AddShown("--seed", options->excitation.seed, "seed of the noise and of the random waveform")
      ->check(WholeNumber(0, std::numeric_limits<std::uint64_t>::max()));

  const OptionGroup method(command, "Method");
  method.AddShown("--method", options->method, MethodHelp())
      ->check(OneOf(NamesOf(methods::Methods(), &Method::name)));
  method
      .Add("--steps", options->steps, "substeps a sample, elements of iwan, intervals of table",
           "N")
      ->check(WholeNumber(1, 1'000'000'000));
  method.Add("--tolerance", options->tolerance,
             "largest local error of T/Tc in a step of dopri5 [-], default 1e-6", "E");
  plain.Add("-o,--output", options->output, "CSV file; default standard output", "PATH");
  OnRun(command, [options, &console] { RunSimulate(*options, console); });
}

}  // namespace mindahl::cli
