#include "cli/file_list.h"

#include <fmt/format.h>

#include <filesystem>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

namespace mindahl::cli::file_list_test {
namespace {

TEST(FilesOf, AreTheNamedOnesAndThoseOfTheListInOrder) {
  const TemporaryDirectory directory;
  const std::string list = directory.Write("list", "b.csv\r\n# not this\n\nc d.csv").string();
  EXPECT_THAT(FilesOf({"a.csv"}, {.list = list, .shard = ""}),
              ElementsAre("a.csv", "b.csv", "c d.csv"));
}

TEST(FilesOf, ArePartsThatAreAllFilesOnceHoweverManyTheyAre) {
  std::vector<std::string> files;
  for (int i = 0; i < 7; ++i) files.push_back(std::to_string(i));
  for (const int parts : {1, 2, 3, 7, 10}) {
    std::vector<std::string> all;
    for (int part = 1; part <= parts; ++part) {
      const std::string shard = std::to_string(part) + "/" + std::to_string(parts);
      const std::vector<std::string> of_part = FilesOf(files, {.list = "", .shard = shard});
      EXPECT_LE(of_part.size(), (files.size() - 1) / static_cast<std::size_t>(parts) + 1) << shard;
      all.insert(all.end(), of_part.begin(), of_part.end());
    }
    EXPECT_EQ(all, files) << parts;
  }
}

TEST(FilesOf, RefuseWhatIsNoShardAndNoList) {
  for (const char* shard :
       {"0/2", "3/2", "1", "1/", "/2", "a/b", "-1/2", "1/2/3", "1/0", "1.5/2"}) {
    try {
      FilesOf({"a.csv"}, {.list = "", .shard = shard});
      ADD_FAILURE() << shard;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("must be K/N with 1 <= K <= N"));
    }
  }
  const TemporaryDirectory directory;
  EXPECT_THROW(FilesOf({}, {.list = directory.Write("list", "# none\n").string(), .shard = ""}),
               InputError);
  EXPECT_THROW(FilesOf({}, {.list = (directory.path() / "absent").string(), .shard = ""}),
               InputError);
  EXPECT_THROW(FilesOf({}, {}), InputError);
}

/// Simulates a short loop of another slip force each.
std::string WriteRecord(const TemporaryDirectory& directory, int number) {
  std::string path = (directory.path() / ("r" + std::to_string(number) + ".csv")).string();
  const Outcome made =
      RunCommand({"simulate", "--sigma", "5e7", "--slip-force", std::to_string(50 + number),
                  "--amplitude", "2.5e-6", "--cycles", "4", "--samples-per-cycle", "24",
                  "--noise-force", "0.3", "--seed", std::to_string(number), "-o", path});
  EXPECT_EQ(made.status, kDone) << made.err;
  return path;
}

TEST(BatchShards, MakeTheTableOfAllFilesWhateverTheirNumber) {
  const TemporaryDirectory directory;
  std::string names;
  for (int i = 0; i < 3; ++i) names += WriteRecord(directory, i) + "\n";
  const std::string list = directory.Write("list", names).string();
  const auto table_of = [&](const std::string& shard) {
    const std::string output = (directory.path() / "table.csv").string();
    std::vector<std::string> words = {"batch", "--files-from", list,        "--output",
                                      output,  "--overwrite",  "--threads", "1"};
    if (!shard.empty()) words.insert(words.end(), {"--shard", shard});
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, kDone) << outcome.err;
    return FileContent(output);
  };
  const std::string whole = table_of("");
  const std::size_t header = whole.find('\n') + 1;
  for (const int parts : {2, 4}) {  // the last of which leave one without a file
    std::string joined = whole.substr(0, header);
    for (int part = 1; part <= parts; ++part) {
      const std::string table = table_of(std::to_string(part) + "/" + std::to_string(parts));
      EXPECT_EQ(table.substr(0, header), whole.substr(0, header));
      joined += table.substr(header);
    }
    EXPECT_EQ(joined, whole) << parts;
  }
}

