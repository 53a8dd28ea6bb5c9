#include <fmt/format.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/added_forces.h"
#include "cli/commands.h"
#include "cli/contact_options.h"
#include "cli/drive_options.h"
#include "cli/examples.h"
#include "cli/one_of.h"
#include "cli/output_path.h"
#include "cli/whole_number.h"
#include "mindahl/core/error.h"
#include "mindahl/io/csv_writer.h"
#include "mindahl/io/output_file.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/methods/method.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/imposed_force.h"
#include "mindahl/models/joint_friction.h"
#include "mindahl/models/limit_law.h"
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
  DriveOptions drive;
  double asymmetry = 0.0;
  double backlash = 0.0;  // [m]
  AddedForces forces;
  double force_noise = 0.0;
  double displacement_noise = 0.0;
  std::string method = "exact";
  std::optional<std::size_t> steps;
  std::optional<double> tolerance;
  std::string output;
};

std::vector<std::string> ModelNames() {
  std::vector<std::string> names;
  for (const FrictionModel& model : models::FrictionModels()) names.emplace_back(model.name);
  for (const models::LimitLaw& law : models::LimitLaws()) names.emplace_back(law.name);
  return names;
}

std::vector<std::string> MethodNames() {
  std::vector<std::string> names;
  for (const Method& method : methods::Methods()) names.emplace_back(method.name);
  return names;
}

std::string MethodHelp() {
  std::string help = "how the response is computed; --steps counts, by default";
  for (const Method& method : methods::Methods()) {
    help += fmt::format("\n{}: {}", method.name, method.title);
    if (!method.steps.empty()) help += fmt::format(" ({} {})", method.default_steps, method.steps);
  }
  return help;
}

/// α where the model prescribes it.
std::optional<double> PrescribedExponent(const std::string& model) {
  const FrictionModel* found = models::FindFrictionModel(model);
  return found == nullptr ? std::nullopt : found->shape_exponent;
}

Approximation ResolveMethod(const SimulateOptions& options) {
  const Method& method = *methods::FindMethod(options.method);
  if (options.steps && method.steps.empty()) {
    throw InputError(fmt::format(
        "--steps {} says nothing to --method {}, which makes none: choose another method",
        *options.steps, method.name));
  }
  if (options.tolerance && !method.adaptive) {
    throw InputError(
        fmt::format("--tolerance {} says nothing to --method {}: it belongs to --method dopri5",
                    *options.tolerance, method.name));
  }
  const bool is_limit = models::FindLimitLaw(options.model) != nullptr;
  if (is_limit && method.name != "exact") {
    throw InputError(
        fmt::format("--method {} does not serve --model {}: it has no branches to follow",
                    method.name, options.model));
  }
  Approximation approximation{options.model, is_limit ? "" : options.method, {}};
  approximation.resolution.steps = options.steps.value_or(method.default_steps);
  if (options.tolerance) approximation.resolution.tolerance = *options.tolerance;
  return approximation;
}

/// True of Dahl's own law, whose force follows a load and differs between the directions.
bool IsJoint(const SimulateOptions& options) {
  const FrictionModel* model = models::FindFrictionModel(options.model);
  return model != nullptr && model->memory == models::Memory::kNone && !model->scaled_by_peak &&
         options.method == "exact";
}

/// Returns the load at which sigma and the slip force are those given.
double ReferenceLoad(const SimulateOptions& options) {
  const std::optional<double> load = options.law.contact.known.normal_load;
  if (load) return *load;
  throw InputError(
      "--normal-load missing: with --normal-load-column it is the load at which sigma and the "
      "slip force are those given");
}

LawOptions AtReference(const SimulateOptions& options) {
  LawOptions at_reference = options.law;
  if (options.law.sigma || options.law.slip_force) at_reference.contact.known.normal_load.reset();
  return at_reference;
}

/// Computes the force of a joint along a motion, under its load where that is given.
void FollowJoint(const SimulateOptions& options, ImposedMotion& motion,
                 std::vector<double>& force) {
  models::JointFriction joint{
      .law = ResolveLaw(AtReference(options), options.model, PrescribedExponent(options.model)),
      .asymmetry = options.asymmetry};
  if (!options.drive.load_column.empty()) joint.reference_load = ReferenceLoad(options);
  motion = MakeMotion(options.drive, joint.law);
  force.resize(motion.displacement.size());
  const std::vector<double> constant(force.size(), joint.reference_load);
  models::EvaluateJointFriction(joint, motion.displacement,
                                motion.normal_load.empty() ? constant : motion.normal_load, force);
}

