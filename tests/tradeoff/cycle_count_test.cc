

#include "mindahl/models/excitation.h"
#include "mindahl/tradeoff/recommendation.h"
#include "support/prelude.h"

namespace mindahl::tradeoff::cycle_count_test {
namespace {

using namespace models;

using Cycles = std::vector<double>;

TEST(CyclesPassed, FollowsTheQuartersOfASine) {
  constexpr double kRounding = 1e-15;  // of quarters and halves of up to 3 cycles
  constexpr std::size_t kSamples = 40;
  const Excitation sine =
      MakeExcitation({.amplitude = 0.3, .cycles = 3, .samples_per_cycle = kSamples});
  const Cycles cycles = CyclesPassed(sine.displacement);
  ASSERT_EQ(cycles.size(), sine.displacement.size());
  for (std::size_t i = 0; i < cycles.size(); ++i) {
    if (i % (kSamples / 4) == 0) {
      EXPECT_NEAR(cycles[i], static_cast<double>(i) / kSamples, kRounding);
    }
    if (i > 0) {
      EXPECT_GT(cycles[i], cycles[i - 1]);
    }
  }
}

TEST(CyclesPassed, IsInProportionToTheDisplacement) {
  EXPECT_EQ(CyclesPassed(Cycles{0, 1, 2, 1, 0, -1, -2, -1, 0, 2}),
            (Cycles{0, 0.125, 0.25, 0.375, 0.5, 0.625, 0.75, 0.875, 1, 1.25}));
}

TEST(CyclesPassed, CountsCyclesOffCentre) {
  EXPECT_EQ(CyclesPassed(Cycles{0, 2, 4, 3, 2, 3, 4, 3, 2}),
            (Cycles{0, 0.125, 0.25, 0.5, 0.75, 1, 1.25, 1.5, 1.75}));
}

TEST(CyclesPassed, IsAQuarterWithoutAReversal) {
  EXPECT_EQ(CyclesPassed(Cycles{0, -1, -2}), (Cycles{0, 0.125, 0.25}));
  EXPECT_EQ(CyclesPassed(Cycles{-2}), (Cycles{0.25}));
}

TEST(CyclesPassed, TakesTheSecondSwingToBeTwiceTheFirst) {
  EXPECT_EQ(CyclesPassed(Cycles{2, 1, 0, -1}), (Cycles{0.25, 0.375, 0.5, 0.625}));
}

TEST(CyclesPassed, CountsTravelFromReferencePosition) {
  EXPECT_EQ(CyclesPassed(Cycles{1, 0, -1, 0}), (Cycles{0.25, 0.5, 0.75, 1}));
}

TEST(CyclesPassed, StandsStillWhereTheDriveDwells) {
  EXPECT_EQ(CyclesPassed(Cycles{0, 1, 1, 1, 0, 0, -1, -1}),
            (Cycles{0, 0.25, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75}));
  EXPECT_EQ(CyclesPassed(Cycles{0, 0, 1, 0}), (Cycles{0, 0, 0.25, 0.5}));
}

}  // namespace
}  // namespace mindahl::tradeoff::cycle_count_test
