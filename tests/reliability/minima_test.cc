#include "minima.h"

#include "support/prelude.h"

namespace mindahl::reliability::minima_test {
namespace {

TEST(Minima, NoFitOfSixProblemsAKindEndsAboveTheMultiStart) {
  for (const std::string_view kind : KindsOfMinima()) {
    const MinimaTally tally = MeasureMinima(kind, 6, 4001);
    EXPECT_EQ(tally.problems, 6U) << kind;
    EXPECT_EQ(tally.not_converged, 0U) << kind;
    EXPECT_EQ(tally.worse, 0U) << kind << ": 2 ln Lambda " << tally.largest;
    EXPECT_EQ(tally.told_and_identifiable, 0U) << kind;
  }
}

TEST(Minima, KindThatDoesNotExistIsRefused) {
  EXPECT_THAT([] { MeasureMinima("springs", 1, 1); }, ::testing::Throws<InvalidArgument>());
}

}  // namespace
}  // namespace mindahl::reliability::minima_test
