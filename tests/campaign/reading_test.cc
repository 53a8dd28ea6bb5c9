

#include "io/temporary_directory.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/loop/reversals.h"
#include "support/prelude.h"

namespace mindahl::campaign::reading_test {
namespace {

/// Three cycles of a loop that dissipates, one hundred samples each.
loop::Record Loop() {
  loop::Record record;
  for (int i = 0; i <= 300; ++i) {
    const double phase = 2 * std::numbers::pi * i / 100;
    record.displacement.push_back(1e-6 * std::sin(phase));
    record.force.push_back(std::sin(phase + 0.3));
  }
  return record;
}

TEST(Reading, ChoosesGateAndForceSignForAllCycles) {
  const loop::Record record = Loop();
  identification::FitOptions fit;
  const Reading reading = ChooseReading(record, fit);
  EXPECT_TRUE(fit.preparation.reversal_gate.has_value());
  EXPECT_EQ(fit.preparation.force_sense, 1);
  EXPECT_EQ(reading.gate.count, 6U);
  EXPECT_EQ(reading.samples, record.size());
  EXPECT_FALSE(reading.gate_is_given);
  EXPECT_FALSE(DoubtAbout(reading, "loop").has_value());
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
  EXPECT_GE(loop::ChooseReversalGate(head.displacement).count, 8U);
}

TEST(Reading, KeepsAGateThatIsGiven) {
  identification::FitOptions fit;
  fit.preparation.reversal_gate = 1e-7;
  const Reading reading = ChooseReading(Loop(), fit);
  EXPECT_TRUE(reading.gate_is_given);
  EXPECT_EQ(*fit.preparation.reversal_gate, 1e-7);
}

TEST(Reading, ReportsUncertainChoices) {
  Reading reading;
  reading.gate.certain = false;
  EXPECT_NE(DoubtAbout(reading, "loop.csv")
                ->find("loop.csv: the number of reversals is not "
                       "certain"),
            std::string::npos);
}

TEST(Reading, AsksForFewerCyclesToAverageOnlyWhereThereAreSome) {
  EXPECT_NO_THROW(RequireCycles(1, 1, {}, 0.0, "loop"));
  const auto message = [](std::size_t turns) -> std::string {
    Reading reading;
    reading.gate.count = turns;
    return MessageOf<InputError>([&] { RequireCycles(0, 5, reading, 0.0, "loop"); });
  };
  EXPECT_EQ(message(4), "--average 5: loop has only 4 reversals, two a cycle: average fewer");
  EXPECT_NE(message(1).find("loop: no whole cycle"), std::string::npos);
}

}  // namespace
}  // namespace mindahl::campaign::reading_test
