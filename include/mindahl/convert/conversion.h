#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mindahl/convert/steady_law.h"

namespace mindahl::convert {

/// Names the form of a law for which a contact is written.
enum class Form {
  kMasing,       ///< σ, α, Tc of Masing's law (Mindlin's, Full-Dahl)
  kDahl,         ///< σ, α, Tc of Dahl's own law
  kExponential,  ///< Dahl's own law of α = 1: LuGre's without σ₁ and Stribeck
  kBoucWen,      ///< k, n, Tc of Bouc's and Wen's law at β = γ
  kElements,     ///< n Jenkins elements in parallel
  kSpring,       ///< a tangential spring with Coulomb's limit, as discrete-element codes have it
};

/// A parameter of the other law, under that law's name for it.
struct ParameterRow {
  std::string_view name;
  std::string_view key;  ///< name of its value in the input lines: "k", "Tc", "mu", …
  std::string_view unit;
  std::string_view meaning;
};

/// Describes a law or program for which a contact is written: a row of the table in conversion.cc.
struct TargetRow {
  std::string_view name;  ///< on the command line
  std::string_view title;
  Form form;
  std::span<const ParameterRow> parameters;
  std::string_view lines;  ///< lines that it reads, with keys of values in braces
};

/// Returns all targets, in the order of the documentation.
std::span<const TargetRow> Targets();

struct ConversionOptions {
  double amplitude = 0.0;    ///< X [m] of the steady loop that is to be reproduced, > 0
  double tolerance = 0.01;   ///< relative error allowed in force and energy, in (0, 1)
  std::size_t elements = 8;  ///< number of elements of Iwan's model, >= 1
  std::optional<double> normal_load = {};  ///< of LAMMPS alone, N [N], > 0: friction is Tc/N
};

/// A parameter of the other law with its value.
struct Parameter {
  ParameterRow row;
  double value = 0.0;
};

struct Conversion {
  SteadyLaw law;
  LoopError at_amplitude;  ///< at X
  /// Least and largest amplitude [m] around X between which force and energy are within the
  /// tolerance, looked for from X/100 to 100·X; empty where X itself is not.
  std::optional<std::pair<double, double>> within = std::nullopt;
  std::vector<Parameter> parameters = {};  ///< in the target's own names and units
  /// Lines that the target reads; none of LAMMPS without a normal load.
  std::vector<std::string> input_lines = {};
};

/// Computes the parameters with which another law reproduces the steady loop of a contact.
///
/// Masing's law and Dahl's own are one curve at X, in closed form (models/steady_loop.h). LuGre,
/// Bouc–Wen and the spring with Coulomb's limit have the contact's peak force and energy at X, the
/// exponent of Bouc–Wen that of the least difference of force in 1 … 20. Jenkins elements are the
/// tangents of the virgin curve (MakeIwanElements), of Masing's law at X where the contact is
/// Dahl's.
/// @param contact  Masing's law (mindlin-dahl) or dahl
/// @throws InvalidArgument for an invalid law or option, InputError for a normal load or a number
///   of elements that the target does not use
/// Cost: some 10 ms to 0.2 s; of a hundred elements some 0.3 s.
Conversion Convert(const ModelLaw& contact, const TargetRow& target,
                   const ConversionOptions& options);

}  // namespace mindahl::convert
