#include <set>

#include "mindahl/loop/disturbances.h"
#include "mindahl/loop/preparation.h"
#include "mindahl/loop/reversals.h"
#include "support/histories.h"
#include "support/measured.h"
#include "support/prelude.h"

// Samples that no contact and no drive has made, and those that some contact or drive has.
namespace mindahl::loop::glitches_test {
namespace {

History Resting(const History& history, std::size_t samples) {
  const std::vector<std::size_t> turns = FindReversals(history, 0.0);
  History resting;
  std::size_t next = 0;
  for (std::size_t i = 0; i < history.size(); ++i) {
    const bool turns_here = next < turns.size() && turns[next] == i;
    resting.insert(resting.end(), turns_here ? 1 + samples : 1, history[i]);
    next += turns_here ? 1 : 0;
  }
  return resting;
}

/// A contact that slips at a force of 1, of a stiffness that makes it slip soon or never.
Record Respond(Generator& generator, const History& displacement) {
  const std::vector<std::pair<const char*, double>> laws = {
      {"mindlin", 1.0 / 3}, {"jenkins", 0.0}, {"mindlin-dahl", Uniform(generator, 0.05, 3)}};
  const auto& [name, shape] = laws[generator() % laws.size()];
  const models::BranchLaw law{LogUniform(generator, 0.3, 300), shape, 1.0};
  Record record;
  record.displacement = displacement;
  record.force = testing::Respond(testing::Model(name), law, displacement);
  return record;
}

std::set<std::size_t> FindGlitches(const Record& record) {
  return FindAndInterpolate(record).glitches;
}

std::size_t CountIn(const Record& record) {
  const RecordView view = record;
  return Prepare({&view, 1}, {.reversal_gate = 0.0, .force_sense = 1})
      .records.front()
      .glitches.size();
}

/// Between one and so many.
double Cycles(Generator& generator, std::size_t most) {
  return static_cast<double>(1 + generator() % most);
}

TEST(FindGlitches, FindsNoneInCleanRecordsNorInNothing) {
  constexpr int kRecords = 200;
  struct Kind {
    const char* name;
    std::function<Record(Generator&)> make;
  };
  const std::vector<Kind> kinds = {
      {"Sine",
       [](Generator& g) { return Respond(g, Sine(Cycles(g, 20), LogUniform(g, 20, 2000))); }},
      {"FewSamplesACycle",
       [](Generator& g) { return Respond(g, Sine(Cycles(g, 50), Uniform(g, 5, 10), 0.3)); }},
      {"Triangle",
       [](Generator& g) { return Respond(g, Triangle(Cycles(g, 20), LogUniform(g, 5, 2000))); }},
      {"Noise",
       [](Generator& g) {
         Record record = Respond(g, Sine(Cycles(g, 20), LogUniform(g, 10, 1000)));
         record.displacement = WithNoise(g, record.displacement, LogUniform(g, 1e-5, 3e-2));
         record.force = WithNoise(g, record.force, LogUniform(g, 1e-5, 0.1));
         return record;
       }},
      {"Encoders",
       [](Generator& g) {
         Record record = Respond(g, Sine(Cycles(g, 20), LogUniform(g, 10, 3000)));
         const double step = LogUniform(g, 1e-4, 5e-2);
         record.displacement = WithNoise(g, record.displacement, (g() % 2 == 0 ? 0.0 : 0.3) * step);
         record.displacement = Quantised(record.displacement, step);
         record.force = Quantised(record.force, LogUniform(g, 1e-4, 0.1));
         return record;
       }},
      {"Rests",
       [](Generator& g) {
         Record record = Respond(g, Resting(Sine(3, LogUniform(g, 8, 1000)), 1 + g() % 100));
         if (g() % 2 == 0) record.force = WithNoise(g, record.force, LogUniform(g, 1e-5, 0.1));
         return record;
       }},
      {"AnyHistory", [](Generator& g) { return Respond(g, testing::RandomHistory(g)); }},
      {"SquareWaves",
       [](Generator& g) {
         History history;
         const std::size_t half = 1 + g() % 40;
         for (std::size_t i = 0; i < 10 * half; ++i) {
           history.push_back(i / half % 2 == 0 ? -1.0 : 1.0);
         }
         Record record = Respond(g, history);
         if (g() % 2 == 0) record.force = WithNoise(g, record.force, LogUniform(g, 1e-5, 0.1));
         return record;
       }},
      {"BeginsAtRestAtZero",
       [](Generator& g) {
         History history(g() % 50, 0.0);
         const History sine = Sine(3, LogUniform(g, 8, 500));
         history.insert(history.end(), sine.begin(), sine.end());
         return Respond(g, history);
       }},
      {"StickSlip",
       [](Generator& g) {
         // The slider holds, encoder and all, and then jumps with the force.
         Record record;
         const double stiffness = LogUniform(g, 5, 30);
         double slider = 0.0;
         for (const double drive : Triangle(4, LogUniform(g, 400, 4000))) {
           double force = stiffness * (drive - slider);
           if (std::abs(force) > 1) slider = drive - std::copysign(0.3 / stiffness, force);
           force = stiffness * (drive - slider);
           record.displacement.push_back(slider);
           record.force.push_back(force);
         }
         return record;
       }},
  };
  for (const Kind& kind : kinds) {
    Generator generator(1);
    for (int i = 0; i < kRecords; ++i) {
      ASSERT_TRUE(FindGlitches(kind.make(generator)).empty()) << kind.name << ' ' << i;
    }
  }
  EXPECT_TRUE(FindGlitches(Record{}).empty());
  EXPECT_TRUE(FindGlitches(Record{{0, 0}, {0, 0}, {}, {}}).empty());
}

/// Five cycles of 200 samples with gross slip, and noise of 0.3 % in both channels.
Record Noisy(std::uint64_t seed = 1) {
  Generator generator(seed);
  Record record;
  record.displacement = Sine(5, 200, 0.2);
  record.force =
      testing::Respond(testing::Model("mindlin"), {20, 1.0 / 3, 1.0}, record.displacement);
  record.displacement = WithNoise(generator, record.displacement, 3e-3);
  record.force = WithNoise(generator, record.force, 3e-3);
  return record;
}

TEST(FindGlitches, FindsSpikesOfOneToThreeSamplesWhereTheyAre) {
  for (const std::size_t at : {std::size_t{5}, std::size_t{390}, std::size_t{995}}) {
    for (std::size_t samples = 1; samples <= 3; ++samples) {
      for (const double height : {-1.5, 1.5, 1000.0}) {
        for (History Record::*channel : {&Record::displacement, &Record::force}) {
          Record record = Noisy();
          for (std::size_t k = 0; k < samples; ++k) (record.*channel)[at + k] += height;
          std::set<std::size_t> spike;
          for (std::size_t k = 0; k < samples; ++k) spike.insert(at + k);
          EXPECT_EQ(FindGlitches(record), spike) << height;
        }
      }
    }
  }
}

TEST(FindGlitches, FindsLongSpikesOfAForceUnderAMotionInOneDirection) {
  const auto found_of = [](std::size_t at, std::size_t samples, double level) {
    Record record;
    record.displacement = Sine(5, 200);
    record.force =
        testing::Respond(testing::Model("mindlin"), {2, 1.0 / 3, 1.0}, record.displacement);
    std::fill_n(record.force.begin() + static_cast<std::ptrdiff_t>(at), samples, level);
    return FindGlitches(record).size();
  };
  for (const double level : {-40.0, 40.0}) {  // a bad reading, on a rising stroke
    for (const std::size_t samples : {4U, 8U, 20U})
      EXPECT_EQ(found_of(390, samples, level), samples);
    EXPECT_EQ(found_of(390, 21, level), 0U);
    EXPECT_EQ(found_of(445, 8, level), 0U);  // the motion turns within
  }
}

TEST(FindGlitches, FindsDropoutsOfAnyLength) {
  Generator generator(3);
  Record record = Noisy();
  for (double& displacement : record.displacement) displacement -= 110;  // far off
  std::set<std::size_t> zeros;
  for (std::size_t i = 0; i < record.size(); ++i) {
    if (i == 0 || i + 1 == record.size() || generator() % 20 != 0) continue;
    zeros.insert(i);
  }
  for (const std::size_t i : zeros) record.displacement[i] = record.force[i] = 0.0;
  EXPECT_EQ(FindGlitches(record), zeros);
  EXPECT_EQ(CountIn(record), zeros.size());
}

TEST(FindGlitches, AStepThatStaysAndARestAreNone) {
  Record step = Noisy();
  for (std::size_t i = 60; i < 68; ++i) step.force[i] = 5.0;
  for (std::size_t i = 68; i < step.size(); ++i) step.force[i] += 10.0;
  EXPECT_EQ(CountIn(step), 0U);
  Record rest = Noisy();
  for (std::size_t i = 60; i < 68; ++i) {
    rest.force[i] = 5.0;
    rest.displacement[i] = rest.displacement[60];
  }
  EXPECT_EQ(CountIn(rest), 0U);
}

TEST(FindAndInterpolate, InterpolatesLinearlyInChannelsWithGlitches) {
  Record record = Noisy();
  record.force[300] = 50;
  record.force[301] = 51;
  const Interpolated interpolated = FindAndInterpolate(record);
  EXPECT_TRUE(interpolated.displacement.empty());
  ASSERT_EQ(interpolated.force.size(), record.size());
  const double rise = record.force[302] - record.force[299];
  EXPECT_DOUBLE_EQ(interpolated.force[300], record.force[299] + rise / 3);
  EXPECT_DOUBLE_EQ(interpolated.force[301], record.force[299] + 2 * rise / 3);
  EXPECT_EQ(interpolated.force[302], record.force[302]);
}

TEST(FindGlitches, MeasuredRecordsHaveHardlyAny) {
  // The laser of some seals steps back for a sample or three.
  std::size_t spikes = 0;
  for (const char* seal : {"Circle_2bar", "KDN_5bar", "NAP310_5bar", "Stadium_1bar"}) {
    const std::string file = "seals/" + std::string(seal) + ".csv";
    const auto rows = testing::ReadMeasured(file, '\t');
    if (!rows) GTEST_SKIP() << "no " << testing::MeasuredPath(file);
    Record record;
    record.displacement = testing::Column(*rows, 4);
    record.force = testing::Column(*rows, 6);
    spikes += CountIn(record);
  }
  EXPECT_LE(spikes, 20U);
}

bool HasGlitch(const Record& record) { return !FindAndInterpolate(record).glitches.empty(); }

/// A triangle in steps of 1 and −1 with a force that follows it.
Record Steps(std::size_t samples) {
  Record record;
  for (std::size_t i = 0; i < samples; ++i) {
    const auto at = static_cast<double>(i % 200);
    record.displacement.push_back(7 + (at < 100 ? at : 200 - at));
    record.force.push_back(5 + 2 * record.displacement.back());
  }
  return record;
}

bool HasSpike(double height, std::size_t samples) {
  Record record = Steps(90);
  for (std::size_t k = 0; k < samples; ++k) record.displacement[40 + k] += height;
  return HasGlitch(record);
}

bool HasDropout(double level) {
  constexpr std::size_t kAt = 20;
  Record record = Steps(90);
  const double shift = level - record.displacement[kAt];
  for (double& displacement : record.displacement) displacement += shift;
  for (double& force : record.force) force = 0.01 * (force - record.force[kAt]);
  // Its neighbours are at `level` and beyond.
  record.displacement[kAt + 1] = record.force[kAt + 1] = 0.0;
  return HasGlitch(record);
}

TEST(FindGlitches, HoldsToItsRules) {
  // Over the farther neighbour, which is a step higher.
  EXPECT_TRUE(HasSpike(3.5 + 1, 1));
  EXPECT_FALSE(HasSpike(2.5 + 1, 1));
  EXPECT_TRUE(HasSpike(50, 3));
  EXPECT_FALSE(HasSpike(50, 4));
  EXPECT_TRUE(HasDropout(2.5));
  EXPECT_FALSE(HasDropout(1.5));
}

TEST(FindGlitches, APulseThatComesAgainSoonIsNoSpike) {
  // The first of five pulses of two samples, so many apart, is one of a kind if two others are
  // near.
  const auto has = [&](std::size_t apart) {
    Record record = Steps(900);
    for (std::size_t pulse = 0; pulse < 5; ++pulse) {
      record.displacement[200 + pulse * apart] += 50;
      record.displacement[201 + pulse * apart] += 50;
    }
    return FindGlitches(record).contains(200);
  };
  EXPECT_FALSE(has(5));
  EXPECT_TRUE(has(9));
}

TEST(FindGlitches, WhatMakesUpMoreThanAQuarterOfARecordIsTheRecord) {
  const auto has = [&](std::size_t every) {
    Record record = Steps(900);
    for (std::size_t i = 1; i < record.size(); i += every) {
      record.displacement[i] = record.force[i] = 0.0;
    }
    return HasGlitch(record);
  };
  EXPECT_TRUE(has(5));
  EXPECT_FALSE(has(3));
}

}  // namespace
}  // namespace mindahl::loop::glitches_test
