#include "loop/strokes.h"
#include "mindahl/loop/reversals.h"
#include "support/histories.h"
#include "support/prelude.h"

// The staircase of the number of reversals over the gate.
namespace mindahl::loop::excursions_test {
namespace {

std::vector<Excursion> Excursions(const History& history) { return FindExcursions(history); }

TEST(CountReversals, IsTheNumberThatIsFoundUnderEveryGate) {
  Generator generator(1);
  for (int i = 0; i < 2000; ++i) {
    const History history = testing::RandomHistory(generator);
    const auto excursions = Excursions(history);
    ASSERT_EQ(CountReversals(excursions, 0.0), FindReversals(history, 0.0).size());
    for (const Excursion& excursion : excursions) {
      for (const double gate :
           {excursion.range * (1 - 1e-12), excursion.range, excursion.range * (1 + 1e-12)}) {
        ASSERT_EQ(CountReversals(excursions, gate), FindReversals(history, gate).size())
            << "history " << i << ", gate " << gate;
      }
    }
  }
}

TEST(FindExcursions, AreClosedLoopsAndTheTravelFromEndToEnd) {
  // 0 → 5 → 4 → 6 → −6 → −5: the loop 5 → 4, then three strokes.
  const auto excursions = Excursions({0, 5, 4, 6, -6, -5});
  ASSERT_EQ(excursions.size(), 4U);
  EXPECT_EQ(excursions[0].range, 1.0);
  EXPECT_EQ(excursions[0].reversals, 2U);
  EXPECT_EQ(excursions[0].first, 1U);
  EXPECT_EQ(excursions[0].duration(), 1U);
  EXPECT_EQ(excursions[1].range, 1.0);
  EXPECT_EQ(excursions[1].reversals, 1U);
  EXPECT_EQ(excursions[2].range, 6.0);
  EXPECT_EQ(excursions[2].duration(), 3U);
  EXPECT_EQ(excursions[3].range, 12.0);
}

TEST(FindExcursions, AreNoneWhereNothingTurnsOrMoves) {
  EXPECT_TRUE(Excursions({}).empty());
  EXPECT_EQ(CountReversals(Excursions({1}), 0.0), 0U);
  EXPECT_EQ(CountReversals(Excursions({1, 2, 3}), 0.0), 0U);
  EXPECT_EQ(CountReversals(Excursions({2, 2, 2}), 0.0), 0U);
}

}  // namespace
}  // namespace mindahl::loop::excursions_test
