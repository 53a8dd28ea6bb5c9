#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "mindahl/methods/method.h"
#include "mindahl/models/branch_law.h"
#include "mindahl/tradeoff/approximation.h"
#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::tradeoff {

/// Refits the models of ModelLadder that are not the contact's own law: with the σ and Tc that suit
/// a drive best instead of the contact's, and Dahl's law with α = 1 besides, in the same order:
///   min Σ (T_model(σ, Tc) − T)²   over the samples from `first` on
/// A user gets this who fits the simpler model to the contact's loop rather than to its parameters:
/// on a steady loop of one amplitude Dahl's law then errs by rounding alone (docs/theory.md §6).
/// Each minimum is looked for within a hundred times the contact's own σ/Tc to either side.
/// @param law        of the contact
/// @param reference  MakeReferenceResponse() of it along the drive
/// @param first      sample from which errors count
/// @returns approximations with a law of their own; none of a model that the drive does not move,
///   or whose best force has the wrong sign
/// @throws InvalidArgument for an invalid law or drive, or where `first` is not a sample
/// Cost: about a hundred evaluations of each model along the drive.
std::vector<Approximation> RefittedLadder(const models::BranchLaw& law, const methods::Drive& drive,
                                          const ReferenceResponse& reference,
                                          std::size_t first = 0);

/// Returns AllApproximations with refitted models, each after that at the contact's parameters.
std::vector<Approximation> AllApproximationsAlong(const models::BranchLaw& law,
                                                  const methods::Drive& drive,
                                                  const ReferenceResponse& reference,
                                                  std::size_t first = 0);

struct RecommendOptions {
  double tolerance = 0.01;  ///< largest error by the criterion [–], in (0, 1]
  Criterion criterion = Criterion::kMaxForce;
  /// Largest cost [ns/sample], > 0: then the most precise within it is sought, and the tolerance
  /// is not looked at.
  std::optional<double> largest_cost = std::nullopt;
  std::size_t transient_cycles = 0;  ///< at the start, which do not count
};

/// An approximation with its evidence.
struct Candidate {
  WorkPrecision point;
  bool meets =
      false;  ///< its error by the criterion is within the tolerance, its cost in the limit
  /// Whole cycles after which |ΔT| stays within the tolerance of the peak force; empty when it
  /// never does for the drive's last cycle.
  std::optional<std::size_t> settles_after;
};

struct Recommendation {
  std::vector<Candidate> candidates;  ///< models simplest first, then methods
  std::optional<std::size_t> choice;  ///< empty when none meets what is asked
  /// The exact closed form, with which costs are compared.
  std::size_t exact = 0;
  /// A model simpler than the choice (or than the exact one, when there is none) that meets the
  /// tolerance once its transient is over. Searched for under a tolerance only.
  std::optional<std::size_t> after_transient;
  CostFloor floor;
  double peak_force = 0.0;  ///< largest |T| of the exact response [N]
  double cycles = 0.0;      ///< number of cycles of the drive
};

/// Finds the cheapest model and method that meet a tolerance along this drive, found by running
/// every one and comparing it with the exact response of the Masing law (MakeReferenceResponse);
/// costs are those of the cost model, so that one drive has one answer. Costs within a tenth of
/// each other count as equal, and the simpler model is then preferred: no machine is known better.
/// @throws InvalidArgument for options out of range, an invalid law or drive, or a transient that
///   leaves no sample
Recommendation Recommend(const models::BranchLaw& law, const methods::Drive& drive,
                         const RecommendOptions& options);

/// Returns the cycles passed at each sample of a drive from the unloaded contact: a quarter to the
/// first reversal, half a cycle from one to the next, in proportion to the displacement between.
std::vector<double> CyclesPassed(std::span<const double> displacement);

}  // namespace mindahl::tradeoff
