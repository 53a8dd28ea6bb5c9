#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "identification/term_scores.h"

// Parts of records that are predicted by fits to the rest, and the mean of what is missed.
namespace mindahl::identification::held_out_test {
namespace {

constexpr double kRounding = 1e-14;

TEST(MeanOverParts, HasTheErrorOfWeightedPartsOfFoldsThatShareTheirSamples) {
  // 1, 2, 6 of 1, 1 and 2 samples: mean 15/4, deviations weighted −11/16, −7/16 and 18/16. Three
  // parts leave two degrees of freedom, and of three folds 1 + 3/2 counts.
  const std::vector<Part> parts = {{.samples = 1}, {.samples = 1}, {.samples = 2}};
  const MeanOverParts mean = Mean(std::vector<double>{1, 2, 6}, parts, 3);
  EXPECT_NEAR(mean.mean, 3.75, kRounding);
  const double squares = (11.0 * 11 + 7.0 * 7 + 18.0 * 18) / 256;
  EXPECT_NEAR(mean.standard_error, std::sqrt(squares * 3 / 2 * 2.5), kRounding);
}

/// A record that turns at 10, 20, … 70, of which the samples from one on count.
FitResult FitThatTurns() {
  FitResult fit;
  fit.records.resize(1);
  fit.records[0].reversals = {10, 20, 30, 40, 50, 60, 70};
  return fit;
}

SampleMask CountingFrom(std::size_t first) {
  SampleMask mask = {std::vector<unsigned char>(80, 0)};
  for (std::size_t i = first; i < mask[0].size(); ++i) mask[0][i] = 1;
  return mask;
}

TEST(ClosedCycles, BeginWithTheFirstThatIsNotSkipped) {
  const FitResult fit = FitThatTurns();
  const std::vector<Part> all = ClosedCycles(fit, CountingFrom(0), 0);
  ASSERT_EQ(all.size(), 3U);
  EXPECT_EQ(all[0].begin, 10U);
  EXPECT_EQ(all[0].end, 30U);
  EXPECT_EQ(all[0].samples, 20.0);
  // One cycle skipped: to the second turn.
  const std::vector<Part> later = ClosedCycles(fit, CountingFrom(20), 1);
  ASSERT_EQ(later.size(), 2U);
  EXPECT_EQ(later[0].begin, 20U);
  EXPECT_EQ(later[1].end, 60U);
}

TEST(Strokes, BeginWithTheFirstThatIsNotSkipped) {
  const std::vector<Part> strokes = Strokes(FitThatTurns(), CountingFrom(20), 1);
  ASSERT_EQ(strokes.size(), 5U);
  EXPECT_EQ(strokes.front().begin, 20U);
  EXPECT_EQ(strokes.back().end, 70U);
}

}  // namespace
}  // namespace mindahl::identification::held_out_test
