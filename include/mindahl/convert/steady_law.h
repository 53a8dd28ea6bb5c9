#pragma once

#include <functional>
#include <variant>
#include <vector>

#include "mindahl/methods/iwan.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/models/friction_model.h"

/// Laws of friction of other programs, as they run on a steady loop between ±X.
namespace mindahl::convert {

/// One of the models here: Masing's law, Dahl's own, LuGre without rate (Dahl's with α = 1), a
/// spring with Coulomb's limit (α = 0).
struct ModelLaw {
  const models::FrictionModel* model = nullptr;  ///< Masing's (mindlin-dahl) or dahl
  models::BranchLaw law;
};

/// Bouc's and Wen's law, written by its stiffness and its limit:
///   dT/dx = k·[1 − |T/Tc|ⁿ·(1 + sgn(T·ẋ))/2],   β = γ
/// Bouc (1967), Wen (1976). It unloads along a straight line.
struct BoucWenLaw {
  double stiffness = 0.0;   ///< k [N/m], > 0
  double slip_force = 0.0;  ///< Tc [N], > 0
  double exponent = 1.0;    ///< n [-], in 1 … 20
};

using SteadyLaw = std::variant<ModelLaw, BoucWenLaw, methods::IwanElements>;

/// The steady loop of a law between ±X.
struct SteadyLoop {
  double peak = 0.0;            ///< T* [N], the force at +X
  double energy = 0.0;          ///< W [J] lost per cycle
  std::vector<double> corners;  ///< distances [m] from its start at which the rising branch bends
  /// Returns the force [N] on the rising branch at a distance [m] from its start at −X, none
  /// shorter than that of the last call. The falling branch is its image through the centre.
  std::function<double(double)> force;
};

/// @param amplitude  X [m], finite, > 0
/// @throws InvalidArgument for an invalid law or amplitude
/// Error of forces below 1e-13 of the slip force, of Bouc's and Wen's below 1e-8; relative error of
/// the energy as of SteadyLoopEnergy, of Bouc's and Wen's below 1e-6 for X > 0.01·Tc/k.
SteadyLoop LoopOf(const SteadyLaw& law, double amplitude);

/// Holds the differences of one law's steady loop from another's.
struct LoopError {
  double force = 0.0;   ///< largest difference over T* of the reference [-]
  double energy = 0.0;  ///< W over that of the reference, less 1 [-]; infinite where that is 0
};

/// Compares two laws at 513 places of the branch, densest after the reversal, and where one of them
/// bends.
/// @throws InvalidArgument for an invalid law or amplitude
LoopError CompareLoops(const SteadyLaw& law, const SteadyLaw& reference, double amplitude);

/// Fits Bouc's and Wen's law to a loop's amplitude, peak force and energy for each n, and takes the
/// n of 1 … 20 whose force differs least.
BoucWenLaw BoucWenOf(const ModelLaw& contact, double amplitude);

/// Returns the law of a model's form, at a shape exponent, whose steady loop at an amplitude has
/// the peak force and the energy of a contact's.
models::BranchLaw SamePeakAndEnergy(const ModelLaw& contact, double amplitude,
                                    const models::FrictionModel& model, double shape_exponent);

}  // namespace mindahl::convert
