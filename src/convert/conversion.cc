#include "mindahl/convert/conversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>
#include <vector>

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

using methods::IwanElements;

namespace {

constexpr double kLargestImpedance = 0.9999;  // mjMAXIMP: least creep of MuJoCo's constraints
constexpr double kNoDamping = 1e15;           // [Ω], a resistance: damping of 1e-15 N s/m

/// Returns γ and β of dz/dx = A − |z|ⁿ(γ + β·sgn(z·ẋ)) with A = 1 and z = T/k: over z*ⁿ, z* = Tc/k.
double PerTravel(const BoucWenLaw& law, double share) {
  return share * std::pow(law.stiffness / law.slip_force, law.exponent);
}

/// Returns what a discrete-element code reads of a spring with Coulomb's limit; what is normal to
/// the contact is the user's.
std::vector<std::string> LinesOfSpring(const models::BranchLaw& law, Target target,
                                       const NormalContact& contact) {
  if (!contact.normal_load) {
    throw InputError(
        "--input-lines of a discrete-element code needs --normal-load: its friction coefficient is "
        "Tc/N");
  }
  const double friction = law.slip_force / *contact.normal_load;
  if (target == Target::kLiggghts) {
    return {
        "# LIGGGHTS, in SI units; kn and gamman are yours",
        "pair_style gran model hooke/stiffness tangential history",
        fmt::format("fix kt all property/global kt peratomtypepair 1 {}", law.tangential_stiffness),
        "fix gammat all property/global gammat peratomtypepair 1 0.0",
        fmt::format("fix mu all property/global coefficientFriction peratomtypepair 1 {}",
                    friction)};
  }
  if (target == Target::kYade) {
    return {"# YADE, with Law2_ScGeom_FrictPhys_CundallStrack, in SI units; kn is yours",
            fmt::format("Ip2_FrictMat_FrictMat_FrictPhys(ks=MatchMaker(algo='val', val={}), "
                        "frictAngle=MatchMaker(algo='val', val={}))",
                        law.tangential_stiffness, std::atan(friction))};
  }
  std::vector<std::string> lines = {
      "# LAMMPS, pair_style granular in SI units, behind the normal model of pair_coeff",
      fmt::format("tangential linear_history {} 0.0 {}", law.tangential_stiffness, friction)};
  if (contact.contact_radius) {
    lines.emplace_back("# or, where the contact's radius changes with the load");
    lines.push_back(fmt::format("tangential mindlin {} 0.0 {}",
                                law.tangential_stiffness / *contact.contact_radius, friction));
  }
  return lines;
}

/// Returns a joint's parameters in the names of MuJoCo, URDF and SDF: in rad and N m if it turns.
std::vector<Parameter> ParametersOfJoint(const models::BranchLaw& law, Target target,
                                         double viscous) {
  const Parameter damping = {"damping", viscous, "N s/m", "force per speed"};
  if (target == Target::kMujoco) {
    return {{"stiffness", law.tangential_stiffness, "N/m", "bristles' stiffness"},
            {"coulomb", law.slip_force, "N", "Coulomb's force; static force the same"},
            {"knee", law.slip_force / law.tangential_stiffness, "m",
             "h of a plugin's dz/dt = (v - |v| z)/h, force = Fc z"},
            damping};
  }
  if (target == Target::kMujocoJoint) {
    return {
        {"frictionloss", law.slip_force, "N", "mean force of a stroke"},
        damping,
        {"creep", 1 - kLargestImpedance, "-", "creep speed under a constant force T, over T h/M"}};
  }
  return {{"friction", law.slip_force, "N", "mean force of a stroke"}, damping};
}

std::vector<std::string> LinesOfJoint(const models::BranchLaw& law, Target target, double viscous) {
  switch (target) {
    case Target::kMujoco:
      return {
          "<!-- MuJoCo, in actuator: the joint's friction, a motor without input; lugre is -->",
          "<!-- stiffness, damping, Coulomb's force; motorconst^2/resistance is the damping -->",
          fmt::format("<dcmotor joint=\"joint\" input=\"none\" motorconst=\"1\" resistance=\"{}\" "
                      "lugre=\"{} 0 {}\"/>",
                      viscous > 0 ? 1 / viscous : kNoDamping, law.tangential_stiffness,
                      law.slip_force)};
    case Target::kMujocoJoint:
      return {
          "<!-- MuJoCo; type, axis and armature are yours; the engine raises the time constant -->",
          "<!-- of solreffriction to two time steps -->",
          fmt::format("<joint name=\"joint\" type=\"slide\" frictionloss=\"{}\" damping=\"{}\" "
                      "solreffriction=\"1e-06 1\" solimpfriction=\"{} {} 0.001\"/>",
                      law.slip_force, viscous, kLargestImpedance, kLargestImpedance)};
    case Target::kUrdf:
      return {fmt::format("<dynamics damping=\"{}\" friction=\"{}\"/>", viscous, law.slip_force)};
    default:
      return {fmt::format("<dynamics><damping>{}</damping><friction>{}</friction></dynamics>",
                          viscous, law.slip_force)};
  }
}

}  // namespace

void Validate(const NormalContact& contact, Target target) {
  if (contact.normal_load) RequirePositive("--normal-load [N]", *contact.normal_load);
  if (contact.contact_radius) RequirePositive("--contact-radius [m]", *contact.contact_radius);
  if (contact.normal_load && !IsDiscreteElementCode(target)) {
    throw InputError("--normal-load has no effect unless --to is lammps, liggghts or yade");
  }
  if (contact.contact_radius && target != Target::kLammps) {
    throw InputError("--contact-radius has no effect unless --to is lammps");
  }
  if (!(contact.viscous >= 0 && contact.viscous < std::numeric_limits<double>::infinity())) {
    ThrowInvalid("--viscous [N s/m]", contact.viscous, "must be finite and >= 0");
  }
  if (contact.viscous > 0 && target != Target::kLuGre && !IsJoint(target)) {
    throw InputError(
        "--viscous has no effect unless --to is lugre, mujoco, mujoco-joint, urdf or sdf");
  }
}

