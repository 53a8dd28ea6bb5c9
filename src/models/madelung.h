#pragma once

#include <cstddef>

/// Madelung's rules: when branches close (docs/theory.md §5). They look at displacements alone.
///
/// Open branches are counted from the oldest, the virgin curve, whose origin is where the contact
/// is unloaded; the origins of the others are the extremes that are remembered. Each runs against
/// the one before it.
namespace mindahl::models {

/// Displacement [m] at which the youngest of `open` >= 2 branches closes its loop: the extreme that
/// it answers, or the mirror image of the first, which the virgin curve answers.
/// @param origin_of  origin [m] of the i-th open branch
template <typename OriginOf>
double ClosingDisplacement(std::size_t open, const OriginOf& origin_of) {
  return open == 2 ? 2 * origin_of(std::size_t{0}) - origin_of(std::size_t{1})
                   : origin_of(open - 2);
}

/// How many of `open` branches are left at `displacement`, reached in `direction` ±1. Reaching an
/// extreme exactly counts as passing it.
template <typename OriginOf, typename Direction>
std::size_t StillOpen(std::size_t open, const OriginOf& origin_of, Direction direction,
                      double displacement) {
  while (open >= 2 && direction * (displacement - ClosingDisplacement(open, origin_of)) >= 0) {
    // The inner loop is the present branch and the one it answers; the virgin curve answers none.
    open -= open == 2 ? 1 : 2;
  }
  return open;
}

}  // namespace mindahl::models
