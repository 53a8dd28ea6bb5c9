#include <fmt/format.h>

#include <filesystem>

#include "cli/command_line.h"
#include "cli/output.h"
#include "io/source.h"
#include "io/temporary_directory.h"
#include "support/prelude.h"
#include "support/text.h"

// --report of fit, batch and track: pages for people.
namespace mindahl::cli::report_page_test {
namespace {

class ReportPage : public ::testing::Test {
 protected:
  std::string At(const std::string& name) const { return (directory_.path() / name).string(); }
  std::string Copy(const std::string& name) const {
    return directory_.Write(name, FileContent(SampleRecord())).string();
  }
  bool Exists(const std::string& name) const { return std::filesystem::exists(At(name)); }

  TemporaryDirectory directory_;
};

TEST_F(ReportPage, OfAFitSaysTheVerdictAndWhatItWasMadeFrom) {
  const std::string record = Copy("it's <loop>.csv");
  const Outcome outcome = RunCommand(
      {"fit", record, "--normal-load", "50", "--terms", "force_drift", "--report", At("out.html")});
  ASSERT_EQ(outcome.status, kDone) << outcome.err;
  const std::string page = testing::Unbroken(FileContent(At("out.html")));
  EXPECT_THAT(page, HasSubstr("<h1>it&#39;s &lt;loop&gt;.csv: adequate</h1>"));
  EXPECT_THAT(page, Not(HasSubstr("<loop>")));
  EXPECT_THAT(page, HasSubstr(*io::Sha256OfFile(record)));
  EXPECT_THAT(page, HasSubstr("--normal-load 50 --terms force_drift --report"));
  EXPECT_THAT(page,
              HasSubstr("<th scope=\"row\">--terms</th><td class=\"words\">force_drift</td>"));
}

TEST_F(ReportPage, OfAConfigurationFileHasItsOptionsAndItsDigest) {
  const std::string config = directory_.Write("fit.toml", "model = \"mindlin\"\n").string();
  const Outcome outcome = RunCommand(
      {"--config", config, "fit", SampleRecord(), "--report", At("out.html"), "--json", "-"});
  ASSERT_EQ(outcome.status, kDone) << outcome.err;
  const std::string page = testing::Unbroken(FileContent(At("out.html")));
  EXPECT_THAT(page, HasSubstr("<th scope=\"row\">--model</th><td class=\"words\">mindlin</td>"));
  EXPECT_THAT(page, HasSubstr(*io::Sha256OfFile(config)));
}

TEST_F(ReportPage, OfABatchIsAnIndexAndAPageAFile) {
  std::filesystem::create_directory(At("a"));
  std::filesystem::create_directory(At("b"));
  const std::string first = Copy("a/loop.csv");
  const std::string second = Copy("b/loop.csv");
  const std::string broken = directory_.Write("index.csv", "x,F\n1,none\n").string();
  const Outcome outcome = RunCommand({"batch", first, second, broken, "--model", "mindlin",
                                      "--output", At("table.csv"), "--report", At("pages")});
  EXPECT_EQ(outcome.status, kNotEstablished) << outcome.err;
  const std::string index = FileContent(At("pages/index.html"));
  EXPECT_THAT(index, HasSubstr("<h1>2 of 3 files fitted</h1>"));
  EXPECT_THAT(index, HasSubstr("<a href=\"loop.html\">"));
  EXPECT_THAT(index, HasSubstr("<a href=\"loop-2.html\">"));
  EXPECT_THAT(index, HasSubstr("(column 2) holds no numbers"));
  EXPECT_FALSE(Exists("pages/index-2.html"));
}

TEST_F(ReportPage, OfABatchNeedsADirectory) {
  const std::string record = Copy("loop.csv");
  const std::string file = directory_.Write("file", "").string();
  for (const std::string& path : {file, At("absent/pages")}) {
    const Outcome outcome =
        RunCommand({"batch", record, "--output", At("table.csv"), "--report", path});
    EXPECT_EQ(outcome.status, kBadInput);
    EXPECT_THAT(outcome.err, HasSubstr("--report: "));
    EXPECT_FALSE(Exists("table.csv"));
  }
}

TEST_F(ReportPage, ARecordIsNotFittedForAPlotThatCannotBe) {
  const Outcome outcome =
      RunCommand({"fit", SampleRecord(), "--json", At("fit.json"), "--plot", At("plot.pdf")});
  EXPECT_EQ(outcome.status, kBadInput);
  EXPECT_THAT(outcome.err, HasSubstr("must end in .svg or .png"));
  EXPECT_FALSE(Exists("fit.json"));
}

TEST(ShellWord, IsQuotedWhereAShellWouldTakeItApart) {
  EXPECT_EQ(ShellWord("loop_1.csv"), "loop_1.csv");
  EXPECT_EQ(ShellWord("my loop.csv"), "'my loop.csv'");
  EXPECT_EQ(ShellWord("it's"), "'it'\\''s'");
  EXPECT_EQ(ShellWord(""), "''");
  EXPECT_EQ(ShellWord("$(rm)"), "'$(rm)'");
}

}  // namespace
}  // namespace mindahl::cli::report_page_test
