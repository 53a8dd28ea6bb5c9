#include "core/extremes.h"

#include "support/prelude.h"

namespace mindahl::extremes_test {
namespace {

TEST(Extremes, AreFoundWhereverTheyLie) {
  // Sizes about those of a block, each with the extremes at every pair of places.
  for (std::size_t size = 1; size <= 19; ++size) {
    for (std::size_t least = 0; least < size; ++least) {
      for (std::size_t greatest = 0; greatest < size; ++greatest) {
        std::vector<double> values(size, 0.5);
        values[least] = -3.0;
        values[greatest] = greatest == least ? -3.0 : 7.0;
        const Extremes extremes = ExtremesOf(values);
        EXPECT_EQ(extremes.least, -3.0) << size << " " << least << " " << greatest;
        EXPECT_EQ(extremes.greatest, size == 1 ? -3.0 : greatest == least ? 0.5 : 7.0);
      }
    }
  }
}

}  // namespace
}  // namespace mindahl::extremes_test
