#include "mindahl/loop/reversals.h"

#include "loop/excursions.h"
#include "support/histories.h"
#include "support/measured.h"
#include "support/prelude.h"

namespace mindahl::loop::reversals_test {
namespace {

using Indices = std::vector<std::size_t>;

std::size_t CountGated(const History& history) {
  return FindReversals(history, ChooseReversalGate(history).gate).size();
}

TEST(FindReversals, FindsTheFarthestSampleOfEachTurnBeyondTheGate) {
  struct Turns {
    std::string_view name;
    History history;
    double gate;
    Indices reversals;
  };
  for (const Turns& turns : std::initializer_list<Turns>{
           {"every change of direction", {0, 2, 1, 3, -1, 0}, 0.0, {1, 2, 3, 4}},
           {"none of a monotone record", {1, 2, 2, 5, 9}, 0.0, {}},
           {"nor downwards", {1, -2, -2, -5, -9}, 0.0, {}},
           {"none of nothing", {}, 0.0, {}},
           {"none of one sample", {3}, 0.0, {}},
           {"none at rest", {3, 3, 3, 3}, 0.0, {}},
           {"the first sample of a dwell", {0, 0, 2, 2, 2, 1, 1, 4}, 0.0, {2, 5}},
           {"no dwell within a stroke", {0, 1, 1, 2, 1, 1, 0}, 0.0, {3}},
           {"no retreat of just the gate", {0, 5, 4, 6, 0}, 1.0, {3}},
           {"but one beyond it", {0, 5, 4, 6, 0}, 0.999, {1, 2, 3}},
           {"not the sample that leaves the gate",
            {0, 8, 10, 9.5, 9.8, 6, 3, 3.5, 2, 9},
            1.0,
            {2, 8}},
           {"the side beyond the gate only", {0, 0.6, -0.3, 0.5, -3, 2}, 1.0, {4}}}) {
    EXPECT_EQ(FindReversals(turns.history, turns.gate), turns.reversals) << turns.name;
  }
}

TEST(FindReversals, MaximaAndMinimaAlternateByMoreThanTheGateAlsoInTheMirror) {
  Generator generator(1);
  for (int i = 0; i < 2000; ++i) {
    History history = testing::RandomHistory(generator);
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

TEST(ChooseReversalGate, IsZeroOnCleanLoops) {
  for (const double samples : {20, 50, 200, 1000}) {
    for (const double cycles : {0.5, 1.0, 1.3, 5.0, 20.0}) {
      EXPECT_EQ(ChooseReversalGate(Sine(cycles, samples)).gate, 0.0) << samples << ' ' << cycles;
    }
  }
  EXPECT_EQ(ChooseReversalGate(History{}).gate, 0.0);
  EXPECT_EQ(ChooseReversalGate(History{1, 2, 1}).gate, 0.0);
  EXPECT_EQ(ChooseReversalGate(History{2, 2, 2, 2, 2, 2}).gate, 0.0);
}

TEST(ChooseReversalGate, KeepsCleanSmallInnerLoops) {
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
    ASSERT_EQ(ChooseReversalGate(history).gate, 0.0) << "history " << i;
  }
}

TEST(ChooseReversalGate, IsZeroOnWhiteSequences) {
  Generator generator(4);
  for (int i = 0; i < 500; ++i) {
    const History sequence = testing::WhiteSequence(generator, 5 + generator() % 1000, 1.0);
    ASSERT_EQ(ChooseReversalGate(sequence).gate, 0.0) << "sequence " << i;
  }
}

TEST(ChooseReversalGate, CountsTheReversalsOfANoisySineAsOfTheCleanOne) {
  // Noise of 1e-5 to 3e-2 of the amplitude, 50 to 2000 samples a cycle, 1 to 10 cycles that begin
  // and end in mid-swing: an end within the noise of an extreme could be called either way.
  constexpr int kRecords = 500;
  Generator generator(6);
  for (int i = 0; i < kRecords; ++i) {
    const double noise = testing::LogUniform(generator, 1e-5, 3e-2);
    const auto samples = std::floor(testing::LogUniform(generator, 50, 2000));
    const auto cycles = static_cast<double>(1 + generator() % 10);
    const double half_turns = static_cast<double>(generator() % 2) * std::numbers::pi;
    const History clean = Sine(cycles, samples, half_turns + Uniform(generator, -0.5, 0.5));
    ASSERT_EQ(CountGated(WithNoise(generator, clean, noise)), FindReversals(clean, 0.0).size())
        << "noise " << noise << ", " << samples << " samples a cycle, " << cycles << " cycles";
  }
}

TEST(ChooseReversalGate, SeesThroughEncoderSteps) {
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

TEST(ChooseReversalGate, ASlowDipOfTwoEncoderStepsIsNoise) {
  // At rest for 32 samples a step, so that differences show no noise and the dip is a slow one.
  constexpr double kStep = 1e-2;
  History history = Quantised(Sine(3, 20000), kStep);
  for (std::size_t i = 1000; i < 1100; ++i) history[i] -= 2 * kStep;
  EXPECT_EQ(FindReversals(history, 0.0).size(), 6U + 2U);
  EXPECT_EQ(CountGated(history), 6U);
}

TEST(ChooseReversalGate, ScalesWithTheUnit) {
  Generator generator(9);
  const History noisy = WithNoise(generator, Sine(5, 500), 0.01);
  History scaled = noisy;
  for (double& displacement : scaled) displacement *= 0x1p-20;
  EXPECT_EQ(ChooseReversalGate(scaled).gate, 0x1p-20 * ChooseReversalGate(noisy).gate);
  EXPECT_GT(ChooseReversalGate(noisy).gate, 0.0);
}

/// Drives whose every turn counts, and what a gauge makes of them.
History TwoAmplitudes(double small, double samples_per_cycle) {
  History history = {0.0};
  for (int block = 0; block < 6; ++block) {
    const double amplitude = block % 2 == 0 ? 1.0 : small;
    const History cycles = Sine(2.0, samples_per_cycle);
    for (std::size_t i = 1; i < cycles.size(); ++i) history.push_back(amplitude * cycles[i]);
  }
  return history;
}

/// The gauge reads up to `depth` less for 1 to 12 samples, at one sample in `rarity`.
History WithStepsBack(Generator& generator, History history, double depth, std::size_t rarity) {
  for (std::size_t i = 2; i + 20 < history.size(); ++i) {
    if (generator() % rarity != 0) continue;
    const double step = depth * Uniform(generator, 0.1, 1.0);
    for (std::size_t left = 1 + generator() % 12; left > 0; --left) history[i++] -= step;
    i += 3;
  }
  return history;
}

TEST(ChooseReversalGate, KeepsTheSmallCyclesOfANoisyDriveOfTwoAmplitudes) {
  Generator generator(10);
  for (int i = 0; i < 200; ++i) {
    const double small = testing::LogUniform(generator, 0.1, 0.7);
    const auto samples = std::floor(testing::LogUniform(generator, 50, 1000));
    const History clean = TwoAmplitudes(small, samples);
    ASSERT_EQ(ChooseReversalGate(clean).gate, 0.0);
    const double noise = small * testing::LogUniform(generator, 1e-4, 1e-2);
    const History noisy = WithNoise(generator, clean, noise);
    const ReversalGate choice = ChooseReversalGate(noisy);
    ASSERT_EQ(FindReversals(noisy, choice.gate).size(), FindReversals(clean, 0.0).size())
        << small << ' ' << noise;
    ASSERT_TRUE(choice.certain) << small << ' ' << noise;
  }
}

TEST(ChooseReversalGate, IsZeroOnFewSamplesACycle) {
  // However the samples fall on the motion, and wherever the record ends.
  Generator generator(12);
  for (int i = 0; i < 500; ++i) {
    const double samples = Uniform(generator, 5, 12);
    const double phase = Uniform(generator, 0, 6.28);
    ASSERT_EQ(ChooseReversalGate(Sine(Uniform(generator, 2, 60), samples, phase)).gate, 0.0)
        << samples << ' ' << phase;
  }
}

TEST(ChooseReversalGate, SeesThroughStepsBackOfAGaugeOrIsNotSure) {
  // Up to 5 % of the amplitude for up to 12 samples. On a sine one that falls on a turning point
  // may look like a small smooth loop; at a constant speed none does.
  constexpr int kRecords = 200;
  constexpr int kMiscounted = 6;
  Generator generator(13);
  int miscounted = 0;
  int sure = 0;
  for (int i = 0; i < kRecords; ++i) {
    const auto samples = std::floor(testing::LogUniform(generator, 200, 1500));
    const History clean = Sine(5, samples, Uniform(generator, -0.5, 0.5));
    const double depth = testing::LogUniform(generator, 0.005, 0.05);
    const History read = WithStepsBack(generator, WithNoise(generator, clean, 1e-4), depth, 100);
    const ReversalGate choice = ChooseReversalGate(read);
    if (FindReversals(read, choice.gate).size() == FindReversals(clean, 0.0).size()) continue;
    ++miscounted;
    sure += choice.certain ? 1 : 0;
  }
  EXPECT_LE(miscounted, kMiscounted);
  EXPECT_LE(sure, 1);
}

TEST(ChooseReversalGate, ASingleNoisyStrokeHasNone) {
  Generator generator(15);
  for (int i = 0; i < 100; ++i) {
    History stroke(50 + generator() % 2000);
    for (std::size_t k = 0; k < stroke.size(); ++k) {
      stroke[k] = static_cast<double>(k) / static_cast<double>(stroke.size());
    }
    const double noise = testing::LogUniform(generator, 1e-5, 2e-2);
    ASSERT_EQ(CountGated(WithNoise(generator, stroke, noise)), 0U) << noise;
  }
}

TEST(MeasuredReversals, AreAsManyAsTheTestsWereRunWith) {
  struct Measured {
    const char* file;
    char separator;
    std::size_t column;
    std::size_t reversals;
  };
  for (const Measured& measured : {
           // 50 cycles from rest at one end, where the position settles by three steps of its
           // encoder, to rest at the same: the ends turn nothing.
           Measured{"tribometer/test_data_2.txt", '\t', 2, 99},
           // Eight ramps up and down: five of ±4 Nm, three of ±40 Nm; the second runs in jerks.
           {"cycloidal/2024-07-12__16-46-43__torqueramp__conic_4pre1.csv", ',', 1, 16},
           {"cycloidal/2024-07-10__16-31-56__torqueramp__split_runin5.csv", ',', 1, 16},
           // 0.5 Hz for 18 s and a ramp at either end.
           {"band_brake/dataset-1_0.5Hz70lbtension.csv", ',', 1, 17},
       }) {
    const auto rows = ReadMeasured(measured.file, measured.separator);
    if (!rows) GTEST_SKIP() << "no " << MeasuredPath(measured.file);
    EXPECT_EQ(CountGated(Column(*rows, measured.column)), measured.reversals) << measured.file;
  }
}

/// Nineteen reversals, each so far [mm] from the one before.
void ExpectNineteen(const History& position, double apart) {
  const ReversalGate choice = ChooseReversalGate(position);
  const Indices reversals = FindReversals(position, choice.gate);
  EXPECT_EQ(reversals.size(), 19U);
  for (std::size_t k = 1; k < reversals.size(); ++k) {
    EXPECT_GT(std::abs(position[reversals[k]] - position[reversals[k - 1]]), apart);
  }
}

TEST(MeasuredReversals, OfTheTribometerAreACycleApartDespiteDwells) {
  const auto rows = ReadMeasured("tribometer/test_data_2.txt", '\t');
  if (!rows) GTEST_SKIP() << "no measured record";
  History position;
  for (const auto& row : *rows) {
    if (row[0] >= 20 && row[0] <= 60) position.push_back(row[2]);
  }
  // 10 cycles of 4 s, ±115 µm, from rest at the lower end to rest there.
  ExpectNineteen(position, 0.2);
}

TEST(MeasuredReversals, OfSealsAreNineteenDespiteBackwardStepsOfTheLaser) {
  for (const char* seal :
       {"Circle_1bar", "Circle_2bar", "KDN_5bar", "Kidney_lc_7bar", "NAP310_5bar", "O-ring257_3bar",
        "Stadium_1bar", "rerun_1_O-ring257_5bar", "rerun_2_O-ring257_5bar",
        "rerun_3_O-ring257_5bar"}) {
    const auto rows = ReadMeasured("seals/" + std::string(seal) + ".csv", '\t');
    if (!rows) GTEST_SKIP() << "no measured record";
    const History position = Column(*rows, 4);
    EXPECT_TRUE(ChooseReversalGate(position).certain) << seal;
    SCOPED_TRACE(seal);
    ExpectNineteen(position, 35.0);  // 9.5 cycles, out from rest
  }
}

TEST(ReversalGate, IsAboveTheFlickerOfAnEncoderOfFewCountsAStroke) {
  // Two cycles over seven counts, whose readings flicker by one wherever a count ends.
  constexpr double kCount = 1e-6;
  Generator generator(3);
  for (int record = 0; record < 20; ++record) {
    std::vector<double> displacement;
    for (std::size_t i = 0; i <= 800; ++i) {
      const double place = 3.5 * std::sin(2 * std::numbers::pi * static_cast<double>(i) / 400);
      displacement.push_back(kCount * std::round(place + 0.2 * testing::Normal(generator)));
    }
    const ReversalGate gate = ChooseReversalGate(displacement);
    EXPECT_GE(gate.gate, 1.5 * kCount);
    EXPECT_EQ(FindReversals(displacement, gate.gate).size(), 4U) << record;
  }
}

// ---
// The staircase of the number of reversals over the gate.

TEST(FindExcursions, GiveTheNumberOfReversalsUnderEveryGate) {
  Generator generator(1);
  for (int i = 0; i < 2000; ++i) {
    const History history = testing::RandomHistory(generator);
    const auto excursions = FindExcursions(history);
    const auto count = [&](double gate) {
      std::size_t ends = 0;
      for (const Excursion& excursion : excursions) {
        if (excursion.range > gate) ends += excursion.reversals;
      }
      return ends == 0 ? 0 : ends - 1;  // one stroke is left, with a reversal at neither end
    };
    ASSERT_EQ(count(0.0), FindReversals(history, 0.0).size());
    for (const Excursion& excursion : excursions) {
      for (const double gate :
           {excursion.range * (1 - 1e-12), excursion.range, excursion.range * (1 + 1e-12)}) {
        ASSERT_EQ(count(gate), FindReversals(history, gate).size())
            << "history " << i << ", gate " << gate;
      }
    }
  }
}

TEST(FindExcursions, AreClosedLoopsAndTheTravelFromEndToEnd) {
  // 0 → 5 → 4 → 6 → −6 → −5: the loop 5 → 4, then three strokes.
  const auto excursions = FindExcursions(History{0, 5, 4, 6, -6, -5});
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

}  // namespace
}  // namespace mindahl::loop::reversals_test
