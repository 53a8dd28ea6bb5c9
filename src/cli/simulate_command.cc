#include <fmt/format.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/drive_options.h"
#include "cli/options.h"
#include "cli/output.h"
#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/output_file.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/joint_friction.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "mindahl/models/variable_load.h"
#include "mindahl/tradeoff/approximation.h"

namespace mindahl::cli {

namespace {

/// Forces of `simulate` in addition to the contact's; docs/theory.md §12 has the equations.
struct AddedForces {
  double viscous = 0.0;            // C [N s/m]
  double speed_exponent = 1.0;     // m [-]
  double inertia = 0.0;            // [kg]
  double slip_slope = 0.0;         // m₁ [-]
  double slip_curvature = 0.0;     // m₂ [-]
  double slip_trend = 0.0;         // K [-]
  double plateau_slope = 0.0;      // [N/m]
  double plateau_curvature = 0.0;  // [N/m²]
  std::optional<double> ripple;    // λ [m]
  double ripple_amplitude = 0.0;   // [N]
  double ripple_phase_up = 0.0;    // φ₊ [rad]
  double ripple_phase_down = 0.0;  // φ₋ [rad]

  bool operator==(const AddedForces&) const = default;
};

/// Central differences over time, one-sided at the ends; 0 where time stands still.
std::vector<double> RateOf(std::span<const double> time, std::span<const double> values) {
  std::vector<double> rate(values.size(), 0.0);
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t before = i == 0 ? 0 : i - 1;
    const std::size_t after = std::min(i + 1, values.size() - 1);
    const double duration = time[after] - time[before];
    if (duration > 0) rate[i] = (values[after] - values[before]) / duration;
  }
  return rate;
}

void RequireForces(const AddedForces& forces) {
  RequirePositive("--speed-exponent [-]", forces.speed_exponent);
  if (forces.ripple) RequirePositive("--ripple [m]", *forces.ripple);
  if (!forces.ripple && forces.ripple_amplitude != 0) {
    throw InputError("--ripple-amplitude needs a period: add --ripple PERIOD");
  }
  if (!(std::abs(forces.slip_slope) + std::abs(forces.slip_curvature) +
            std::abs(forces.slip_trend) <
        1)) {
    throw InputError(
        "--slip-slope, --slip-curvature and --slip-trend: together they must be below 1, for the "
        "slip force to be positive over the whole motion");
  }
}

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

/// Adds the forces to those of the contact along a motion. Velocities and accelerations are central
/// differences, as a fit takes them; positions count from the middle of the motion, in its half
/// range where they have no unit.
/// @throws InvalidArgument for a speed exponent or a period that is not > 0, an amplitude without a
///   period, or a slip force that would not be positive over the motion
void AddForces(const AddedForces& forces, std::span<const double> time,
               std::span<const double> displacement, std::span<double> force) {
  RequireForces(forces);
  if (forces == AddedForces{}) return;
  const auto [lowest, highest] = std::ranges::minmax(displacement);
  const double middle = lowest + (highest - lowest) / 2;
  const double half = (highest - lowest) / 2;
  const std::vector<double> velocity = RateOf(time, displacement);
  const std::vector<double> acceleration = RateOf(time, velocity);
  const double duration = time.empty() ? 0.0 : time.back() - time.front();
  double direction = 1.0;
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (i > 0 && displacement[i] != displacement[i - 1]) {
      direction = displacement[i] > displacement[i - 1] ? 1.0 : -1.0;
    }
    const double from_middle = displacement[i] - middle;
    const double position = half > 0 ? from_middle / half : 0.0;
    const double elapsed = time[i] - time.front();
    const double tau = duration > 0 ? 2 * elapsed / duration - 1 : 0.0;
    force[i] *= 1 + position * (forces.slip_slope + forces.slip_curvature * position) +
                forces.slip_trend * tau;
    force[i] += forces.inertia * acceleration[i] +
                from_middle * (forces.plateau_slope + forces.plateau_curvature * from_middle);
    if (forces.viscous != 0) {
      force[i] +=
          forces.viscous *
          std::copysign(std::pow(std::abs(velocity[i]), forces.speed_exponent), velocity[i]);
    }
    if (forces.ripple) {
      const double phase = direction > 0 ? forces.ripple_phase_up : forces.ripple_phase_down;
      force[i] += forces.ripple_amplitude *
                  std::cos(2 * std::numbers::pi * from_middle / *forces.ripple + phase);
    }
  }
}

using methods::Method;
using models::FrictionModel;
using tradeoff::Approximation;

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
      "--normal-load missing: with --normal-load-column it is the load for which sigma and the "
      "slip force are given");
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
        fmt::format("--normal-load-column cannot be used with --model {} --method {}: use --model "
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
        fmt::format("--force-path cannot be used with --model {} --method {}: use --model mindlin, "
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
    throw InputError(
        fmt::format("{} cannot be used with --model {} --method {}: use --model mindlin, "
                    "mindlin-dahl, jenkins or dahl and --method exact",
                    option, options.model, options.method));
  }
  if (!options.drive.force_path.empty() || (!options.drive.load_column.empty() && !is_joint)) {
    throw InputError(
        fmt::format("{} cannot be used with {}: leave one of the two out", option,
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
    throw InputError("--asymmetry cannot be used with --backlash: leave one of the two out");
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
        "--force-path imposes the whole force: leave out --viscous and other additional forces");
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
  CLI::App* command =
      app.add_subcommand("simulate",
                         "Computes the tangential force along an imposed displacement, or the\n"
                         "displacement under an imposed force (--force-path), exactly for any\n"
                         "history. The contact is unloaded at displacement zero; a first row\n"
                         "that is not zero is the first loading step. Writes time [s],\n"
                         "displacement [m], force [N].");
  AddExamples(*command, app,
              {"mindahl simulate --sigma 4e7 --slip-force 40 --lambda 1.2 --cycles 2 -o loop.csv",
               "mindahl simulate --model dahl --sigma 4e7 --alpha 1 --slip-force 40 --path "
               "path.csv --path-unit um"});
  command->add_option("--model", options->model, "friction model")
      ->capture_default_str()
      ->check(OneOf(ModelNames()));
  AddLawOptions(*command, options->law);
  command
      ->add_option(
          "--asymmetry", options->asymmetry,
          "slip forces Tc(1 + A) where the displacement grows and Tc(1 - A) where\nit falls [-]")
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

  const OptionGroup noise(*command, "Noise");
  noise.Add("--noise-force", options->force_noise, "standard deviation [N]", "N");
  noise.Add("--noise-displacement", options->displacement_noise, "standard deviation [m]", "M");
  noise.AddShown("--seed", options->drive.seed, "seed of the noise and of the random waveform")
      ->check(WholeNumber(0, std::numeric_limits<std::uint64_t>::max()));

  const OptionGroup method(*command, "Method");
  method.AddShown("--method", options->method, MethodHelp())->check(OneOf(MethodNames()));
  method
      .Add("--steps", options->steps, "substeps a sample, elements of iwan, intervals of table",
           "N")
      ->check(WholeNumber(1, 1'000'000'000));
  method.Add("--tolerance", options->tolerance,
             "largest local error of T/Tc in a step of dopri5 [-], default 1e-6", "E");
  command->add_option("-o,--output", options->output, "CSV file; default standard output")
      ->type_name("FILE");
  command->callback([options, &console] { RunSimulate(*options, console); });
}

}  // namespace mindahl::cli
