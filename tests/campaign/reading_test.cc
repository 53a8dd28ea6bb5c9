

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

TEST(ChooseGate, ChoosesTheForceSignTooForAllCycles) {
  const loop::Record record = Loop();
  identification::FitOptions fit;
  const loop::ReversalGate gate = ChooseGate(record, fit);
  EXPECT_TRUE(fit.preparation.reversal_gate.has_value());
  EXPECT_EQ(fit.preparation.force_sense, 1);
  EXPECT_EQ(gate.count, 6U);
  EXPECT_TRUE(gate.certain);
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

TEST(ChooseGate, KeepsAGateThatIsGiven) {
  identification::FitOptions fit;
  fit.preparation.reversal_gate = 1e-7;
  EXPECT_EQ(ChooseGate(Loop(), fit).gate, 1e-7);
  EXPECT_EQ(*fit.preparation.reversal_gate, 1e-7);
}

}  // namespace
}  // namespace mindahl::campaign::reading_test
