#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/convert/steady_law.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::convert {

/// Names the law or program for which a contact is written.
enum class Target {
  kMasing,  ///< σ, α, Tc of Masing's law (Mindlin's, Full-Dahl)
  kDahl,    ///< σ, α, Tc of Dahl's own law
  kLuGre,   ///< σ₀ and g = Tc of LuGre's law without σ₁, σ₂ and Stribeck: Dahl's of α = 1
  kBoucWen,  ///< k, n, Tc of Bouc's and Wen's law at a given β
  kIwan,     ///< n Jenkins elements in parallel
  // A tangential spring with Coulomb's limit, as discrete-element codes have it:
  kLammps,
  kLiggghts,
  kYade,
  kMujoco,  ///< the law of kLuGre: `lugre` of MuJoCo's dcmotor
  // Coulomb's friction without presliding, as descriptions of robots have it:
  kMujocoJoint,
  kUrdf,
  kSdf,
};

/// True for a code whose contact is a tangential spring with Coulomb's limit μN.
bool IsDiscreteElementCode(Target target);

/// True for a joint's friction in a description of a robot, which may carry viscous damping.
bool IsJoint(Target target);

struct TargetRow {
  Target target;
  std::string_view name;  ///< on the command line
  std::string_view title;
};

/// Returns all targets, in the order of the documentation.
std::span<const TargetRow> Targets();

/// Amplitudes [m].
struct AmplitudeRange {
  double lower = 0.0;
  double upper = 0.0;
};

struct ConversionOptions {
  double amplitude = 0.0;  ///< X [m] of the steady loop that is to be reproduced, > 0
  /// Amplitudes over which an inexact law is fitted; empty: X alone.
  std::optional<AmplitudeRange> range = std::nullopt;
  double tolerance = 0.01;   ///< relative error allowed in force and energy, in (0, 1)
  std::size_t elements = 8;  ///< number of elements of Iwan's model, >= 1
  double beta = 0.5;         ///< β of the Bouc–Wen law, in (0, 1]
};

struct Conversion {
  SteadyLaw law;
  LoopError at_amplitude;  ///< at X
  LoopError largest;       ///< worst over the range, each by itself; energy in magnitude
  /// Amplitudes around X at which force and energy are within the tolerance, looked for from 1e-4·X
  /// to 1e4·X; empty where X itself is not.
  std::optional<AmplitudeRange> within = std::nullopt;
};

/// Computes the parameters with which another law reproduces the steady loop of a contact.
///
/// Masing's law and Dahl's own are one curve at X, in closed form (models/steady_loop.h).
/// Coulomb's friction of a robot's joint, for which the least mean square is the mean force of a
/// stroke, W/4X, is a spring that slips after 1e-13·X. LuGre, Bouc–Wen, the spring with Coulomb's
/// limit and Jenkins elements are fitted: the mean square difference of force over the loop, each
/// amplitude over its own T*, is least over all their parameters; of elements neither it nor the
/// largest difference is more than that of the tangents of the virgin curve (MakeIwanElements), of
/// Masing's law at X where the contact is Dahl's.
/// @param contact  Masing's law (mindlin-dahl) or dahl
/// @throws InvalidArgument for an invalid law or option: a range that does not hold X, a tolerance
///   outside (0, 1)
/// Cost: below 1 ms, of Bouc's and Wen's law some 0.1 s; 0.3 ms a Jenkins element, over a range 2
/// ms.
Conversion Convert(const ModelLaw& contact, Target target, const ConversionOptions& options);

/// A parameter of the other law, under that law's name for it.
struct Parameter {
  std::string name;
  double value;
  std::string unit;
  std::string meaning;
};

/// Holds the properties of a contact that programs need in addition to a law.
struct NormalContact {
  std::optional<double> normal_load = {};     ///< N [N], > 0: its friction coefficient is Tc/N
  std::optional<double> contact_radius = {};  ///< a [m], > 0: LAMMPS' Mindlin stiffness is kt·a
  double viscous = 0.0;                       ///< [N s/m], >= 0: damping of a joint, σ₂ of LuGre
};

/// @throws InputError for what belongs to another target, InvalidArgument for values out of range
void Validate(const NormalContact& contact, Target target);

/// Returns the parameters of a conversion, in the target's own names and units.
std::vector<Parameter> ParametersOf(const Conversion& conversion, Target target,
                                    const NormalContact& contact = {});

/// Returns the lines that the target reads.
/// @throws InputError for a discrete-element code without a normal load
std::vector<std::string> InputLines(const Conversion& conversion, Target target,
                                    const NormalContact& contact = {});

}  // namespace mindahl::convert
