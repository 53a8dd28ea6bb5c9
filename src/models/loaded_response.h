#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "mindahl/models/loading_path.h"
#include "models/normalized_response.h"

namespace mindahl::models {

/// A record under a load that varies, as the law follows it: what LoadingPath is at constant load.
struct LoadedHistory {
  std::vector<double> displacement;    ///< δ, from reversal to reversal one way
  std::vector<double> load_ratio;      ///< N/N₀ >= 0
  std::vector<double> log_load_ratio;  ///< ln(N/N₀); 0 where lifted off
  /// Samples that the contact has been through before the first: of a steady one the extremes of
  /// the record, and its first cycle.
  std::vector<std::size_t> before;
};

/// Makes the history of a record under the load ratios given. Between reversals the law takes any
/// step back for one: where samples step back within the gate, the displacement is the nearest that
/// does not (least squares, by pooling neighbours: Ayer et al. 1955).
///
/// A contact that had settled has no closed form under a varying load, but repeats itself exactly
/// from the second cycle of (δ, N) on: a steady one is taken, from unloaded at 0, to the record's
/// extremes, the last of them that from which it starts away, and once through its first cycle.
/// @param displacement  [m], finite, not empty; 0 is midway between its extremes where steady
/// @param load_ratio    N/N₀, finite, >= 0; of the same size
/// @param reversals     as from FindReversals on the same displacements
/// @throws InvalidArgument where sizes differ, the record is empty or a load ratio is negative
LoadedHistory MakeLoadedHistory(std::span<const double> displacement,
                                std::span<const double> load_ratio,
                                std::span<const std::size_t> reversals, InitialState state);

/// Computes the force under a varying load (load_zones.h) over μN₀ and its gradient, for solvers:
/// σ_ref is that under N₀, and t = T/(μN₀) depends on κ = σ_ref/(μN₀) and α only.
/// @param law       α < 1; no spring in series, behind which the contact's own displacement would
///                  depend on the force
/// @param unloaded  δ₀ [m], where the contact is unloaded under the first load; not looked at where
///                  it has been through samples before
/// @param t         written, of the record's size; |t| <= N/N₀
/// @param gradient  columns of the record's size, or empty; that of the spring is filled with 0.
///                  Exact, where t has derivatives; taken along with the recursion, at two to three
///                  times its cost
/// @throws InvalidArgument for a law or sizes that break a rule
void EvaluateNormalizedForce(const NormalizedLaw& law, const LoadedHistory& history,
                             double unloaded, std::span<double> t,
                             const NormalizedGradient& gradient = {});

}  // namespace mindahl::models
