#include "mindahl/convert/conversion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "convert/jenkins_refit.h"
#include "convert/refit.h"
#include "mindahl/core/error.h"
#include "mindahl/models/steady_loop.h"

namespace mindahl::convert {

using models::Memory;

namespace {

constexpr std::array kTargets = {
    TargetRow{Target::kMasing, "masing", "Masing's law (mindlin-dahl)"},
    TargetRow{Target::kDahl, "dahl", "Dahl's own law"},
    TargetRow{Target::kLuGre, "lugre", "LuGre without rate: Dahl's law of α = 1"},
    TargetRow{Target::kBoucWen, "bouc-wen", "Bouc's and Wen's law"},
    TargetRow{Target::kIwan, "iwan", "Jenkins elements in parallel"},
    TargetRow{Target::kLammps, "lammps", "a tangential spring with Coulomb's limit"},
    TargetRow{Target::kLiggghts, "liggghts", "a tangential spring with Coulomb's limit"},
    TargetRow{Target::kYade, "yade", "a tangential spring with Coulomb's limit"},
    TargetRow{Target::kMujoco, "mujoco", "MuJoCo's LuGre without rate: Dahl's law of α = 1"},
    TargetRow{Target::kMujocoJoint, "mujoco-joint", "Coulomb's friction of a joint"},
    TargetRow{Target::kUrdf, "urdf", "Coulomb's friction of a joint"},
    TargetRow{Target::kSdf, "sdf", "Coulomb's friction of a joint"},
};

const models::FrictionModel& Dahl() { return *models::FindFrictionModel("dahl"); }
const models::FrictionModel& Masing() { return *models::FindFrictionModel("mindlin-dahl"); }

void RequireConversion(const ModelLaw& contact, const ConversionOptions& options) {
  if (contact.model == nullptr || contact.model->scaled_by_peak) {
    throw InvalidArgument("the contact must follow Masing's law or Dahl's own");
  }
  models::Validate(contact.law);
  RequirePositive("amplitude [m]", options.amplitude);
  if (!(options.tolerance > 0 && options.tolerance < 1)) {
    ThrowInvalid("tolerance [-]", options.tolerance, "must be in (0, 1)");
  }
  if (options.elements < 1) ThrowInvalid("elements [-]", 0, "must be >= 1");
  if (!(options.beta > 0 && options.beta <= 1)) {
    ThrowInvalid("Bouc-Wen beta [-]", options.beta, "must be in (0, 1]");
  }
  if (!options.range) return;
  RequirePositive("lower end of the range [m]", options.range->lower);
  RequirePositive("upper end of the range [m]", options.range->upper);
  if (!(options.range->lower <= options.amplitude && options.amplitude <= options.range->upper)) {
    ThrowInvalid("amplitude [m]", options.amplitude, "must lie in the range");
  }
}

/// Returns the amplitudes that are fitted and compared, evenly in their logarithm, X among them.
std::vector<double> AmplitudesOf(const ConversionOptions& options) {
  std::vector<double> amplitudes = {options.amplitude};
  if (!options.range || options.range->lower == options.range->upper) return amplitudes;
  constexpr int kIntervals = 8;
  const double ratio = options.range->upper / options.range->lower;
  for (int i = 0; i <= kIntervals; ++i) {
    amplitudes.push_back(options.range->lower *
                         std::pow(ratio, static_cast<double>(i) / kIntervals));
  }
  return amplitudes;
}

/// Returns Coulomb's friction: the mean square difference of force, each amplitude over its own T*,
/// is least for the weighted mean of the strokes' mean forces.
ModelLaw CoulombOf(const ModelLaw& contact, const std::vector<double>& amplitudes) {
  constexpr double kElastic = 1e-13;  // of the smallest amplitude: what slips later is rounding
  double total = 0.0;
  double weights = 0.0;
  for (const double amplitude : amplitudes) {
    const double peak = models::SteadyPeakForce(*contact.model, contact.law, amplitude);
    total += LoopEnergy(contact, amplitude) / (4 * amplitude) / (peak * peak);
    weights += 1 / (peak * peak);
  }
  const double friction = total / weights;
  return {&Masing(), {friction / (kElastic * std::ranges::min(amplitudes)), 0.0, friction}};
}

SteadyLaw LawOf(const ModelLaw& contact, Target target, const ConversionOptions& options,
                const std::vector<double>& amplitudes) {
  const bool is_masing = contact.model->memory == Memory::kReturnPoint;
  const auto masing = [&] {
    return is_masing ? contact.law : models::MasingEquivalent(contact.law, options.amplitude);
  };
  switch (target) {
    case Target::kMasing:
      return ModelLaw{&Masing(), masing()};
    case Target::kDahl:
      return ModelLaw{&Dahl(), is_masing ? models::DahlEquivalent(contact.law, options.amplitude)
                                         : contact.law};
    case Target::kIwan:
      return RefitElements(contact, masing(), amplitudes, options.elements);
    case Target::kBoucWen:
      return ReferenceLoops(contact, amplitudes).FitBoucWen(options.beta);
    case Target::kLuGre:
    case Target::kMujoco:
      return ReferenceLoops(contact, amplitudes).Fit(Dahl(), 1.0);
    case Target::kLammps:
    case Target::kLiggghts:
    case Target::kYade:
      return ReferenceLoops(contact, amplitudes).Fit(Masing(), 0.0);
    case Target::kMujocoJoint:
    case Target::kUrdf:
    case Target::kSdf:
      return CoulombOf(contact, amplitudes);
  }
  throw InvalidArgument("no such target");
}

/// Finds where the error passes the tolerance, from X on in steps of a factor that grows or falls.
template <typename IsWithin>
double EdgeOf(const IsWithin& is_within, double amplitude, double factor) {
  constexpr int kSteps = 160;
  constexpr int kHalvings = 30;
  double inside = amplitude;
  for (int i = 0; i < kSteps; ++i) {
    double outside = inside * factor;
    if (is_within(outside)) {
      inside = outside;
      continue;
    }
    for (int j = 0; j < kHalvings; ++j) {
      const double middle = std::sqrt(inside * outside);
      (is_within(middle) ? inside : outside) = middle;
    }
    return inside;
  }
  return inside;
}

}  // namespace

std::span<const TargetRow> Targets() { return kTargets; }

bool IsDiscreteElementCode(Target target) {
  return target == Target::kLammps || target == Target::kLiggghts || target == Target::kYade;
}

bool IsJoint(Target target) {
  return target == Target::kMujoco || target == Target::kMujocoJoint || target == Target::kUrdf ||
         target == Target::kSdf;
}

Conversion Convert(const ModelLaw& contact, Target target, const ConversionOptions& options) {
  RequireConversion(contact, options);
  const std::vector<double> amplitudes = AmplitudesOf(options);
  Conversion conversion;
  conversion.law = LawOf(contact, target, options, amplitudes);
  conversion.at_amplitude = CompareLoops(conversion.law, contact, options.amplitude);
  for (const double amplitude : amplitudes) {
    const LoopError error = CompareLoops(conversion.law, contact, amplitude);
    conversion.largest.force = std::max(conversion.largest.force, error.force);
    conversion.largest.energy = std::max(conversion.largest.energy, std::abs(error.energy));
  }
  const auto is_within = [&](double amplitude) {
    const LoopError error = CompareLoops(conversion.law, contact, amplitude);
    return error.force <= options.tolerance && std::abs(error.energy) <= options.tolerance;
  };
  if (is_within(options.amplitude)) {
    const double step = std::pow(10.0, 1.0 / 40);  // 160 of them: four decades
    conversion.within = {EdgeOf(is_within, options.amplitude, 1 / step),
                         EdgeOf(is_within, options.amplitude, step)};
  }
  return conversion;
}

}  // namespace mindahl::convert
