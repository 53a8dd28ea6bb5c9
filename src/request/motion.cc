#include "mindahl/request/motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <boost/random/mersenne_twister.hpp>
#include <boost/random/normal_distribution.hpp>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <numeric>
#include <span>
#include <string_view>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"
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

namespace mindahl::request {
namespace {

/// Time counts rows.
std::vector<double> CountRows(std::size_t rows) {
  std::vector<double> time(rows);
  std::iota(time.begin(), time.end(), 0.0);
  return time;
}

/// The unit as the text of a column has it.
std::string UnitAlone(const std::string& unit) {
  return unit.empty() ? "" : fmt::format(" [{}]", unit);
}

ImposedMotion MotionFromFile(const DriveRequest& request) {
  ImposedMotion motion;
  const io::CsvTable table = io::ReadCsvTable(request.path);
  motion.displacement =
      io::ImposedColumn(table, io::Imposed::kDisplacement, UnitAlone(request.path_unit));
  if (!request.load_column.empty()) {
    motion.normal_load = io::ImposedColumn(table, io::Imposed::kNormalLoad,
                                           request.load_column + UnitAlone(request.load_unit));
  }
  motion.time = CountRows(motion.displacement.size());
  return motion;
}

ImposedMotion MotionFromWaveform(const DriveRequest& request, const models::BranchLaw& law) {
  models::ExcitationOptions excitation = request.excitation;
  excitation.waveform = *models::FindWaveform(request.waveform);
  excitation.seed = request.seed;
  if (request.lambda.has_value() == request.amplitude.has_value()) {
    throw InputError("--lambda or --amplitude, one of the two, must be given (or --path)");
  }
  if (request.lambda) {
    RequirePositive("--lambda [-]", *request.lambda);
    const double gross_slip = GrossSlipDisplacement(law);
    if (!std::isfinite(gross_slip)) {
      throw InputError(fmt::format(
          "--lambda needs a finite gross-slip displacement, which does not exist for alpha = {} >= "
          "1: give --amplitude",
          law.shape_exponent));
    }
    excitation.amplitude = *request.lambda * gross_slip;
  } else {
    RequirePositive("--amplitude [m]", *request.amplitude);
    excitation.amplitude = *request.amplitude;
  }
  models::Excitation made = models::MakeExcitation(excitation);
  ImposedMotion motion{std::move(made.time), std::move(made.displacement)};
  if (excitation.waveform == models::Waveform::kGrowingSine)
    motion.envelope = std::move(made.envelope);
  return motion;
}

}  // namespace

ImposedForce ReadImposedForce(const DriveRequest& request, const models::BranchLaw& law) {
  const io::CsvTable table = io::ReadCsvTable(request.force_path);
  std::vector<double> force =
      io::ImposedColumn(table, io::Imposed::kForce, UnitAlone(request.force_path_unit));
  for (std::size_t i = 0; i < force.size(); ++i) {
    if (std::abs(force[i]) < law.slip_force) continue;
    throw InputError(fmt::format(
        "{}:{}: a force of {} N is not within the slip force, {} N, at which the contact slides "
        "any distance: keep forces below it, or impose the displacement with --path",
        request.force_path, table.lines[i], force[i], law.slip_force));
  }
  return {CountRows(force.size()), std::move(force)};
}

ImposedMotion MakeMotion(const DriveRequest& request, const models::BranchLaw& law) {
  return request.path.empty() ? MotionFromWaveform(request, law) : MotionFromFile(request);
}

using methods::Method;
using models::FrictionModel;
using tradeoff::Approximation;

namespace {

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
  RequireFinite("--viscous [N s/m]", forces.viscous);
  RequirePositive("--speed-exponent [-]", forces.speed_exponent);
  RequireFinite("--inertia [kg]", forces.inertia);
  RequireFinite("--plateau-slope [N/m]", forces.plateau_slope);
  RequireFinite("--plateau-curvature [N/m²]", forces.plateau_curvature);
  RequireFinite("--ripple-amplitude [N]", forces.ripple_amplitude);
  RequireFinite("--ripple-phase-up [rad]", forces.ripple_phase_up);
  RequireFinite("--ripple-phase-down [rad]", forces.ripple_phase_down);
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

/// Adds the forces to those of the contact along a motion. Velocities and accelerations are central
/// differences, as a fit takes them; positions count from the middle of the motion, in its half
/// range where they have no unit.
/// @throws InvalidArgument for a speed exponent or a period that is not > 0, an amplitude without a
///   period, a slip force that would not be positive over the motion, or a force that is not finite
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
    if (!std::isfinite(force[i])) {
      ThrowInvalid(fmt::format("force [N] of row {}", i + 1), force[i], "must be finite");
    }
  }
}

std::optional<double> PrescribedExponent(const std::string& model) {
  const FrictionModel* found = models::FindFrictionModel(model);
  return found == nullptr ? std::nullopt : found->shape_exponent;
}

