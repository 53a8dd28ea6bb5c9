#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <optional>
#include <span>
#include <vector>

namespace mindahl::loop {

/// Finds reversals while samples arrive, as FindReversals() does of a whole record: a reversal is
/// known once the displacement has retreated from its extremum by more than the gate.
class ReversalFinder {
 public:
  /// @param gate  [m], finite, >= 0
  explicit ReversalFinder(double gate) : gate_(gate) {}

  /// @param displacement  [m] of the next sample, finite
  /// @returns the index of the reversal that this sample makes known
  std::optional<std::size_t> Add(double displacement) {
    const std::size_t i = count_++;
    if (sense_ == 0) {  // until the displacement has left the gate it goes neither way
      high_ = std::max(high_, displacement);
      low_ = std::min(low_, displacement);
      if (high_ - displacement > gate_) Go(-1.0, i, displacement);
      if (displacement - low_ > gate_) Go(1.0, i, displacement);
      return std::nullopt;
    }
    const double along = sense_ * displacement;
    if (along > extreme_) {
      extreme_ = along;
      place_ = i;
      return std::nullopt;
    }
    if (!(extreme_ - along > gate_)) return std::nullopt;
    const std::size_t turn = place_;
    Go(-sense_, i, displacement);
    return turn;
  }

 private:
  void Go(double sense, std::size_t i, double displacement) {
    sense_ = sense;
    extreme_ = sense * displacement;
    place_ = i;
  }

  double gate_;
  std::size_t count_ = 0;
  double high_ = -std::numeric_limits<double>::infinity();  // before it goes either way
  double low_ = std::numeric_limits<double>::infinity();
  double sense_ = 0.0;    // of the motion, ±1; 0 before it is known
  double extreme_ = 0.0;  // the outermost displacement of the stroke, times the direction
  std::size_t place_ = 0;
};

/// Returns the samples at which the direction of displacement reverses.
///
/// A reversal is registered at an extremum once the displacement has retreated from it by more than
/// `gate`; with gate = 0 every change of direction counts. Repeated displacements are no reversal;
/// of a dwell, the first sample is the extremum.
/// @param displacement  [m], finite, in order of time
/// @param gate          [m], finite, >= 0
/// @returns indices into `displacement`, ascending; maxima and minima alternate
/// @throws InvalidArgument when the gate is negative or not finite
/// Cost: one pass.
std::vector<std::size_t> FindReversals(std::span<const double> displacement, double gate);

/// A gate, and whether another would have had as good a claim.
struct ReversalGate {
  double gate = 0.0;    ///< [m]; 0 where nothing looks like noise
  bool certain = true;  ///< no other plateau of the count competes
};

/// Returns the gate [m] that separates reversals of the drive from those made by noise, by an
/// encoder's steps and by backward steps of a gauge.
///
/// An excursion, a pair of extremes with its range, looks like noise where it is brief against the
/// main strokes and either within the reach of the white noise, of which an encoder's steps q make
/// q/√12,
///   1.25·2√(2 ln n) standard deviations,
/// or made mostly of a jump between two samples. Of the gaps between ranges that nearly agree with
/// these looks the widest in log(gate) is taken, never beyond a stroke that looks like the drive's;
/// the gate lies in it, at most at twice the range below it. Where nothing looks like noise (a
/// clean record, nested loops, few samples a cycle) it is 0. A narrow gap makes it uncertain.
///
/// @param displacement  [m], finite
/// Cost: n log n at most.
ReversalGate ChooseReversalGate(std::span<const double> displacement);

}  // namespace mindahl::loop
