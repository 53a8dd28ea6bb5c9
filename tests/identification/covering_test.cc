
#include "identification/inference/estimates.h"
#include "identification/problem/parameters.h"
#include "identification/stages.h"
#include "support/prelude.h"

// Intervals that reach to what can be read off a loop.
namespace mindahl::identification::covering_test {
namespace {

// Tc is at the reference load, the plateau at the record's.
TEST(CoverPlateau, BringsThePlateauToTheReferenceLoad) {
  constexpr double kLoadRatio = 2.0;
  for (const double plateau : {2.5, 1.5}) {  // of Tc in [1.9, 2.1], above it and below
    FitResult result = testing::MadeFit(/*peak_force=*/kLoadRatio * plateau);
    result.records[0].load_ratio = kLoadRatio;
    result.records[0].facts.half_gap = kLoadRatio * plateau;
    Thresholds thresholds;
    thresholds.mobilised_by_asymptote = 0.5;
    result.parameters[kSlipForce] = CoverPlateau(result, thresholds);
    EXPECT_DOUBLE_EQ(*result.parameters[kSlipForce].lower95, std::min(1.9, plateau));
    EXPECT_DOUBLE_EQ(*result.parameters[kSlipForce].upper95, std::max(2.1, plateau));
  }
}

}  // namespace
}  // namespace mindahl::identification::covering_test
