#include "mindahl/loop/segments.h"
#include "support/histories.h"
#include "support/prelude.h"

namespace mindahl::loop::load_steps_test {
namespace {

using ::testing::Field;

constexpr std::size_t kCycle = 200;                  // samples
constexpr std::size_t kSecondTurn = 3 * kCycle / 4;  // of a sine

/// A sine under a load that goes with the cycles.
Record Cycled(double cycles, const std::function<double(double)>& load_at) {
  Record record;
  const auto samples = static_cast<std::size_t>(cycles * static_cast<double>(kCycle));
  for (std::size_t i = 0; i <= samples; ++i) {
    const double cycle = static_cast<double>(i) / static_cast<double>(kCycle);
    record.displacement.push_back(1e-6 * std::sin(2 * std::numbers::pi * cycle));
    record.force.push_back(record.displacement.back());
    record.normal_load.push_back(load_at(cycle));
  }
  return record;
}

double Staircase(double cycle) { return cycle < 5 ? 20.0 : cycle < 10 ? 50.0 : 100.0; }

Record WithNoise(Record record, double share) {
  Generator generator(1);
  for (double& load : record.normal_load) load *= 1 + share * Normal(generator);
  return record;
}

void ExpectThreeLoads(const std::vector<ConstantLoad>& pieces, double tolerance) {
  ASSERT_EQ(pieces.size(), 3U);
  const double loads[] = {20, 50, 100};
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_NEAR(pieces[p].normal_load / loads[p], 1.0, tolerance);
  }
}

TEST(LoadSteps, AreNoneWhereOneOfThemDrifts) {
  // Both within 2 % of themselves; a step of 3 N, of which 0.8 N are more than a tenth.
  const auto second_load = [](double cycle) { return cycle < 5 ? 0.0 : 53.5; };
  const auto level = [&](double cycle) { return std::max(second_load(cycle), 50.4); };
  const auto drifting = [&](double cycle) {
    return cycle < 5 ? 50.0 + 0.8 * cycle / 5 : second_load(cycle);
  };
  const auto drifting_later = [&](double cycle) {
    return cycle < 5 ? 50.4 : 53.1 + 0.8 * (cycle - 5) / 5;
  };
  EXPECT_EQ(FindLoadSteps(Cycled(10, level)).size(), 2U);
  EXPECT_EQ(FindLoadSteps(Cycled(10, drifting)).size(), 0U);
  EXPECT_EQ(FindLoadSteps(Cycled(10, drifting_later)).size(), 0U);
}

TEST(LoadSteps, MakeARecordForEachConstantLoad) {
  const std::vector<ConstantLoad> pieces = FindLoadSteps(Cycled(15, Staircase));
  ExpectThreeLoads(pieces, 0.0);
  // From the start, and else from where the sine turns for the second time after the step.
  const std::size_t first[] = {0, 5 * kCycle + kSecondTurn, 10 * kCycle + kSecondTurn};
  const std::size_t last[] = {5 * kCycle, 10 * kCycle, 15 * kCycle + 1};
  for (std::size_t p = 0; p < 3; ++p) {
    EXPECT_EQ(pieces[p].first, first[p]);
    EXPECT_EQ(pieces[p].last, last[p]);
  }
}

TEST(LoadSteps, AreFoundUnderNoiseAndSpikes) {
  Record record = WithNoise(Cycled(15, Staircase), 0.01);
  for (const std::size_t spike : {300U, 1500U, 2200U}) record.normal_load[spike] = 500;
  // A median of a thousand readings of 1 %.
  ExpectThreeLoads(FindLoadSteps(record), 0.003);
}

TEST(LoadSteps, LeaveTheRampsBetweenThemOut) {
  const Record record = Cycled(17, [](double cycle) {
    if (cycle < 5) return 20.0;
    if (cycle < 6) return 20 + 30 * (cycle - 5);
    if (cycle < 11) return 50.0;
    if (cycle < 12) return 50 + 50 * (cycle - 11);
    return 100.0;
  });
  const std::vector<ConstantLoad> pieces = FindLoadSteps(record);
  ExpectThreeLoads(pieces, 0.0);
  // Constant to 1 %, half of which is taken for settled: 0.1 of 20 N and 0.25 of 50 N of a ramp.
  for (const ConstantLoad& piece : pieces) {
    for (std::size_t i = piece.first; i < piece.last; ++i) {
      EXPECT_NEAR(record.normal_load[i] / piece.normal_load, 1.0, 0.005);
    }
  }
  EXPECT_EQ(pieces[1].first, 6 * kCycle + kSecondTurn);
  EXPECT_EQ(pieces[2].first, 12 * kCycle + kSecondTurn);
}

TEST(LoadSteps, ComeDownAgainTooAndLeaveOutALoadThatHasNoCycle) {
  const auto load = [](double newton) { return Field(&ConstantLoad::normal_load, newton); };
  EXPECT_THAT(
      FindLoadSteps(Cycled(12, [](double cycle) { return cycle > 4 && cycle < 8 ? 80 : 40; })),
      ElementsAre(load(40), load(80), load(40)));
  EXPECT_THAT(
      FindLoadSteps(Cycled(11, [](double cycle) { return cycle < 5   ? 20
                                                         : cycle < 6 ? 50
                                                                     : 100; })),
      ElementsAre(load(20), load(100)));
}

TEST(LoadSteps, AreNotSeenInALoadThatChangesSlowlyOrSwingsNorWhereTheyAreSmall) {
  const auto sine = [](double share, double period) {
    return [=](double cycle) {
      return 50 * (1 + share * std::sin(2 * std::numbers::pi * cycle / period));
    };
  };
  for (const double share : {0.01, 0.03, 0.035, 0.04, 0.06, 0.1, 0.15, 0.3, 0.8}) {
    for (const double period : {0.5, 1.0, 7.3, 40.0, 120.0}) {
      EXPECT_TRUE(FindLoadSteps(Cycled(120, sine(share, period))).empty())
          << share << ' ' << period;
    }
  }
  for (const double total : {0.02, 0.1, 0.5, 3.0}) {
    EXPECT_TRUE(
        FindLoadSteps(Cycled(60, [&](double cycle) { return 50 * (1 + total * cycle / 60); }))
            .empty())
        << total;
  }
  EXPECT_TRUE(FindLoadSteps(WithNoise(Cycled(20, [](double) { return 50.0; }), 0.02)).empty());
  const std::vector<std::pair<const char*, std::function<double(double)>>> loads = {
      {"as fast as the motion", [](double cycle) { return std::fmod(cycle, 1) < 0.5 ? 40 : 60; }},
      {"a small step", [](double cycle) { return cycle < 10 ? 50 : 52; }},
      {"drifts", [](double cycle) { return (cycle < 10 ? 50 : 100) * (1 + 0.01 * cycle); }},
      {"unloaded for half of the time", [](double cycle) { return cycle < 10 ? 0 : 50; }}};
  for (const auto& [name, load] : loads)
    EXPECT_TRUE(FindLoadSteps(Cycled(20, load)).empty()) << name;
  Record without = Cycled(3, Staircase);
  without.normal_load.clear();
  EXPECT_TRUE(FindLoadSteps(without).empty());
}

double RampUpAndDown(double cycle) {
  return cycle < 2 ? 10 + 20 * cycle : cycle < 14 ? 50.0 : 50 - 20 * (cycle - 14);
}

TEST(SettledLoad, IsThatBetweenRampsFromTheSecondTurnOn) {
  const Record record = WithNoise(Cycled(15, RampUpAndDown), 0.001);
  const auto piece = FindSettledLoad(record);
  ASSERT_TRUE(piece);
  // Within 1 % to either side, and the noise, of 50 N the ramps of 20 N a cycle are for 0.05
  // cycles.
  EXPECT_NEAR(static_cast<double>(piece->first), 2.0 * kCycle + kSecondTurn, 0.05 * kCycle);
  EXPECT_NEAR(static_cast<double>(piece->last), 14.0 * kCycle, 0.05 * kCycle);
  EXPECT_NEAR(piece->normal_load / 50, 1, 0.001);
  EXPECT_TRUE(FindLoadSteps(record).empty());
}

TEST(SettledLoad, IsNoneOfALoadThatIsConstantThroughoutOrForTooLittle) {
  EXPECT_FALSE(FindSettledLoad(Cycled(15, [](double) { return 50.0; })));
  EXPECT_FALSE(FindSettledLoad(Cycled(15, [](double cycle) { return 20 + 80 * cycle / 15; })));
  // Of 15 cycles 8 are under 50 N, less than three fifths.
  EXPECT_FALSE(
      FindSettledLoad(Cycled(15, [](double cycle) { return cycle < 7 ? 15 + 5 * cycle : 50.0; })));
  Record unloaded = Cycled(15, RampUpAndDown);
  unloaded.normal_load.clear();
  EXPECT_FALSE(FindSettledLoad(unloaded));
}

}  // namespace
}  // namespace mindahl::loop::load_steps_test