TEST(TrackedFiles, AreTheSameFromAList) {
  const TemporaryDirectory directory;
  const std::string first = WriteRecord(directory, 0);
  const std::string second = WriteRecord(directory, 1);
  const std::string list = directory.Write("list", first + "\n" + second + "\n").string();
  const std::string named = (directory.path() / "named.csv").string();
  const std::string listed = (directory.path() / "listed.csv").string();
  EXPECT_EQ(RunCommand({"track", first, second, "--output", named}).status, kDone);
  EXPECT_EQ(RunCommand({"track", "--files-from", list, "--output", listed}).status, kDone);
  EXPECT_EQ(FileContent(named), FileContent(listed));
  const Outcome none = RunCommand({"track", "--output", listed, "--overwrite"});
  EXPECT_EQ(none.status, kBadInput);
  EXPECT_THAT(none.Errors(), SizeIs(1));
  EXPECT_THAT(none.err, HasSubstr("FILE is required"));
  EXPECT_THAT(none.out, IsEmpty());
}

/// Five tests: of more than two batches of 64 cycles, of a few, one whose record breaks off in a
/// row after its first batch, one that is not there, and one of a few cycles again.
class SeparateTests : public ::testing::Test {
 protected:
  SeparateTests() {
    for (const auto& [name, cycles] :
         {std::pair{"long", 140}, {"short", 4}, {"broken", 90}, {"last", 5}}) {
      files_.push_back(Path(name));
      const Outcome made =
          RunCommand({"simulate", "--sigma", "5e7", "--slip-force", std::to_string(50 + cycles % 7),
                      "--amplitude", "2.5e-6", "--cycles", std::to_string(cycles),
                      "--samples-per-cycle", "24", "--noise-force", "0.3", "-o", files_.back()});
      EXPECT_EQ(made.status, kDone) << made.err;
    }
    whole_record_ = FileContent(files_[2]);
    const std::size_t row = whole_record_.find('\n', whole_record_.size() * 5 / 6);
    directory_.Write("broken", whole_record_.substr(0, row) + "\n0,nothing,0\n");
    files_.insert(files_.end() - 1, Path("absent"));
  }

  std::string Path(const std::string& name) const { return (directory_.path() / name).string(); }

  Outcome Track(const std::string& output, std::vector<std::string> more) const {
    std::vector<std::string> words = {"track",      "--separate", "--output",
                                      Path(output), "--json",     "-"};
    words.insert(words.end(), files_.begin(), files_.end());
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words);
  }

  TemporaryDirectory directory_;
  std::vector<std::string> files_;
  std::string whole_record_;  // of the one that is broken
};

TEST_F(SeparateTests, HaveTheRowsOfEachTestTrackedAlone) {
  const Outcome outcome = Track("all.csv", {});
  EXPECT_EQ(outcome.status, kNotEstablished);
  const std::vector<std::string> rows = testing::Lines(FileContent(Path("all.csv")));
  EXPECT_EQ(rows[0].find('['), std::string::npos) << "names of columns need no quotes";
  std::size_t row = 1;
  for (const std::string& file : files_) {
    const std::string alone = Path("alone.csv");
    const Outcome single = RunCommand({"track", file, "--output", alone, "--overwrite"});
    if (file != Path("absent")) {
      const std::vector<std::string> expected = testing::Lines(FileContent(alone));
      for (std::size_t k = 1; k < expected.size(); ++k, ++row) {
        const std::string cells = expected[k].substr(0, expected[k].rfind(','));
        EXPECT_THAT(rows[row], ::testing::StartsWith(file + ","));
        EXPECT_THAT(rows[row], HasSubstr(",," + cells + ",")) << "no fault, then the same cells";
        EXPECT_THAT(rows[row], ::testing::EndsWith(",force"));
        EXPECT_EQ(testing::Cells(rows[row]).size(), testing::Cells(rows[0]).size());
      }
    }
    if (single.status == kDone) continue;
    EXPECT_THAT(rows[row], ::testing::StartsWith(file + ","));
    const std::size_t open = rows[row].find('"');  // the fault is quoted where it has a comma
    const std::string quoted =
        open == std::string::npos ? "" : rows[row].substr(open, rows[row].rfind('"') - open);
    EXPECT_EQ(std::ranges::count(rows[row], ',') - std::ranges::count(quoted, ','),
              std::ranges::count(rows[0], ','));
    EXPECT_THAT(rows[row++], HasSubstr(file == Path("absent") ? "cannot read" : "nothing"));
  }
  EXPECT_EQ(row, rows.size());
  const nlohmann::json json = outcome.Json();
  EXPECT_EQ(json["tests"].size(), files_.size());
  EXPECT_EQ(json["fits"], rows.size() - 3);  // but for the header and two faults
  EXPECT_TRUE(json["tests"][0]["fault"].is_null());
  EXPECT_TRUE(json["tests"][2]["fault"].is_string());
}

