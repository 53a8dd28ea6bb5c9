#include "cli/file_list.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "mindahl/core/error.h"

namespace mindahl::cli::file_list_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::Outcome;
using testing::RunCommand;
using ::testing::SizeIs;

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

}  // namespace
}  // namespace mindahl::cli::file_list_test
