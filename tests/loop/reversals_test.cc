#include "mindahl/loop/reversals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <vector>

#include "../support/histories.h"
#include "../support/measured.h"
#include "mindahl/core/error.h"

namespace mindahl::loop {
namespace {

using testing::Generator;
using testing::History;
using testing::Normal;
using testing::Uniform;
using Indices = std::vector<std::size_t>;

History Sine(double cycles, std::size_t samples_per_cycle, double phase = 0.0) {
  const auto per_cycle = static_cast<double>(samples_per_cycle);
  History history(static_cast<std::size_t>(std::llround(cycles * per_cycle)) + 1);
  for (std::size_t i = 0; i < history.size(); ++i) {
    history[i] = std::sin(phase + 2 * std::numbers::pi * static_cast<double>(i) / per_cycle);
  }
  return history;
}

History WithNoise(Generator& generator, History history, double deviation) {
  for (double& displacement : history) displacement += deviation * Normal(generator);
  return history;
}

History Quantised(History history, double step) {
  for (double& displacement : history) displacement = step * std::round(displacement / step);
  return history;
}

std::size_t CountGated(const History& history) {
  return FindReversals(history, EstimateReversalGate(history)).size();
}

TEST(FindReversals, FindsEveryChangeOfDirectionWithoutAGate) {
  EXPECT_EQ(FindReversals(History{0, 2, 1, 3, -1, 0}, 0.0), (Indices{1, 2, 3, 4}));
}

TEST(FindReversals, FindsThemStartingDownwards) {
  EXPECT_EQ(FindReversals(History{0, -2, -1, -3, 1, 0}, 0.0), (Indices{1, 2, 3, 4}));
}

TEST(FindReversals, FindsNoneOnAMonotoneRecord) {
  EXPECT_TRUE(FindReversals(History{1, 2, 2, 5, 9}, 0.0).empty());
  EXPECT_TRUE(FindReversals(History{1, -2, -2, -5, -9}, 0.0).empty());
}

TEST(FindReversals, FindsNoneWhereNothingMoves) {
  EXPECT_TRUE(FindReversals(History{}, 0.0).empty());
  EXPECT_TRUE(FindReversals(History{3}, 0.0).empty());
  EXPECT_TRUE(FindReversals(History{3, 3, 3, 3}, 0.0).empty());
}

TEST(FindReversals, TakesTheFirstSampleOfADwell) {
  EXPECT_EQ(FindReversals(History{0, 0, 2, 2, 2, 1, 1, 4}, 0.0), (Indices{2, 5}));
}

TEST(FindReversals, ADwellOnTheWayIsNoReversal) {
  EXPECT_EQ(FindReversals(History{0, 1, 1, 2, 1, 1, 0}, 0.0), (Indices{3}));
}

TEST(FindReversals, TheEndsOfTheRecordAreNone) {
  EXPECT_EQ(FindReversals(History{5, 1, 4}, 0.0), (Indices{1}));
}

TEST(FindReversals, IgnoresRetreatsUpToTheGate) {
  const History history = {0, 5, 4, 6, 0};
  EXPECT_EQ(FindReversals(history, 1.0), (Indices{3}));  // a retreat of just the gate is none
  EXPECT_EQ(FindReversals(history, 0.999), (Indices{1, 2, 3}));
}

TEST(FindReversals, TheExtremumIsTheFarthestSampleNotTheOneThatLeavesTheGate) {
  EXPECT_EQ(FindReversals(History{0, 8, 10, 9.5, 9.8, 6, 3, 3.5, 2, 9}, 1.0), (Indices{2, 8}));
}

TEST(FindReversals, TheSideOfTheFirstOneIsFoundBeyondTheGateOnly) {
  // Within ±1 at first; then down and up again.
  EXPECT_EQ(FindReversals(History{0, 0.6, -0.3, 0.5, -3, 2}, 1.0), (Indices{4}));
}

TEST(FindReversals, AGateBeyondTheRangeLeavesNone) {
  EXPECT_TRUE(FindReversals(Sine(3, 100), 2.5).empty());
}

TEST(FindReversals, MaximaAndMinimaAlternateByMoreThanTheGate) {
  Generator generator(1);
  for (int i = 0; i < 2000; ++i) {
    const History history = testing::RandomHistory(generator);
    const double gate = i % 3 == 0 ? 0.0 : Uniform(generator, 0.0, 1.0);
    const Indices reversals = FindReversals(history, gate);
    for (std::size_t k = 1; k < reversals.size(); ++k) {
      ASSERT_LT(reversals[k - 1], reversals[k]);
      const double swing = history[reversals[k]] - history[reversals[k - 1]];
      ASSERT_GT(std::abs(swing), gate);
      if (k > 1) {
        const double before = history[reversals[k - 1]] - history[reversals[k - 2]];
        ASSERT_LT(swing * before, 0.0);
      }
      // Nothing between two reversals lies beyond either.
      const auto [low, high] = std::minmax(history[reversals[k]], history[reversals[k - 1]]);
      for (std::size_t j = reversals[k - 1]; j <= reversals[k]; ++j) {
        ASSERT_GE(history[j], low);
        ASSERT_LE(history[j], high);
      }
    }
  }
}

TEST(FindReversals, TheMirrorImageHasTheSameReversals) {
  Generator generator(2);
  for (int i = 0; i < 500; ++i) {
    History history = testing::RandomHistory(generator);
    const double gate = Uniform(generator, 0.0, 0.5);
    const Indices reversals = FindReversals(history, gate);
    for (double& displacement : history) displacement = -displacement;
    ASSERT_EQ(FindReversals(history, gate), reversals);
  }
}

TEST(FindReversals, RejectsAGateThatIsNoDistance) {
  const History history = {0, 1};
  EXPECT_THROW(FindReversals(history, -1e-9), InvalidArgument);
  EXPECT_THROW(FindReversals(history, std::numeric_limits<double>::quiet_NaN()), InvalidArgument);
  EXPECT_THROW(FindReversals(history, std::numeric_limits<double>::infinity()), InvalidArgument);
}

TEST(EstimateReversalGate, IsZeroOnCleanLoops) {
  for (const std::size_t samples : {20, 50, 200, 1000}) {
    for (const double cycles : {0.5, 1.0, 1.3, 5.0, 20.0}) {
      EXPECT_EQ(EstimateReversalGate(Sine(cycles, samples)), 0.0) << samples << ' ' << cycles;
    }
  }
  EXPECT_EQ(EstimateReversalGate(History{}), 0.0);
  EXPECT_EQ(EstimateReversalGate(History{1, 2, 1}), 0.0);
  EXPECT_EQ(EstimateReversalGate(History{2, 2, 2, 2, 2, 2}), 0.0);
}

TEST(EstimateReversalGate, KeepsCleanSmallInnerLoops) {
  // Ramps between ±1 with an inner loop of 1 to 30 % of the range on some, each of it many samples.
  Generator generator(3);
  for (int i = 0; i < 500; ++i) {
    History history = {0.0};
    const auto ramp_to = [&](double target, std::size_t samples) {
      const double from = history.back();
      for (std::size_t k = 1; k <= samples; ++k) {
        const double share = static_cast<double>(k) / static_cast<double>(samples);
        history.push_back(k == samples ? target : from + share * (target - from));
      }
    };
    const std::size_t samples = 20 + generator() % 200;
    for (int swing = 0; swing < 10; ++swing) {
      const double target = swing % 2 == 0 ? 1.0 : -1.0;
      if (generator() % 2 == 0) {
        const double middle = Uniform(generator, -0.5, 0.5);
        ramp_to(middle, samples / 2);
        ramp_to(middle - target * testing::LogUniform(generator, 0.01, 0.3), samples / 4);
      }
      ramp_to(target, samples);
    }
    ASSERT_EQ(EstimateReversalGate(history), 0.0) << "history " << i;
  }
}

TEST(EstimateReversalGate, IsZeroOnWhiteSequences) {
  Generator generator(4);
  for (int i = 0; i < 500; ++i) {
    ASSERT_EQ(EstimateReversalGate(testing::WhiteSequence(generator, 5 + generator() % 1000, 1.0)),
              0.0);
  }
}

TEST(EstimateReversalGate, IsZeroOnAllButAFewRandomWalks) {
  // Some walks of a few dozen steps do look like a noisy swing; 54 of 5000 were seen to.
  constexpr int kWalks = 1000;
  constexpr int kGated = 20;
  Generator generator(5);
  int gated = 0;
  for (int i = 0; i < kWalks; ++i) {
    if (EstimateReversalGate(testing::RandomWalk(generator, 5 + generator() % 1500, 1.0)) > 0) {
      ++gated;
    }
  }
  EXPECT_LE(gated, kGated);
}

TEST(EstimateReversalGate, CountsTheReversalsOfANoisySineAsOfTheCleanOne) {
  // Noise of 1e-5 to 3e-2 of the amplitude, 50 to 2000 samples a cycle, 1 to 10 cycles that begin
  // and end in mid-swing: an end within the noise of an extreme could be called either way.
  constexpr int kRecords = 500;
  Generator generator(6);
  for (int i = 0; i < kRecords; ++i) {
    const double noise = testing::LogUniform(generator, 1e-5, 3e-2);
    const auto samples = static_cast<std::size_t>(testing::LogUniform(generator, 50, 2000));
    const auto cycles = static_cast<double>(1 + generator() % 10);
    const double half_turns = static_cast<double>(generator() % 2) * std::numbers::pi;
    const History clean = Sine(cycles, samples, half_turns + Uniform(generator, -0.5, 0.5));
    ASSERT_EQ(CountGated(WithNoise(generator, clean, noise)), FindReversals(clean, 0.0).size())
        << "noise " << noise << ", " << samples << " samples a cycle, " << cycles << " cycles";
  }
}

TEST(EstimateReversalGate, WithoutItNoiseWouldMakeReversals) {
  Generator generator(7);
  const History noisy = WithNoise(generator, Sine(5, 1000), 0.01);
  EXPECT_GT(FindReversals(noisy, 0.0).size(), 1000U);
  EXPECT_EQ(CountGated(noisy), 10U);
}

TEST(EstimateReversalGate, SeesThroughEncoderSteps) {
  // The last digit flickers on a slow stretch.
  Generator generator(8);
  for (const double step : {1e-4, 1e-3, 1e-2}) {
    for (int i = 0; i < 100; ++i) {
      const History clean = Sine(5, 400, Uniform(generator, -0.5, 0.5));
      const History steps = Quantised(WithNoise(generator, clean, 0.3 * step), step);
      ASSERT_EQ(CountGated(steps), FindReversals(clean, 0.0).size()) << step;
    }
  }
}

TEST(EstimateReversalGate, ASlowDipOfTwoEncoderStepsIsNoise) {
  // At rest for 32 samples a step, so that differences show no noise and the dip is a slow one.
  constexpr double kStep = 1e-2;
  History history = Quantised(Sine(3, 20000), kStep);
  for (std::size_t i = 1000; i < 1100; ++i) history[i] -= 2 * kStep;
  EXPECT_EQ(FindReversals(history, 0.0).size(), 6U + 2U);
  EXPECT_EQ(CountGated(history), 6U);
}

TEST(EstimateReversalGate, AQuantisedSineNeedsNone) {
  EXPECT_EQ(FindReversals(Quantised(Sine(5, 400), 1e-3), 0.0).size(), 10U);
  EXPECT_EQ(CountGated(Quantised(Sine(5, 400), 1e-3)), 10U);
}

TEST(EstimateReversalGate, ScalesWithTheUnit) {
  Generator generator(9);
  const History noisy = WithNoise(generator, Sine(5, 500), 0.01);
  History scaled = noisy;
  for (double& displacement : scaled) displacement *= 0x1p-20;
  EXPECT_EQ(EstimateReversalGate(scaled), 0x1p-20 * EstimateReversalGate(noisy));
  EXPECT_GT(EstimateReversalGate(noisy), 0.0);
}

class MeasuredReversals : public ::testing::Test {
 protected:
  /// Rows of a measured record, or a skip.
  std::vector<std::vector<double>> Read(const std::string& file, char separator) {
    auto rows = testing::ReadMeasured(file, separator);
    if (!rows) {
      absent_ = "no " + testing::MeasuredPath(file);
      return {};
    }
    return *rows;
  }
  std::string absent_;
};

#define SKIP_WHERE_ABSENT() \
  if (!absent_.empty()) GTEST_SKIP() << absent_

TEST_F(MeasuredReversals, TribometerTurnsTwiceACycleDespiteDwells) {
  const auto rows = Read("tribometer/test_data_2.txt", '\t');
  SKIP_WHERE_ABSENT();
  History position;
  for (const auto& row : rows) {
    if (row[0] >= 20 && row[0] <= 60) position.push_back(row[2]);
  }
  // 10 cycles of 4 s from mid-swing, ±115 µm.
  const Indices reversals = FindReversals(position, EstimateReversalGate(position));
  EXPECT_EQ(reversals.size(), 20U);
  for (std::size_t k = 1; k < reversals.size(); ++k) {
    EXPECT_GT(std::abs(position[reversals[k]] - position[reversals[k - 1]]), 0.2);  // mm
  }
}

TEST_F(MeasuredReversals, SealsReverseNineteenTimesDespiteBackwardStepsOfTheLaser) {
  for (const char* file :
       {"seals/Circle_1bar.csv", "seals/O-ring257_3bar.csv", "seals/NAP310_5bar.csv"}) {
    const auto rows = Read(file, '\t');
    SKIP_WHERE_ABSENT();
    const History position = testing::Column(rows, 4);
    const Indices reversals = FindReversals(position, EstimateReversalGate(position));
    EXPECT_EQ(reversals.size(), 19U) << file;  // 9.5 cycles, out from rest
    for (std::size_t k = 1; k < reversals.size(); ++k) {
      EXPECT_GT(std::abs(position[reversals[k]] - position[reversals[k - 1]]), 37.0) << file;  // mm
    }
    EXPECT_GT(FindReversals(position, 0.0).size(), 100U) << "the gate has nothing to do";
  }
}

TEST_F(MeasuredReversals, CycloidalRampsReverseAsTheTestsWereRun) {
  const auto rows = Read("cycloidal/2024-07-12__16-46-43__torqueramp__conic_4pre1.csv", ',');
  SKIP_WHERE_ABSENT();
  // Eight ramps up and down: five of ±4 Nm, three of ±40 Nm.
  EXPECT_EQ(CountGated(testing::Column(rows, 1)), 16U);
}

TEST_F(MeasuredReversals, BandBrakeGrowsAndDecaysWithoutSpuriousReversals) {
  const auto rows = Read("band_brake/dataset-1_0.5Hz70lbtension.csv", ',');
  SKIP_WHERE_ABSENT();
  const History position = testing::Column(rows, 1);
  // 0.5 Hz for 18 s and a ramp at either end.
  EXPECT_EQ(CountGated(position), 17U);
  EXPECT_GT(FindReversals(position, 0.0).size(), 1000U) << "the gate has nothing to do";
}

}  // namespace
}  // namespace mindahl::loop
