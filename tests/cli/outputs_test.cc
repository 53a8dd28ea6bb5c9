#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "cli/command_line.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"

// Where results go: no output replaces an input or another output, and what cannot be written is an
// error that is said.
namespace mindahl::cli::outputs_test {
namespace {

using Words = std::vector<std::string>;

class Outputs : public ::testing::Test {
 protected:
  std::string At(const char* name) const { return (directory_.path() / name).string(); }

  std::string Copy(const char* name) const {
    return directory_.Write(name, FileContent(SampleRecord())).string();
  }

  static void ExpectRefused(const Words& words, const std::string& message) {
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, cli::kBadInput) << message;
    EXPECT_THAT(outcome.out, IsEmpty());
    ASSERT_THAT(outcome.Errors(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.Errors().front(), HasSubstr(message));
  }

  TemporaryDirectory directory_;
};

TEST_F(Outputs, AreNotWrittenOverTheRecordUnderAnyName) {
  const std::string record = Copy("loop.csv");
  const std::string content = FileContent(record);
  std::filesystem::create_symlink(record, At("link.csv"));
  std::filesystem::create_hard_link(record, At("hard.csv"));
  for (const char* option : {"--json", "--residuals"}) {
    for (const std::string& path : {record, At("./loop.csv"), At("link.csv"), At("hard.csv")}) {
      ExpectRefused({"fit", record, option, path}, "which it would replace");
    }
  }
  EXPECT_EQ(FileContent(record), content);
}

TEST_F(Outputs, AreNotWrittenOverThePathOrTheConfiguration) {
  const std::string path = directory_.Write("path.csv", "x [m]\n0\n1e-6\n0\n").string();
  const Words law = {"--sigma", "4e7", "--slip-force", "40", "--path", path};
  for (const Words& words :
       std::vector<Words>{{"simulate", "-o", path}, {"tradeoff", "--csv", path}}) {
    Words all = words;
    all.insert(all.end(), law.begin(), law.end());
    ExpectRefused(all, "which it would replace");
  }
  const std::string config = directory_.Write("fit.toml", "model = \"mindlin\"\n").string();
  ExpectRefused({"fit", SampleRecord(), "--config", config, "--json", config},
                "which it would replace");
  EXPECT_EQ(FileContent(config), "model = \"mindlin\"\n");
}

TEST_F(Outputs, AreNotWrittenOverEachOther) {
  ExpectRefused({"fit", SampleRecord(), "--json", At("out"), "--residuals", At("./out")},
                "--json and --residuals both write to");
  ExpectRefused({"tradeoff", "--csv", At("out.svg"), "--plot", At("out.svg")},
                "--csv and --plot both write to");
  EXPECT_EQ(directory_.FileCount(), 0u);
}

TEST_F(Outputs, MayShareTheNullDevice) {
  const Outcome outcome =
      RunCommand({"fit", SampleRecord(), "--json", "/dev/null", "--residuals", "/dev/null"});
  EXPECT_EQ(outcome.status, cli::kDone) << outcome.err;
}

TEST_F(Outputs, AreNotMadeOfOneFileGivenTwice) {
  const std::string record = Copy("loop.csv");
  std::filesystem::create_symlink(record, At("link.csv"));
  ExpectRefused({"fit", record, record}, "are one file");
  ExpectRefused({"fit", record, At("link.csv")}, "are one file");
}

/// The status of a command whose standard output takes nothing, with its messages.
Outcome RunInto(std::ostream& out, Words words) {
  words.insert(words.begin(), "mindahl");
  std::vector<const char*> argv;
  for (const std::string& word : words) argv.push_back(word.c_str());
  std::ostringstream err;
  Outcome outcome;
  outcome.status = cli::Run(static_cast<int>(argv.size()), argv.data(), out, err);
  outcome.err = err.str();
  return outcome;
}

TEST_F(Outputs, OnStandardOutputThatIsFullOrClosedAreAnError) {
  const std::vector<Words> commands = {
      {"--help"},
      {"--version"},
      {"fit", "--help"},
      {"fit", SampleRecord()},
      {"fit", SampleRecord(), "--json", "-"},
      {"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "1"},
      {"simulate", "--sigma", "4e7", "--slip-force", "40", "--lambda", "1", "--cycles", "500"},
      {"contact", "--friction", "0.3", "--normal-load", "1", "--contact-radius", "1e-4",
       "--compliance", "4e-11"}};
  for (const Words& words : commands) {
    SCOPED_TRACE(::testing::PrintToString(words));
    std::ofstream full("/dev/full");
    ASSERT_TRUE(full.is_open());
    const Outcome on_full_disk = RunInto(full, words);
    EXPECT_EQ(on_full_disk.status, cli::kBadInput);
    EXPECT_THAT(on_full_disk.err, HasSubstr("cannot write to standard output: No space left"));
    std::ofstream closed;
    const Outcome on_closed = RunInto(closed, words);
    EXPECT_EQ(on_closed.status, cli::kBadInput);
    EXPECT_THAT(on_closed.err, HasSubstr("cannot write to standard output"));
  }
  const Outcome to_file = RunCommand({"fit", SampleRecord(), "--json", "/dev/full"});
  EXPECT_EQ(to_file.status, cli::kBadInput) << "or the two differ";
}

}  // namespace
}  // namespace mindahl::cli::outputs_test
