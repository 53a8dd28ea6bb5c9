#pragma once

#include <optional>
#include <vector>

#include "identification/inference/estimates.h"
#include "identification/problem/problem.h"
#include "identification/solve/search.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

inline constexpr double kMindlinExponent = 1.0 / 3;

/// α = 1/3 against the fitted α by the likelihood, which keeps to the valley along which α and Tc
/// run away together, where a standard error of α means little. Empty where α is held.
std::optional<MindlinTest> TestMindlin(const FittedProblem& fitted, const FitOptions& options,
                                       SearchBuffers& buffers);

/// True if the likelihood allows α = 1/3, which the interval by its parabola excludes.
bool ContradictsInterval(const MindlinTest& test, const ParameterEstimate& alpha,
                         double confidence);

/// Holds α = 1/3 in a compliant rig.
struct RigAlternative {
  double rig_stiffness = 0.0;         // [N/m]
  double tangential_stiffness = 0.0;  // σ of the contact [N/m]
};

/// A rig makes a loop more angular, as a smaller α does: where α = 1/3 is rejected for a rigid rig,
/// a compliant one may restore it.
/// @returns empty where α = 1/3 is not rejected, α is the larger one, a rig is there already, or
///   none helps
std::optional<RigAlternative> TryRig(const FittedProblem& fitted, ThinnedRecords& thin,
                                     const MindlinTest& test, const FitOptions& options,
                                     SearchBuffers& buffers);

/// True if Mindlin's exponent is rejected for a smaller one on a rigid rig, so that a compliant rig
/// may be the cause.
bool WantsRig(const Problem& problem, const Solution& best, const MindlinTest& test,
              const Thresholds& thresholds);

/// True if all swings of the records are as wide as the widest, those to their ends no wider. Then
/// a steady contact of Masing's law and one of Dahl's own run along one curve, each with a σ and a
/// Tc of its own (models/steady_loop.h).
bool HasOneAmplitude(const Problem& problem, const Thresholds& thresholds);

/// True if the record hardly distinguishes Masing's law from Dahl's own.
/// @param delta_aicc  of the two
bool LawIsUndecided(double delta_aicc, const Thresholds& thresholds);

/// A fit of the other law.
struct OtherFit {
  Problem problem;
  Solution solution;
};

/// Masing's law against Dahl's own, whichever of them was fitted. The other is fitted too where the
/// record may distinguish them, from where its loop at the widest amplitude would be the same; of
/// one amplitude it follows in closed form.
/// @returns empty where the laws are one (α = 0), and where they are not compared
std::optional<LawChoice> CompareLaws(const Problem& problem, const Solution& best,
                                     const FitResult& result, const FitOptions& options,
                                     SearchBuffers& buffers);

}  // namespace mindahl::identification