TEST_F(SeparateTests, MakeTheTableOfAllWhateverTheNumberOfShards) {
  Track("all.csv", {});
  const std::string whole = FileContent(Path("all.csv"));
  const std::size_t header = whole.find('\n') + 1;
  for (const int parts : {1, 2, 3, 7}) {  // of the last, two have no test
    std::string joined = whole.substr(0, header);
    for (int part = 1; part <= parts; ++part) {
      Track("part.csv", {"--overwrite", "--shard", fmt::format("{}/{}", part, parts)});
      const std::string table = FileContent(Path("part.csv"));
      EXPECT_EQ(table.substr(0, header), whole.substr(0, header));
      joined += table.substr(header);
    }
    EXPECT_EQ(joined, whole) << parts;
  }
}

TEST_F(SeparateTests, GoOnFromWhereverTheyWereKilled) {
  const nlohmann::json summary = Track("all.csv", {}).Json();
  const std::string whole = FileContent(Path("all.csv"));
  const std::size_t step = whole.size() / 11;
  for (std::size_t bytes = whole.size(); bytes > step; bytes -= step) {
    directory_.Write("all.csv", whole.substr(0, bytes));
    const Outcome outcome = Track("all.csv", {"--resume"});
    EXPECT_EQ(outcome.status, kNotEstablished) << outcome.err;
    EXPECT_EQ(FileContent(Path("all.csv")), whole) << bytes;
    EXPECT_EQ(outcome.Json(), summary) << bytes;
  }
}

TEST_F(SeparateTests, AreDoneAgainFromOneThatFailedOnceItsRecordIsRepaired) {
  Track("all.csv", {});
  directory_.Write("broken", whole_record_);
  EXPECT_EQ(Track("all.csv", {"--resume"}).status, kNotEstablished) << "one is still absent";
  Track("anew.csv", {});
  EXPECT_EQ(FileContent(Path("all.csv")), FileContent(Path("anew.csv")));
}

TEST_F(SeparateTests, RefuseToGoOnWithWhatWasMadeOtherwise) {
  Track("all.csv", {});
  const std::string whole = FileContent(Path("all.csv"));
  EXPECT_EQ(Track("all.csv", {"--resume", "--fix", "alpha=0.3"}).status, kBadInput);
  EXPECT_EQ(Track("all.csv", {"--resume", "--shard", "2/2"}).status, kBadInput);
  directory_.Write("short", whole_record_);
  const Outcome changed = Track("all.csv", {"--resume"});
  EXPECT_EQ(changed.status, kBadInput);
  EXPECT_THAT(changed.err, HasSubstr("another --output"));
  EXPECT_EQ(FileContent(Path("all.csv")), whole);
  files_.resize(2);
  EXPECT_EQ(Track("all.csv", {"--resume"}).status, kBadInput);
  EXPECT_EQ(FileContent(Path("all.csv")), whole);
}

TEST_F(SeparateTests, AreWhatShardsAreOf) {
  Track("with.csv", {"--shard", "1/2"});
  std::vector<std::string> words = {"track"};
  words.insert(words.end(), files_.begin(), files_.end());
  words.insert(words.end(), {"--shard", "1/2", "--output", Path("without.csv")});
  RunCommand(words);
  EXPECT_EQ(FileContent(Path("without.csv")), FileContent(Path("with.csv")));
  EXPECT_EQ(Track("no.csv", {"--plot", Path("no.svg")}).status, kBadInput);
  EXPECT_EQ(Track("no.csv", {"--join"}).status, kBadInput);
}

}  // namespace
}  // namespace mindahl::cli::file_list_test
