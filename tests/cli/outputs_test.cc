#include <filesystem>
#include <fstream>

#include "cli/command.h"
#include "cli/command_line.h"
#include "io/source.h"
#include "support/text.h"

// Tests the outputs: none replaces an input or another output, one that cannot be written is an
// error, and --report writes a page.
namespace mindahl::cli::outputs_test {
namespace {

using Outputs = CommandTest;
using ReportPage = CommandTest;

TEST_F(Outputs, AreNotWrittenOverWhatIsReadUnderAnyName) {
  const std::string record = Copy("loop.csv");
  const std::string content = FileContent(record);
  std::filesystem::create_symlink(record, Path("link.csv"));
  std::filesystem::create_hard_link(record, Path("hard.csv"));
  for (const std::string& fit : {"fit " + record + " --json ", "fit " + record + " --residuals "}) {
    for (const char* name : {"loop.csv", "./loop.csv", "link.csv", "hard.csv"}) {
      ExpectRefused(fit + Path(name), "which it would replace");
    }
  }
  ExpectRefused("batch " + record + " --output " + record, "");
  EXPECT_EQ(FileContent(record), content);
  ExpectRefused("fit " + record + " " + record, "are one file");
  ExpectRefused("fit " + record + " " + Path("link.csv"), "are one file");

  const std::string path = Write("path.csv", "x [m]\n0\n1e-6\n0\n");
  for (const char* command : {"simulate -o ", "tradeoff --csv "}) {
    ExpectRefused((command + path + " --path " + path) + kMindlinOptions, "which it would replace");
  }
  const std::string config = Write("fit.toml", "model = \"mindlin\"\n");
  ExpectRefused("fit " + SampleRecord() + " --config " + config + " --json " + config,
                "which it would replace");
  EXPECT_EQ(FileContent(config), "model = \"mindlin\"\n");
}

TEST_F(Outputs, AreNotWrittenOverEachOther) {
  ExpectRefused("fit " + SampleRecord() + " --json " + Path("out") + " --residuals " + Path("out"),
                "is another output too");
  EXPECT_EQ(directory_.FileCount(), 0u);
  Done("fit " + SampleRecord() + " --json /dev/null --residuals /dev/null");
}

TEST(StandardOutput, ThatIsFullOrClosedIsAnError) {
  for (const std::string command : {"--help", "--version", "fit --help",
                                    "contact --friction 0.3 --normal-load 1 "
                                    "--contact-radius 1e-4 --compliance 4e-11"}) {
    SCOPED_TRACE(command);
    std::ofstream full("/dev/full");
    ASSERT_TRUE(full.is_open());
    const Outcome on_full_disk = RunCommand(command, &full);
    EXPECT_EQ(on_full_disk.status, kBadInput);
    EXPECT_THAT(on_full_disk.err, HasSubstr("cannot write to standard output: No space left"));
    std::ofstream closed;
    const Outcome on_closed = RunCommand(command, &closed);
    EXPECT_EQ(on_closed.status, kBadInput);
    EXPECT_THAT(on_closed.err, HasSubstr("cannot write to standard output"));
  }
  for (const Words& words :
       {Words("fit " + SampleRecord()), Words("fit --json - " + SampleRecord()),
        "simulate --lambda 1" + kMindlinOptions,
        "simulate --lambda 1 --cycles 500" + kMindlinOptions}) {
    std::ofstream full("/dev/full");
    EXPECT_EQ(RunCommand(words, &full).status, kBadInput) << ::testing::PrintToString(words);
  }
  EXPECT_EQ(RunCommand("fit " + SampleRecord() + " --json /dev/full").status, kBadInput);
}

TEST_F(Outputs, ToStandardOutputAreThoseOfTextAlone) {
  for (const char* option : {"--residuals", "--report"}) {
    ExpectRefused("fit " + SampleRecord() + " " + option + " -",
                  std::string(option) + ": '-' is standard output");
  }
  ExpectRefused("batch " + SampleRecord() + " --output -", "--output: '-' is standard output");
  EXPECT_THAT(Done("simulate --lambda 1 --output -" + kMindlinOptions).out, StartsWith("time"));
}

TEST_F(ReportPage, OfAFitSaysTheVerdictAndWhatItWasMadeFrom) {
  const std::string record = Copy("it's <loop>.csv");
  const std::string config = Write("fit.toml", "terms = \"force_drift\"\n");
  Done({"--config", config, "fit", record, "--normal-load", "50", "--report", Path("out.html")});
  const std::string page = FileContent(Path("out.html"));
  EXPECT_THAT(page, HasSubstr("<h1>it&#39;s &lt;loop&gt;.csv: adequate</h1>"));
  EXPECT_THAT(page, Not(HasSubstr("<loop>")));
  EXPECT_THAT(page, HasSubstr("--normal-load 50 --report"));
}

TEST_F(ReportPage, OfABatchIsAnIndexAndAPageAFile) {
  std::filesystem::create_directory(Path("a"));
  std::filesystem::create_directory(Path("b"));
  const std::string broken = Write("index.csv", "x,F\n1,none\n");
  const Outcome outcome =
      RunCommand({"batch", Copy("a/loop.csv"), Copy("b/loop.csv"), broken, "--model", "mindlin",
                  "--output", Path("table.csv"), "--report", Path("pages")});
  EXPECT_EQ(outcome.status, kNotEstablished) << outcome.err;
  const std::string index = FileContent(Path("pages/index.html"));
  EXPECT_THAT(index, HasSubstr("<h1>2 of 3 files fitted</h1>"));
  EXPECT_THAT(index, HasSubstr("<a href=\"page-1.html\">"));
  EXPECT_THAT(index, HasSubstr("<a href=\"page-2.html\">"));
  EXPECT_THAT(index, HasSubstr("(column 2) holds no numbers"));
  EXPECT_FALSE(std::filesystem::exists(Path("pages/page-3.html")));
}

TEST(CommandLine, HasWordsInQuotesWhereAShellWouldTakeThemApart) {
  const std::array words = {"mindahl", "loop_1.csv", "my loop.csv", "it's", "", "$(rm)"};
  EXPECT_EQ(CommandLine(static_cast<int>(words.size()), words.data()),
            "mindahl loop_1.csv 'my loop.csv' 'it'\\''s' '' '$(rm)'");
}

}  // namespace
}  // namespace mindahl::cli::outputs_test
