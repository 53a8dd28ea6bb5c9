#pragma once

#include <cmath>
#include <cstddef>

/// Madelung's rules: when branches close (docs/theory.md §5). They look at displacements alone.
///
/// Open branches are counted from the oldest, the virgin curve, whose origin is where the contact
/// is unloaded; the origins of the others are the extremes that are remembered. Each runs against
/// the one before it.
namespace mindahl::models {

/// Returns the displacement [m] at which the youngest of `open` >= 2 branches closes its loop: the
/// extreme that it answers, or the mirror image of the first, which the virgin curve answers.
/// @param origin_of  origin [m] of the i-th open branch
/// @param asymmetry  a of slip forces Tc(1 ± a) of a virgin contact: the mirror image is as far on
///   the other side as the virgin curve there is larger
template <typename OriginOf>
double ClosingDisplacement(std::size_t open, const OriginOf& origin_of, double asymmetry = 0.0) {
  if (open != 2) return origin_of(open - 2);
  const double unloaded = origin_of(std::size_t{0});
  const double extreme = origin_of(std::size_t{1});
  if (asymmetry == 0) return 2 * unloaded - extreme;
  const double side = std::copysign(asymmetry, asymmetry * (extreme - unloaded));
  return unloaded - (extreme - unloaded) * ((1 - side) / (1 + side));
}

/// Returns how many of `open` branches are left at `displacement`, reached in `direction` ±1.
/// Reaching an extreme exactly counts as passing it.
template <typename OriginOf, typename Direction>
std::size_t StillOpen(std::size_t open, const OriginOf& origin_of, Direction direction,
                      double displacement, double asymmetry = 0.0) {
  while (open >= 2 &&
         direction * (displacement - ClosingDisplacement(open, origin_of, asymmetry)) >= 0) {
    // The inner loop is the present branch and the one it answers; the virgin curve answers none.
    open -= open == 2 ? 1 : 2;
  }
  return open;
}

}  // namespace mindahl::models
