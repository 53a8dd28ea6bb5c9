#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/models/friction_model.h"

namespace mindahl::models {

/// Names the assumed history of the contact before the first sample.
enum class InitialState {
  kVirgin,  ///< none: the contact was unloaded at a known displacement
  kSteady,  ///< it had settled on the loop between the record's extremes
};

/// Names the point at which a branch of the response begins.
enum class BranchStart : std::uint8_t {
  kUnloaded,      ///< T = 0 at the displacement where the contact is unloaded
  kSteadyCentre,  ///< T = 0 at the centre of the steady loop: the virgin curve of its first loading
  kSteadyExtreme,  ///< the steady loop's force at its extreme
  kReversal,       ///< the force that the parent branch has there
};

/// True if the branch starts at T = 0 on the virgin curve.
[[nodiscard]] constexpr bool IsVirgin(BranchStart start) {
  return start == BranchStart::kUnloaded || start == BranchStart::kSteadyCentre;
}

/// One branch of the response: T(δ) = T₀ + s·(branch law of |δ − origin|).
struct Branch {
  double origin = 0.0;       ///< [m]
  double amplitude = 0.0;    ///< X [m] of the steady loop before it; of kSteadyExtreme alone
  std::int32_t parent = -1;  ///< branch on which the origin lies; −1 unless start is kReversal
  BranchStart start = BranchStart::kReversal;
  std::int8_t direction = 1;  ///< s = ±1; on the virgin curve, which is run both ways, the first
};

/// A branch ready for evaluation: t(δ) = force + height·sgn(e)·φ(rate·|e|), e = δ − origin.
struct ScaledBranch {
  double origin = 0.0;  ///< [m]
  double force = 0.0;   ///< t₀, over Tc
  double height = 1.0;  ///< span·v
  double rate = 0.0;    ///< k [1/m]

  /// Returns y = rate·|e|.
  [[nodiscard]] double Normalize(double e) const { return rate * std::abs(e); }

  /// Returns t(δ).
  /// @param shape  φ of the branch: has Force(y), as those of backbone.h
  template <typename Shape>
  [[nodiscard]] double ForceAt(double displacement, const Shape& shape) const {
    const double e = displacement - origin;
    return force + std::copysign(height * shape.Force(Normalize(e)), e);
  }
};

/// Largest |displacement| [m] of a path.
inline constexpr double kLargestPathDisplacement = 1e100;

/// @throws InvalidArgument unless the displacement [m] can be part of a path
inline void RequireWithinReach(std::string_view quantity, double displacement) {
  if (std::abs(displacement) <= kLargestPathDisplacement) return;
  ThrowInvalid(quantity, displacement, "must be finite and within +-1e100 m");
}

/// Successive samples on one branch: [begin, end).
struct BranchRun {
  std::uint32_t begin = 0;
  std::uint32_t end = 0;
  std::int32_t branch = 0;
};

/// Holds on which branch each sample of a record lies, and from which branch each branch starts. It
/// follows from the displacements alone, never from σ, α or Tc (docs/theory.md §5): it is found
/// once a record. A parent always precedes its branches, so origin forces are found in one pass.
struct LoadingPath {
  std::vector<Branch> branches;
  std::vector<BranchRun> runs;     ///< contiguous, of all samples in order
  std::vector<std::int32_t> open;  ///< branches still open after the last sample, oldest first
  double asymmetry = 0.0;          ///< asymmetry of the slip forces, as InitialContact's

  /// Returns the largest |T| [Tc], which rounding must not exceed.
  [[nodiscard]] double limit() const { return 1 + std::abs(asymmetry); }
};

/// Returns the limit of the force [Tc]: 1 ± a for the virgin curve of an unloaded contact, by its
/// direction, and 1 for every other branch.
[[nodiscard]] inline double VirginLimit(const LoadingPath& path, const Branch& branch) {
  return branch.start == BranchStart::kUnloaded ? 1 + branch.direction * path.asymmetry : 1.0;
}

/// Holds the state of the contact before the record.
struct InitialContact {
  InitialState state = InitialState::kVirgin;
  double unloaded_displacement = 0.0;  ///< [m], used when virgin: where T = 0
  /// The motion turns at the first sample, of a steady contact: it came there from the other end of
  /// the loop. Else it came from the near end, whose turn is not among the samples.
  bool turns_at_first = false;
  /// a of slip forces Tc(1 + a) where the motion is towards positive displacement and
  /// Tc(1 − a) where it is not, in (−1, 1): elements of those limits are the symmetric ones that
  /// set out with −a of their slip force, under a constant a·Tc (docs/theory.md §5). A steady
  /// contact is one that had slipped as a whole before.
  double asymmetry = 0.0;
};

/// Makes the path of a record under the rules of `memory`:
/// - kReturnPoint: a branch that passes the previous extremum of its side erases the inner loop and
///   continues the branch before it; passing the mirror image of the first extremum rejoins the
///   virgin curve (Madelung's rules). Reaching it exactly counts as passing.
/// - kNone: every reversal opens a branch from the last one.
/// Where the slip forces differ, the virgin curve is one branch in either direction, both of which
/// are there from the start, and the mirror image of an extremum at x is (1 − a)/(1 + a) times as
/// far on the other side where x > 0, else (1 + a)/(1 − a) times. The record goes on from a loop
/// between its own extremes where the contact is steady.
/// @param displacement  [m], finite
/// @param reversals     as from FindReversals on the same displacements; between them samples may
///                      step back within the gate
/// @throws InvalidArgument when a displacement is not finite or beyond ±1e100 m, when the record is
///   empty, for an asymmetry beyond (−1, 1) or of a law without memory
/// Cost: linear in the samples, however deep the nesting; 36 bytes a reversal, and 4 more an
/// extremum that is remembered.
LoadingPath MakeLoadingPath(std::span<const double> displacement,
                            std::span<const std::size_t> reversals, Memory memory,
                            const InitialContact& initial);

/// A turn of the motion, which may lie between two samples.
struct Turn {
  std::size_t next = 0;       ///< the first sample after it
  double displacement = 0.0;  ///< [m]
};

/// Makes the same of a motion whose turns are known, into a path whose memory is used again.
/// @param turns  in the order of time, alternating in sense
void MakeLoadingPath(std::span<const double> displacement, std::span<const Turn> turns,
                     Memory memory, const InitialContact& initial, LoadingPath& path);

}  // namespace mindahl::models