/// Returns the law under a varying load: σ and Tc are those at the reference load.
models::LoadDependentLaw ResolveLoadedLaw(const SimulateOptions& options) {
  const FrictionModel* model = models::FindFrictionModel(options.model);
  if (model == nullptr || model->memory != models::Memory::kReturnPoint ||
      options.method != "exact") {
    throw InputError(
        fmt::format("--normal-load-column does not serve --model {} --method {}: use --model "
                    "mindlin, mindlin-dahl, jenkins or dahl and --method exact",
                    options.model, options.method));
  }
  const double load = ReferenceLoad(options);
  const models::BranchLaw law =
      ResolveLaw(AtReference(options), options.model, model->shape_exponent);
  return {.friction_coefficient = law.slip_force / load,
          .reference_load = load,
          .reference_stiffness = law.tangential_stiffness,
          .shape_exponent = law.shape_exponent};
}

/// The displacement that a force imposed by a file makes.
ImposedMotion FollowForce(const SimulateOptions& options, std::vector<double>& force) {
  const FrictionModel* model = models::FindFrictionModel(options.model);
  if (model == nullptr || model->scaled_by_peak || options.method != "exact") {
    throw InputError(
        fmt::format("--force-path does not serve --model {} --method {}: use --model mindlin, "
                    "mindlin-dahl, jenkins or dahl and --method exact",
                    options.model, options.method));
  }
  const models::BranchLaw law = ResolveLaw(options.law, options.model, model->shape_exponent);
  ImposedForce imposed = ReadImposedForce(options.drive, law);
  ImposedMotion motion{.time = std::move(imposed.time),
                       .displacement = std::vector<double>(imposed.force.size()),
                       .envelope = {},
                       .normal_load = {}};
  force = std::move(imposed.force);
  models::EvaluateDisplacement(*model, law, force, motion.displacement);
  return motion;
}

/// The force of a contact whose slip forces differ in the two directions of the motion.
void FollowAsymmetry(const SimulateOptions& options, const models::BranchLaw& law,
                     std::span<const double> displacement, std::span<double> force) {
  const FrictionModel& model = *models::FindFrictionModel(options.model);
  const models::LoadingPath path =
      models::MakeLoadingPath(displacement, loop::FindReversals(displacement, 0.0), model.memory,
                              {.asymmetry = options.asymmetry});
  models::EvaluateForce(model, law, path, displacement, force);
}

/// The force of a contact behind a gap.
void FollowBehindGap(const SimulateOptions& options, const models::BranchLaw& law,
                     std::span<const double> displacement, std::span<double> force) {
  models::ContactBehindGap contact({*models::FindFrictionModel(options.model), law},
                                   options.backlash);
  std::ranges::transform(displacement, force.begin(), [&](double x) { return contact.Move(x); });
}

/// Requires what an asymmetry and a gap need: the closed form of a law, under one load.
void RequireExactLaw(const SimulateOptions& options, std::string_view option, bool needs_memory) {
  const FrictionModel* model = models::FindFrictionModel(options.model);
  const bool is_joint = needs_memory && IsJoint(options);
  const bool serves = model != nullptr && !model->scaled_by_peak &&
                      (!needs_memory || model->memory == models::Memory::kReturnPoint || is_joint);
  if (!serves || options.method != "exact") {
    throw InputError(fmt::format(
        "{} does not serve --model {} --method {}: use --model mindlin, mindlin-dahl, jenkins or "
        "dahl and --method exact",
        option, options.model, options.method));
  }
  if (!options.drive.force_path.empty() || (!options.drive.load_column.empty() && !is_joint)) {
    throw InputError(
        fmt::format("{} does not serve {}: leave one of the two out", option,
                    options.drive.force_path.empty() ? "--normal-load-column" : "--force-path"));
  }
}

void RequireAsymmetryAndGap(const SimulateOptions& options) {
  if (options.asymmetry != 0) {
    if (!(std::abs(options.asymmetry) < 1)) {
      ThrowInvalid("--asymmetry [-]", options.asymmetry, "must be in (-1, 1)");
    }
    RequireExactLaw(options, "--asymmetry", /*needs_memory=*/true);
  }
  if (options.backlash == 0) return;
  RequireNonNegative("--backlash [m]", options.backlash);
  RequireExactLaw(options, "--backlash", /*needs_memory=*/false);
  if (options.asymmetry != 0) {
    throw InputError("--asymmetry does not serve --backlash: leave one of the two out");
  }
}

void AddNoise(std::vector<double>& values, double standard_deviation,
              boost::random::mt19937_64& engine) {
  if (standard_deviation == 0) return;
  boost::random::normal_distribution<double> normal(0.0, standard_deviation);
  for (double& value : values) value += normal(engine);
}

