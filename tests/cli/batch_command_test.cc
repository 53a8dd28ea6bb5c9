#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// mindahl batch: each file a fit of its own.
namespace mindahl::batch_command_test {
namespace {

class BatchCommand : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (directory_.path() / name).string(); }

  /// A repeat of one test, with noise of its own; of another slip force where one is given.
  std::string Repeat(int seed, const std::string& slip_force = "15") {
    const std::string path = Path(fmt::format("repeat_{}.csv", seed));
    EXPECT_EQ(RunCommand({"simulate", "--sigma", "5e7", "--slip-force", slip_force, "--lambda",
                          "1.3", "--cycles", "3", "--samples-per-cycle", "240", "--noise-force",
                          "0.1", "--seed", std::to_string(seed), "-o", path})
                  .status,
              0);
    return path;
  }

  std::vector<std::vector<std::string>> Table() const {
    std::ifstream file(Path("table.csv"));
    std::vector<std::vector<std::string>> rows;
    for (std::string line; std::getline(file, line);) rows.push_back(Cells(line));
    return rows;
  }

  static std::string Cell(const std::vector<std::vector<std::string>>& table, std::size_t row,
                          const std::string& column) {
    for (std::size_t k = 0; k < table[0].size(); ++k) {
      if (table[0][k] == column && k < table[row].size()) return table[row][k];
    }
    return "";
  }

  Outcome Batch(const std::vector<std::string>& more) const {
    std::vector<std::string> words = {"batch", "--output", Path("table.csv")};
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words);
  }

  TemporaryDirectory directory_;
};

TEST_F(BatchCommand, RefusesATableInPlaceOfItsPagesBeforeAnythingIsMade) {
  const std::string record = Repeat(1);
  for (const std::string& report : {Path("both"), Path("./both")}) {
    const Outcome outcome =
        RunCommand({"batch", record, "--output", Path("both"), "--report", report});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("--output and --report both write to"), std::string::npos)
        << outcome.err;
  }
  EXPECT_EQ(RunCommand({"batch", record, "--output", Path("table.csv"), "--json", Path("both"),
                        "--report", Path("both")})
                .status,
            2);
  EXPECT_EQ(directory_.FileCount(), 1U) << "the record alone";
}

// A spreadsheet takes for a formula what begins with one of these.
TEST_F(BatchCommand, WritesNoNameOfAFileAsAFormula) {
  const std::string record = Repeat(1);
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::current_path(directory_.path());
  for (const char* name : {"=1+2.csv", "@x.csv"}) std::filesystem::copy_file(record, name);
  const Outcome outcome = Batch({"=1+2.csv", "@x.csv", "=none.csv"});
  std::filesystem::current_path(here);
  EXPECT_EQ(outcome.status, 3) << "one is not there";
  const std::vector<std::vector<std::string>> table = Table();
  ASSERT_EQ(table.size(), 4U);
  EXPECT_EQ(table[1][0], "./=1+2.csv");
  EXPECT_EQ(table[2][0], "./@x.csv");
  for (const std::vector<std::string>& row : table) {
    for (const std::string& cell : row) {
      EXPECT_TRUE(cell.empty() || std::string("=+@").find(cell[0]) == std::string::npos) << cell;
    }
  }
}

TEST_F(BatchCommand, WritesOverNothingUnasked) {
  const std::string record = Repeat(1);
  ASSERT_EQ(Batch({record}).status, 0);
  const std::vector<std::vector<std::string>> before = Table();
  const Outcome refused = Batch({record, Repeat(2)});
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.Errors().size(), 1U) << refused.err;
  EXPECT_NE(refused.err.find("table.csv exists: add --overwrite"), std::string::npos)
      << refused.err;
  EXPECT_EQ(Table(), before);
  EXPECT_EQ(Batch({record, Repeat(2), "--overwrite"}).status, 0);
  EXPECT_EQ(Table().size(), 3U);
}

