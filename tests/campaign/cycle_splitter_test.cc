#include "mindahl/campaign/cycle_splitter.h"

#include "campaign/test_record.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

namespace mindahl::campaign::cycle_splitter_test {
namespace {

loop::RecordView Part(const loop::Record& record, std::size_t begin, std::size_t end) {
  const auto part = [&](const std::vector<double>& values) {
    return std::span(values).subspan(begin, end - begin);
  };
  return {part(record.displacement), part(record.force), part(record.time)};
}

std::vector<Cycle> Split(const loop::Record& record, CycleSplitter splitter = CycleSplitter(0.0)) {
  std::vector<Cycle> cycles;
  splitter.Add(record, LinesOf(record), cycles);
  return cycles;
}

TEST(CycleSplitter, BeginsAndEndsCyclesAtEverySecondTurningPoint) {
  const loop::Record record = TestRecord(5);
  const std::vector<std::size_t> turns = loop::FindReversals(record.displacement, 0.0);
  const std::vector<Cycle> cycles = Split(record);
  ASSERT_EQ(cycles.size(), (turns.size() - 1) / 2);
  for (std::size_t k = 0; k < cycles.size(); ++k) {
    const std::size_t first = turns[2 * k];
    const std::size_t last = turns[2 * k + 2];
    EXPECT_EQ(cycles[k].number, k + 1);
    EXPECT_EQ(cycles[k].first_line, first + 2);
    ASSERT_EQ(cycles[k].record.size(), last - first + 1);
    EXPECT_EQ(cycles[k].record.displacement.front(), record.displacement[first]);
    EXPECT_EQ(cycles[k].record.force.back(), record.force[last]);
    EXPECT_EQ(cycles[k].record.time.front(), record.time[first]);
    EXPECT_TRUE(cycles[k].record.normal_load.empty());
  }
}

TEST(CycleSplitter, DoesNotMindHowTheSamplesArrive) {
  const loop::Record record = TestRecord(7);
  const std::vector<Cycle> whole = Split(record);
  const std::vector<std::size_t> lines = LinesOf(record);
  Generator generator(3);
  for (int trial = 0; trial < 50; ++trial) {
    CycleSplitter splitter(0.0);
    std::vector<Cycle> cycles;
    for (std::size_t begin = 0; begin < record.size();) {
      const std::size_t most = trial == 0 ? 1 : 1 + generator() % 300;
      const std::size_t end = std::min(begin + most, record.size());
      splitter.Add(Part(record, begin, end), std::span(lines).subspan(begin, end - begin), cycles);
      begin = end;
    }
    ASSERT_EQ(cycles.size(), whole.size());
    for (std::size_t k = 0; k < whole.size(); ++k) {
      EXPECT_EQ(cycles[k].number, whole[k].number);
      EXPECT_EQ(cycles[k].first_line, whole[k].first_line);
      EXPECT_EQ(cycles[k].record.displacement, whole[k].record.displacement);
      EXPECT_EQ(cycles[k].record.force, whole[k].record.force);
      EXPECT_EQ(cycles[k].record.time, whole[k].record.time);
    }
  }
}

TEST(CycleSplitter, KeepsSeveralCyclesTogether) {
  const std::vector<Cycle> cycles = Split(TestRecord(9), CycleSplitter(0.0, 3));  // 8 whole ones
  ASSERT_EQ(cycles.size(), 2U);
  EXPECT_EQ(cycles[0].number, 1U);
  EXPECT_EQ(cycles[1].number, 4U);
  EXPECT_EQ(cycles[1].record.size(), 3 * kCycleSamples + 1);
  EXPECT_EQ(cycles[1].cycles, 3U);
}

TEST(CycleSplitter, GivesTheWholeCyclesThatFillNoPieceAtTheEnd) {
  const loop::Record record = TestRecord(9);  // 8 whole ones, and a part
  const std::vector<std::size_t> lines = LinesOf(record);
  const std::vector<Cycle> single = Split(record);
  ASSERT_EQ(single.size(), 8U);
  for (const std::size_t piece : {std::size_t{37}, record.size()}) {
    CycleSplitter splitter(0.0, 3);
    std::vector<Cycle> cycles;
    for (std::size_t begin = 0; begin < record.size(); begin += piece) {
      const std::size_t end = std::min(begin + piece, record.size());
      splitter.Add(Part(record, begin, end), std::span(lines).subspan(begin, end - begin), cycles);
    }
    const std::size_t last = single.back().first_line - 2 + single.back().record.size() - 1;
    EXPECT_EQ(splitter.Restart(cycles), record.size() - last);
    ASSERT_EQ(cycles.size(), 3U);
    EXPECT_EQ(cycles[2].number, 7U);
    EXPECT_EQ(cycles[2].cycles, 2U);
    EXPECT_EQ(cycles[2].first_line, single[6].first_line);
    EXPECT_EQ(cycles[2].record.force.back(), single[7].record.force.back());
    EXPECT_EQ(splitter.cycles(), 8U);
  }
}

TEST(CycleSplitter, TakesNoNoiseForATurningPoint) {
  loop::Record record = TestRecord(6);
  Generator generator(5);
  constexpr double kNoise = 0.01 * kCycleReach;
  for (double& x : record.displacement) x += kNoise * testing::Uniform(generator, -1, 1);
  EXPECT_EQ(Split(record, CycleSplitter(4 * kNoise)).size(), 5U);
  EXPECT_GT(Split(record).size(), 5U);
}

TEST(CycleSplitter, EndsACycleWithItsFile) {
  const loop::Record record = TestRecord(3);
  CycleSplitter splitter(0.0);
  std::vector<Cycle> cycles;
  splitter.Add(record, LinesOf(record), cycles);
  const std::size_t of_one_file = cycles.size();
  // What is left goes on from the last turning point of a cycle.
  const std::size_t last = cycles.back().first_line - 2 + cycles.back().record.size() - 1;
  EXPECT_EQ(splitter.Restart(cycles), record.size() - last);
  EXPECT_EQ(cycles.size(), of_one_file);
  splitter.Add(record, LinesOf(record), cycles);
  ASSERT_EQ(cycles.size(), 2 * of_one_file);
  EXPECT_EQ(cycles[of_one_file].number, of_one_file + 1);
  EXPECT_EQ(cycles[of_one_file].record.force, cycles[0].record.force);
}

TEST(CycleSplitter, FindsNoCycleInAStroke) {
  loop::Record record;
  for (int i = 0; i < 100; ++i) {
    record.displacement.push_back(1e-8 * i);
    record.force.push_back(i);
  }
  EXPECT_TRUE(Split(record).empty());
}

TEST(ChooseGate, ChoosesTheForceSignTooForAllCyclesAndKeepsAGateThatIsGiven) {
  identification::FitOptions fit;
  const loop::ReversalGate gate = ChooseGate(TestRecord(3, 1, 0.0), fit);
  EXPECT_TRUE(fit.preparation.reversal_gate.has_value());
  EXPECT_EQ(fit.preparation.force_sense, 1);
  EXPECT_TRUE(gate.certain);
  fit.preparation.reversal_gate = 1e-7;
  EXPECT_EQ(ChooseGate(TestRecord(3, 1, 0.0), fit).gate, 1e-7);
  EXPECT_EQ(*fit.preparation.reversal_gate, 1e-7);
}

TEST(ReadHead, GoesOnUntilTheMotionHasTurnedEightTimes) {
  // Cycles of 60,000 rows of 13 bytes, a hundred of which are alike: pieces of 128 KiB and then of
  // 1 MiB have less than two each.
  std::string rows = "x [m],F [N]\n";
  for (int i = 0; i < 3000; ++i) {
    const double phase = 2 * std::numbers::pi * i / 600;
    const std::string row = std::to_string(std::sin(phase)).substr(0, 7) + "," +
                            std::to_string(std::sin(phase + 0.3)).substr(0, 4) + "\n";
    for (int k = 0; k < 100; ++k) rows += row;
  }
  const TemporaryDirectory directory;
  io::RecordStream stream(directory.Write("long.csv", rows));
  const io::Samples head = ReadHead(stream);
  const double gate = loop::ChooseReversalGate(head.displacement).gate;
  EXPECT_GE(loop::FindReversals(head.displacement, gate).size(), 8U);
}

TEST(CycleSplitter, RefusesWhatNothingCanBeSplitBy) {
  EXPECT_THROW(CycleSplitter(-1.0), InvalidArgument);
  EXPECT_THROW(CycleSplitter(0.0, 0), InvalidArgument);
}

}  // namespace
}  // namespace mindahl::campaign::cycle_splitter_test
