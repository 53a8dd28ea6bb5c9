#include <filesystem>

#include "cli/command_line.h"

// mindahl batch: each file a fit of its own.
namespace mindahl::cli::batch_command_test {
namespace {

using Table = std::vector<std::vector<std::string>>;

class BatchCommand : public CommandTest {
 protected:
  /// A repeat of one test, with noise of its own.
  std::string Repeat(int seed) {
    return Simulated(fmt::format("--lambda 1.3 --cycles 3 --samples-per-cycle 240 "
                                 "--noise-force 0.27 --seed {}",
                                 seed),
                     fmt::format("repeat_{}.csv", seed));
  }
  std::string Content() const { return FileContent(Path("table.csv")); }
  static std::string Cell(const Table& table, std::size_t row, const std::string& column) {
    const auto place = std::ranges::find(table[0], column) - table[0].begin();
    return std::cmp_less(place, table[row].size()) ? table[row][static_cast<std::size_t>(place)]
                                                   : "";
  }
  /// The command, to table.csv.
  Words Batch(const Words& more) const {
    return Words{"batch", "--output", Path("table.csv")} + more;
  }
};

TEST_F(BatchCommand, SaysOfEachFileWhatFitSaysWithAnyNumberOfThreads) {
  const Words files = {Repeat(1), Repeat(2), Repeat(3)};
  const json batch = JsonOf(Batch(files + "--normal-load 50 --threads 1"));
  const std::string content = Content();
  const Table table = testing::Rows(content);
  ASSERT_EQ(table.size(), 4U);
  for (std::size_t k = 0; k < files.size(); ++k) {
    const json fit = JsonOf("fit " + files[k] + " --normal-load 50");
    EXPECT_EQ(batch["files"][k]["fit"], fit);
    EXPECT_EQ(Cell(table, k + 1, "file"), files[k]);
    EXPECT_EQ(Cell(table, k + 1, "done"), "yes");
    EXPECT_EQ(std::stod(Cell(table, k + 1, "sigma")), Value(fit, "sigma"));
    EXPECT_EQ(Cell(table, k + 1, "fault"), "");
  }
  for (const char* threads : {"2", "7"}) {
    Done(Batch(files + "--normal-load 50" + Words{"--threads", threads}));
    EXPECT_EQ(Content(), content);
  }
}

TEST_F(BatchCommand, ContinuesAfterAFileThatFails) {
  const std::string broken = Write("broken.csv", "x,F\n1,2\n3,oops\n");
  const Outcome outcome = RunCommand(Batch({broken, Path("absent.csv"), Repeat(1)}));
  EXPECT_EQ(outcome.status, kNotEstablished);
  const Table table = testing::Rows(Content());
  ASSERT_EQ(table.size(), 4U);
  EXPECT_EQ(Cell(table, 1, "done"), "no");
  EXPECT_EQ(Cell(table, 1, "sigma"), "");
  EXPECT_EQ(Cell(table, 2, "done"), "no");
  EXPECT_EQ(Cell(table, 3, "done"), "yes");
  EXPECT_THAT(outcome.err, HasSubstr("broken.csv:3:2: 'oops' is not a number"));
  EXPECT_THAT(outcome.err, HasSubstr("absent.csv"));
  EXPECT_THAT(outcome.out, HasSubstr("1 of 3 files fitted"));
}

TEST_F(BatchCommand, FailsAFileThatIsNotEstablishedWhereStrict) {
  const Words small = Batch({Simulated("--lambda 0.05 --noise-force 0.13 --cycles 3")});
  Done(small);
  EXPECT_EQ(RunCommand(small + "--strict").status, kNotEstablished);
  EXPECT_EQ(Cell(testing::Rows(Content()), 1, "done"), "no");
}

}  // namespace
}  // namespace mindahl::cli::batch_command_test