std::vector<Parameter> ParametersOf(const Conversion& conversion, Target target,
                                    const NormalContact& contact) {
  if (const auto* law = std::get_if<BoucWenLaw>(&conversion.law)) {
    return {{"k", law->stiffness, "N/m", "stiffness k of force = k z"},
            {"A", 1.0, "-", "dz/dx at z = 0"},
            {"n", law->exponent, "-", "exponent"},
            {"beta", PerTravel(*law, law->beta), "1/m^n", "factor of |z|^n sgn(z dx)"},
            {"gamma", PerTravel(*law, 1 - law->beta), "1/m^n", "of |z|^n"},
            {"slip_force", law->slip_force, "N", "k (beta + gamma)^(-1/n)"}};
  }
  if (const auto* elements = std::get_if<IwanElements>(&conversion.law)) {
    double stiffness = 0.0;
    double slip_force = 0.0;
    for (std::size_t j = 0; j < elements->size(); ++j) {
      stiffness += elements->stiffness[j];
      slip_force += elements->slip_force[j];
    }
    return {{"sigma", stiffness, "N/m", "sum of the stiffnesses"},
            {"slip_force", slip_force, "N", "sum of the slip forces"}};
  }
  const models::BranchLaw& law = std::get<ModelLaw>(conversion.law).law;
  if (target == Target::kLuGre) {
    return {{"sigma0", law.tangential_stiffness, "N/m", "bristles' stiffness"},
            {"sigma1", 0.0, "N s/m", "bristles' damping"},
            {"sigma2", contact.viscous, "N s/m", "viscous friction"},
            {"Fc", law.slip_force, "N", "Coulomb's force"},
            {"Fs", law.slip_force, "N", "static force: no Stribeck effect"}};
  }
  if (IsJoint(target)) return ParametersOfJoint(law, target, contact.viscous);
  if (IsDiscreteElementCode(target)) {
    std::vector<Parameter> parameters = {
        {target == Target::kYade ? "ks" : "kt", law.tangential_stiffness, "N/m",
         target == Target::kLammps     ? "of tangential linear_history"
         : target == Target::kLiggghts ? "kt of hooke/stiffness, tangential history"
                                       : "of FrictPhys"},
        {"slip_force", law.slip_force, "N", "Coulomb's limit"}};
    if (contact.contact_radius) {
      parameters.push_back({"kt_mindlin", law.tangential_stiffness / *contact.contact_radius, "Pa",
                            "kt of tangential mindlin, whose stiffness is kt a"});
    }
    if (contact.normal_load) {
      const double friction = law.slip_force / *contact.normal_load;
      parameters.push_back({"mu", friction, "-", "friction, Tc/N"});
      if (target == Target::kYade) {
        parameters.push_back({"friction_angle", std::atan(friction), "rad", "atan(Tc/N)"});
      }
    }
    return parameters;
  }
  return {{"sigma", law.tangential_stiffness, "N/m",
           target == Target::kDahl ? "dT/dx at T = 0" : "stiffness at the start of a branch"},
          {"alpha", law.shape_exponent, "-", "shape exponent"},
          {"slip_force", law.slip_force, "N", "slip force"}};
}

std::vector<std::string> InputLines(const Conversion& conversion, Target target,
                                    const NormalContact& contact) {
  if (const auto* law = std::get_if<BoucWenLaw>(&conversion.law)) {
    return {
        "# OpenSees, force in N and displacement in m: tag alpha ko n gamma beta Ao deltaA "
        "deltaNu deltaEta",
        fmt::format("uniaxialMaterial BoucWen 1 0.0 {} {} {} {} 1.0 0.0 0.0 0.0", law->stiffness,
                    law->exponent, PerTravel(*law, 1 - law->beta), PerTravel(*law, law->beta))};
  }
  if (const auto* elements = std::get_if<IwanElements>(&conversion.law)) {
    std::vector<std::string> lines = {
        "# OpenSees, force in N and displacement in m: tag, stiffness, displacement at slip"};
    std::string tags;
    for (std::size_t j = 0; j < elements->size(); ++j) {
      lines.push_back(fmt::format("uniaxialMaterial ElasticPP {} {} {}", j + 1,
                                  elements->stiffness[j],
                                  elements->slip_force[j] / elements->stiffness[j]));
      tags += fmt::format(" {}", j + 1);
    }
    lines.push_back(fmt::format("uniaxialMaterial Parallel {}{}", elements->size() + 1, tags));
    return lines;
  }
  const models::BranchLaw& law = std::get<ModelLaw>(conversion.law).law;
  if (IsDiscreteElementCode(target)) return LinesOfSpring(law, target, contact);
  if (IsJoint(target)) return LinesOfJoint(law, target, contact.viscous);
  if (target == Target::kLuGre) {
    return {fmt::format("sigma0 = {}", law.tangential_stiffness), "sigma1 = 0",
            fmt::format("sigma2 = {}", contact.viscous), fmt::format("Fc = {}", law.slip_force),
            fmt::format("Fs = {}", law.slip_force)};
  }
  return {fmt::format("--model {} --sigma {} --alpha {} --slip-force {}",
                      std::get<ModelLaw>(conversion.law).model->name, law.tangential_stiffness,
                      law.shape_exponent, law.slip_force)};
}

}  // namespace mindahl::convert
