#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"

namespace mindahl::tradeoff {

/// A way to compute the force of a contact along a drive: a model, and a method that evaluates it.
struct Approximation {
  std::string model;   ///< a name of FrictionModels(), or "simplified-dahl"
  std::string method;  ///< a name of Methods()
  methods::Resolution resolution = {};
};

/// Returns the approximation made ready for a contact, with the model's α where it prescribes one;
/// what it costs is as of methods/method.h.
/// @throws InvalidArgument for an unknown model or method, or as Prepare() of methods/method.h
methods::Evaluator Prepare(const Approximation& approximation, const models::BranchLaw& law);

/// Returns the models a contact may be simplified to, simplest first, each in closed form
/// (jenkins, simplified-dahl, dahl, and its own, mindlin-dahl), then that one by every other
/// method, from coarse to fine.
std::vector<Approximation> AllApproximations();

/// Errors of a response, relative [–].
struct Precision {
  double max_force = 0.0;  ///< largest |ΔT| over the peak force
  /// |ΔW/W| of the energy ∮T dδ lost over the cycles that close: the path comes back to a turning
  /// point, to 5 % of the cycle's width, without passing the one before. Empty without such a
  /// cycle.
  std::optional<double> energy = std::nullopt;
};

/// Compares a response with the exact one [N], sample by sample; the contact is unloaded at 0.
Precision Compare(std::span<const double> exact, std::span<const double> displacement,
                  std::span<const double> force);

/// One point of a work–precision diagram.
struct WorkPrecision {
  Approximation approximation = {};
  Precision precision = {};
  double cost = 0.0;  ///< [ns/sample], reading and writing included
};

/// Runs every one of AllApproximations() along the drive, and compares each with the exact response
/// of the contact's Masing law.
/// @throws InvalidArgument for an invalid law, an empty drive or a displacement that is not finite
std::vector<WorkPrecision> MeasureWorkPrecision(const models::BranchLaw& law,
                                                const methods::Drive& drive);

/// Returns the cheapest point whose largest force error and error of energy are within a tolerance;
/// the first of equals: costs within a tenth of each other are equal, and simpler models come
/// first. The exact one always is within.
/// @throws InvalidArgument for a tolerance outside (0, 1]
std::size_t CheapestWithin(double tolerance, std::span<const WorkPrecision> points);

}  // namespace mindahl::tradeoff