void RunSimulate(const SimulateOptions& options, Console& console) {
  Validate(options.law.contact);
  std::vector<std::string> inputs = console.inputs;
  inputs.push_back(options.drive.path);
  inputs.push_back(options.drive.force_path);
  RequireOutputPaths({{"--output", options.output, /*dash_is_stdout=*/true}}, inputs);
  RequireNonNegative("--noise-force [N]", options.force_noise);
  RequireNonNegative("--noise-displacement [m]", options.displacement_noise);
  RequireAsymmetryAndGap(options);
  const Approximation approximation = ResolveMethod(options);
  ImposedMotion motion;
  std::vector<double> force;
  if (!options.drive.force_path.empty()) {
    motion = FollowForce(options, force);
  } else if (IsJoint(options) && (options.asymmetry != 0 || !options.drive.load_column.empty())) {
    FollowJoint(options, motion, force);
  } else if (options.drive.load_column.empty()) {
    const models::BranchLaw law =
        ResolveLaw(options.law, options.model, PrescribedExponent(options.model));
    motion = MakeMotion(options.drive, law);
    force.resize(motion.displacement.size());
    if (options.asymmetry != 0) {
      FollowAsymmetry(options, law, motion.displacement, force);
    } else if (options.backlash != 0) {
      FollowBehindGap(options, law, motion.displacement, force);
    } else {
      Prepare(approximation, law)(motion.drive(), force);
    }
  } else {
    const models::LoadDependentLaw law = ResolveLoadedLaw(options);
    motion = MakeMotion(options.drive, models::BranchLawAtLoad(law, law.reference_load));
    force.resize(motion.displacement.size());
    models::EvaluateForceUnderLoad(law, motion.displacement, motion.normal_load, force);
  }

  if (!options.drive.force_path.empty() && options.forces != AddedForces{}) {
    throw InputError(
        "--force-path imposes the whole force: leave out --viscous and whatever else adds to it");
  }
  AddForces(options.forces, motion.time, motion.displacement, force);
  WarnOfDoubts(options.law.contact, "simulate", console);
  boost::random::mt19937_64 engine(options.drive.seed);
  AddNoise(force, options.force_noise, engine);
  AddNoise(motion.displacement, options.displacement_noise, engine);
  std::vector<io::CsvColumn> columns = {
      {"time [s]", motion.time}, {"displacement [m]", motion.displacement}, {"force [N]", force}};
  if (!motion.normal_load.empty()) columns.push_back({"normal load [N]", motion.normal_load});
  const std::string text = io::CsvText(columns);
  if (options.output.empty() || options.output == "-") {
    console.out << text;
  } else {
    io::WriteFileAtomically(options.output, text);
  }
}

}  // namespace

void AddSimulateCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<SimulateOptions>();
  CLI::App* command = app.add_subcommand(
      "simulate",
      "Tangential force of a model along an imposed displacement, or the displacement under an\n"
      "imposed force (--force-path), exact for any history.\n"
      "The contact is unloaded at displacement zero; a first row that is not zero is the first\n"
      "loading step. Writes time [s], displacement [m], force [N].");
  AddExamples(*command, app,
              {"mindahl simulate --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 2 -o loop.csv",
               "mindahl simulate --model dahl --sigma 4e7 --alpha 1 --slip-force 40 --path "
               "path.csv --path-unit um"});
  command->add_option("--model", options->model, "friction model")
      ->capture_default_str()
      ->check(OneOf(ModelNames()));
  AddLawOptions(*command, options->law);
  command
      ->add_option("--asymmetry", options->asymmetry,
                   "slip forces Tc(1 + A) where the motion is in the direction of positive\n"
                   "displacement and Tc(1 - A) where it is not [-]")
      ->type_name("A")
      ->capture_default_str();
  command
      ->add_option("--backlash", options->backlash,
                   "width of a gap before the contact that is crossed at zero force [m]")
      ->type_name("G")
      ->capture_default_str();
  AddAddedForceOptions(*command, options->forces);
  AddDriveOptions(*command, options->drive);
  AddLoadColumnOptions(*command, options->drive);
  AddForcePathOptions(*command, options->drive);

  const std::string noise = "Noise";
  command->add_option("--noise-force", options->force_noise, "standard deviation [N]")
      ->type_name("N")
      ->group(noise);
  command->add_option("--noise-displacement", options->displacement_noise, "standard deviation [m]")
      ->type_name("M")
      ->group(noise);
  command->add_option("--seed", options->drive.seed, "of the noise and of the random waveform")
      ->capture_default_str()
      ->check(WholeNumber(0, std::numeric_limits<std::uint64_t>::max()))
      ->group(noise);

  const std::string method = "Method";
  command->add_option("--method", options->method, MethodHelp())
      ->capture_default_str()
      ->check(OneOf(MethodNames()))
      ->group(method);
  command
      ->add_option("--steps", options->steps,
                   "substeps a sample, elements of iwan, intervals of table")
      ->type_name("N")
      ->check(WholeNumber(1, 1'000'000'000))
      ->group(method);
  AddOptional(*command, "--tolerance", options->tolerance,
              "of dopri5: largest local error of T/Tc a step [-], default 1e-6", "E")
      ->group(method);
  command->add_option("-o,--output", options->output, "CSV file; default standard output")
      ->type_name("FILE");
  command->callback([options, &console] { RunSimulate(*options, console); });
}

}  // namespace mindahl::cli
