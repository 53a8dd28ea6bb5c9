#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mindahl/convert/conversion.h"

namespace mindahl::convert {

/// A parameter of the other law, as it calls it.
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
