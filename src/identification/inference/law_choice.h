#pragma once

#include <optional>

#include "identification/problem/problem.h"
#include "identification/solve/search.h"
#include "mindahl/identification/fit_options.h"
#include "mindahl/identification/fit_result.h"

namespace mindahl::identification {

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

/// Compares Masing's law with Dahl's own.
struct LawComparison {
  /// Empty where the laws are one (α = 0), and where they are not compared.
  std::optional<LawChoice> choice;
  /// Fit of the other law with its likeliest initial state; empty where it was not fitted.
  std::optional<OtherFit> other;
  /// σ and Tc are not held or bounded, as those of one law only, the motion turns and the load
  /// stays.
  bool is_comparable = false;
};

/// Masing's law against Dahl's own, whichever of them was fitted. The other is fitted too where the
/// record may distinguish them, from where its loop at the widest amplitude would be the same; of
/// one amplitude it follows in closed form.
LawComparison CompareLaws(const Problem& problem, const Solution& best, const FitResult& result,
                          const FitOptions& options, SearchBuffers& buffers);

}  // namespace mindahl::identification