Approximation ResolveMethod(const SimulationRequest& options) {
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
bool IsJoint(const SimulationRequest& options) {
  const FrictionModel* model = models::FindFrictionModel(options.model);
  return model != nullptr && model->memory == models::Memory::kNone && !model->scaled_by_peak &&
         options.method == "exact";
}

/// Refuses an option that needs the closed form of a law.
[[noreturn]] void RefuseLaw(const SimulationRequest& options, std::string_view option) {
  throw InputError(
      fmt::format("{} cannot be used with --model {} --method {}: use --model mindlin, "
                  "mindlin-dahl, jenkins or dahl and --method exact",
                  option, options.model, options.method));
}

/// Returns the load at which sigma and the slip force are those given.
double ReferenceLoad(const SimulationRequest& options) {
  const std::optional<double> load = options.law.contact.known.normal_load;
  if (load) return *load;
  throw InputError(
      "--normal-load missing: with --normal-load-column it is the load for which sigma and the "
      "slip force are given");
}

LawRequest AtReference(const SimulationRequest& options) {
  LawRequest at_reference = options.law;
  if (options.law.sigma || options.law.slip_force) at_reference.contact.known.normal_load.reset();
  return at_reference;
}

/// Computes the force of a joint along a motion, under its load where that is given.
void FollowJoint(const SimulationRequest& options, ImposedMotion& motion,
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
models::LoadDependentLaw ResolveLoadedLaw(const SimulationRequest& options) {
  const FrictionModel* model = models::FindFrictionModel(options.model);
  if (model == nullptr || model->memory != models::Memory::kReturnPoint ||
      options.method != "exact") {
    RefuseLaw(options, "--normal-load-column");
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
ImposedMotion FollowForce(const SimulationRequest& options, std::vector<double>& force) {
  const FrictionModel* model = models::FindFrictionModel(options.model);
  if (model == nullptr || model->scaled_by_peak || options.method != "exact") {
    RefuseLaw(options, "--force-path");
  }
  const models::BranchLaw law = ResolveLaw(options.law, options.model, model->shape_exponent);
  ImposedForce imposed = ReadImposedForce(options.drive, law);
  ImposedMotion motion{.time = std::move(imposed.time),
                       .displacement = std::vector<double>(imposed.force.size())};
  force = std::move(imposed.force);
  models::EvaluateDisplacement(*model, law, force, motion.displacement);
  return motion;
}

/// The force of a contact whose slip forces differ in the two directions of the motion.
void FollowAsymmetry(const SimulationRequest& options, const models::BranchLaw& law,
                     std::span<const double> displacement, std::span<double> force) {
  const FrictionModel& model = *models::FindFrictionModel(options.model);
  const models::LoadingPath path =
      models::MakeLoadingPath(displacement, loop::FindReversals(displacement, 0.0), model.memory,
                              {.asymmetry = options.asymmetry});
  models::EvaluateForce(model, law, path, displacement, force);
}

/// Requires what an asymmetry and a gap need: the closed form of a law, under one load.
void RequireExactLaw(const SimulationRequest& options, std::string_view option, bool needs_memory) {
  const FrictionModel* model = models::FindFrictionModel(options.model);
  const bool is_joint = needs_memory && IsJoint(options);
  const bool serves = model != nullptr && !model->scaled_by_peak &&
                      (!needs_memory || model->memory == models::Memory::kReturnPoint || is_joint);
  if (!serves || options.method != "exact") RefuseLaw(options, option);
  if (!options.drive.force_path.empty() || (!options.drive.load_column.empty() && !is_joint)) {
    throw InputError(
        fmt::format("{} cannot be used with {}: leave one of the two out", option,
                    options.drive.force_path.empty() ? "--normal-load-column" : "--force-path"));
  }
}

void RequireAsymmetryAndGap(const SimulationRequest& options) {
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

void RequireSimulation(const SimulationRequest& request) {
  Validate(request.law.contact);
  RequireNonNegative("--noise-force [N]", request.force_noise);
  RequireNonNegative("--noise-displacement [m]", request.displacement_noise);
  RequireAsymmetryAndGap(request);
}

}  // namespace

Simulation Simulate(const SimulationRequest& options) {
  RequireSimulation(options);
  const Approximation approximation = ResolveMethod(options);
  Simulation made;
  auto& [motion, force] = made;
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
      models::ContactBehindGap contact({*models::FindFrictionModel(options.model), law},
                                       options.backlash);
      std::ranges::transform(motion.displacement, force.begin(),
                             [&](double x) { return contact.Move(x); });
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
  boost::random::mt19937_64 engine(options.drive.seed);
  AddNoise(force, options.force_noise, engine);
  AddNoise(motion.displacement, options.displacement_noise, engine);
  return made;
}

std::string ToCsv(const Simulation& simulation) {
  const auto& [motion, force] = simulation;
  std::vector<io::CsvColumn> columns = {
      {"time [s]", motion.time}, {"displacement [m]", motion.displacement}, {"force [N]", force}};
  if (!motion.normal_load.empty()) columns.push_back({"normal load [N]", motion.normal_load});
  return io::CsvText(columns);
}

std::vector<std::string> SimulatedModels() {
  std::vector<std::string> names;
  for (const FrictionModel& model : models::FrictionModels()) names.emplace_back(model.name);
  for (const models::LimitLaw& law : models::LimitLaws()) names.emplace_back(law.name);
  return names;
}

}  // namespace mindahl::request