TEST_F(BatchCommand, SaysOfEachFileWhatFitSays) {
  const std::vector<std::string> files = {Repeat(1), Repeat(2)};
  const Outcome outcome = Batch({files[0], files[1], "--normal-load", "50", "--json", "-"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto table = Table();
  ASSERT_EQ(table.size(), 3U);
  for (std::size_t k = 0; k < files.size(); ++k) {
    const nlohmann::json fit =
        RunCommand({"fit", files[k], "--normal-load", "50", "--json", "-"}).Json();
    EXPECT_EQ(outcome.Json()["files"][k]["fit"], fit);
    EXPECT_EQ(Cell(table, k + 1, "file"), files[k]);
    EXPECT_EQ(Cell(table, k + 1, "done"), "yes");
    EXPECT_EQ(Cell(table, k + 1, "adequacy"), "adequate");
    EXPECT_EQ(std::stod(Cell(table, k + 1, "sigma")),
              fit["parameters"]["sigma"]["value"].get<double>());
    EXPECT_EQ(std::stod(Cell(table, k + 1, "slip_force_upper95")),
              fit["parameters"]["slip_force"]["ci95"][1].get<double>());
    EXPECT_EQ(std::stod(Cell(table, k + 1, "half_gap")),
              fit["measured"]["half_gap"]["value"].get<double>());
    EXPECT_EQ(std::stod(Cell(table, k + 1, "friction_coefficient")),
              fit["contact"]["friction_coefficient"]["value"].get<double>());
    EXPECT_EQ(Cell(table, k + 1, "fault"), "");
  }
}

TEST_F(BatchCommand, ContinuesAfterAFileThatFails) {
  const std::string good = Repeat(1);
  const std::string broken = directory_.Write("broken.csv", "x,F\n1,2\n3,oops\n").string();
  const Outcome outcome = Batch({broken, Path("absent.csv"), good});
  EXPECT_EQ(outcome.status, 3);
  const auto table = Table();
  ASSERT_EQ(table.size(), 4U);
  EXPECT_EQ(Cell(table, 1, "done"), "no");
  EXPECT_EQ(Cell(table, 1, "sigma"), "");
  EXPECT_EQ(Cell(table, 2, "done"), "no");
  EXPECT_EQ(Cell(table, 3, "done"), "yes");
  EXPECT_NE(outcome.err.find("broken.csv:3:2: 'oops' is not a number"), std::string::npos);
  EXPECT_NE(outcome.err.find("absent.csv"), std::string::npos);
  EXPECT_NE(outcome.out.find("1 of 3 files fitted"), std::string::npos) << outcome.out;
}

TEST_F(BatchCommand, WritesTheSameWithAnyNumberOfThreads) {
  const std::vector<std::string> files = {Repeat(1), Repeat(2), Repeat(3)};
  const auto content = [&](const std::string& threads) {
    Batch({files[0], files[1], files[2], "--overwrite", "--threads", threads});
    std::ifstream file(Path("table.csv"));
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
  };
  const std::string one = content("1");
  EXPECT_EQ(content("2"), one);
  EXPECT_EQ(content("7"), one);
}

TEST_F(BatchCommand, FailsAFileThatIsNotEstablishedWhereStrict) {
  const std::string small = Path("small.csv");
  RunCommand({"simulate", "--sigma", "5e7", "--slip-force", "15", "--lambda", "0.05",
              "--noise-force", "0.05", "--cycles", "3", "-o", small});
  EXPECT_EQ(Batch({small}).status, 0);
  EXPECT_EQ(Batch({small, "--strict", "--overwrite"}).status, 3);
  EXPECT_EQ(Cell(Table(), 1, "done"), "no");
}

TEST_F(BatchCommand, RefusesOptionsBeforeAnyFile) {
  const std::string file = Repeat(1);
  const Outcome outcome = Batch({file, "--fix", "alpha=x"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_EQ(outcome.Errors().size(), 1U);
  EXPECT_FALSE(std::filesystem::exists(Path("table.csv")));
  EXPECT_EQ(RunCommand({"batch", file, "--output", file}).status, 2);
}

}  // namespace
}  // namespace mindahl::batch_command_test
