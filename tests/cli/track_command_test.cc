#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "campaign/test_record.h"
#include "cli/command_line.h"
#include "cli/standard_input.h"
#include "io/temporary_directory.h"
#include "mindahl/campaign/tracker.h"
#include "support/prelude.h"

// mindahl track: a table that nothing ends half-way.
namespace mindahl::track_command_test {
namespace {

constexpr std::size_t kCycles = 200;  // three batches and a part

std::string TextOf(const loop::Record& record) {
  std::string text = "time [s],displacement [m],force [N]\n";
  for (std::size_t i = 0; i < record.size(); ++i) {
    text += fmt::format("{},{},{}\n", record.time[i], record.displacement[i], record.force[i]);
  }
  return text;
}

/// Its slip force falls by a tenth after the 120th cycle.
std::string StepText() {
  return TextOf(TestRecord(kCycles + 1, 1, testing::kCycleNoise,
                           [](std::size_t cycle) { return cycle <= 120 ? 1.0 : 0.9; }));
}

std::string ContentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream content;
  content << file.rdbuf();
  return content.str();
}

class TrackCommand : public ::testing::Test {
 protected:
  std::string Path(const std::string& name) const { return (directory_.path() / name).string(); }
  std::string Write(const std::string& name, const std::string& text) const {
    return directory_.Write(name, text).string();
  }
  /// The table of an undisturbed run.
  std::string Whole() {
    const Outcome outcome = RunCommand({"track", record_, "--output", Path("whole.csv")});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return ContentOf(Path("whole.csv"));
  }

  TemporaryDirectory directory_;
  std::string record_ = Write("record.csv", StepText());
};

TEST_F(TrackCommand, WritesARowACycle) {
  const std::vector<std::string> rows = Lines(Whole());
  ASSERT_EQ(rows.size(), 1 + kCycles);
  const std::vector<std::string> names = Cells(rows[0]);
  EXPECT_EQ(names[0], "cycle");
  EXPECT_EQ(names[3], "start_time [s]");
  double energy = 0.0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::vector<std::string> cells = Cells(rows[k]);
    EXPECT_EQ(cells[0], std::to_string(k));
    energy += std::stod(cells[8]);
    EXPECT_NEAR(std::stod(cells[24]), energy, 1e-12 * energy);
  }
}

// What fit says of the rows of one cycle.
TEST_F(TrackCommand, RefusesToJoinPiecesOfWhichOneHasNoTime) {
  const std::string untimed =
      Write("untimed.csv", "displacement [m],force [N]\n0,0\n1e-6,2\n0,1\n");
  const Outcome outcome =
      RunCommand({"track", record_, untimed, "--join", "--output", Path("joined.csv")});
  EXPECT_EQ(outcome.status, cli::kBadInput);
  EXPECT_NE(outcome.err.find("has a time and the other does not"), std::string::npos)
      << outcome.err;
}

TEST_F(TrackCommand, SaysOfACycleWhatFitSaysOfItsRows) {
  constexpr double kSolverTolerance = 1e-2;  // standard errors
  const std::vector<std::string> rows = Lines(Whole());
  const std::vector<std::string> lines = Lines(ContentOf(record_));
  for (const std::size_t cycle : {1U, 2U, 65U, 121U, 200U}) {
    const std::vector<std::string> cells = Cells(rows[cycle]);
    const std::size_t first = std::stoul(cells[1]);
    std::string text = lines[0] + "\n";
    for (std::size_t i = 0; i < std::stoul(cells[2]); ++i) text += lines[first - 1 + i] + "\n";
    const Outcome fit = RunCommand({"fit", Write("cycle.csv", text), "--initial-state", "steady",
                                    "--force-sign", "same", "--json", "-"});
    const nlohmann::json parameters = fit.Json()["parameters"];
    const nlohmann::json slip_force = parameters["slip_force"];
    EXPECT_NEAR(std::stod(cells[16]), slip_force["value"].get<double>(),
                kSolverTolerance * slip_force["standard_error"].get<double>());
    const nlohmann::json sigma = parameters["sigma"];
    EXPECT_NEAR(std::stod(cells[12]), sigma["value"].get<double>(),
                kSolverTolerance * sigma["standard_error"].get<double>());
    EXPECT_NEAR(std::stod(cells[8]), fit.Json()["measured"]["energy_per_cycle"].get<double>(),
                1e-9 * std::stod(cells[8]));
  }
}

TEST_F(TrackCommand, WritesTheSameBytesWithAnyNumberOfThreads) {
  const std::string whole = Whole();
  for (const char* threads : {"1", "2", "5"}) {
    const std::string path = Path(fmt::format("{}.csv", threads));
    EXPECT_EQ(RunCommand({"track", record_, "--output", path, "--threads", threads}).status, 0);
    EXPECT_EQ(ContentOf(path), whole) << threads;
  }
}

TEST_F(TrackCommand, GoesOnFromWhereverItWasKilled) {
  const std::string whole = Whole();
  const std::string path = Path("killed.csv");
  const std::size_t step = whole.size() / 23;
  for (std::size_t bytes = 0; bytes <= whole.size(); bytes += step) {
    Write("killed.csv", whole.substr(0, bytes));
    const Outcome outcome = RunCommand({"track", record_, "--output", path, "--resume"});
    const bool has_header = bytes == 0 || bytes > Lines(whole)[0].size();
    if (!has_header) {  // the header is written as one block
      EXPECT_EQ(outcome.status, 2);
      continue;
    }
    ASSERT_EQ(outcome.status, 0) << bytes << outcome.err;
    EXPECT_EQ(ContentOf(path), whole) << "killed after " << bytes << " bytes";
  }
}

TEST_F(TrackCommand, SummarisesAResumedRunLikeAWholeOne) {
  const auto summary = [&](const std::string& output, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"track", record_, "--output", output, "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    nlohmann::json json = RunCommand(words).Json();
    json.erase("output");
    return json;
  };
  const nlohmann::json whole = summary(Path("one.csv"), {});
  const std::string text = ContentOf(Path("one.csv"));
  Write("two.csv", text.substr(0, text.size() * 2 / 3));
  EXPECT_EQ(summary(Path("two.csv"), {"--resume"}), whole);
}

TEST_F(TrackCommand, RefusesToGoOnWithAnotherTest) {
  const std::string whole = Whole();
  Write("other.csv", whole.substr(0, whole.size() / 2));
  const Outcome options = RunCommand(
      {"track", record_, "--output", Path("other.csv"), "--resume", "--fix", "alpha=0.3"});
  EXPECT_EQ(options.status, 2);
  EXPECT_NE(options.err.find("made from another record or with other options"), std::string::npos)
      << options.err;
  EXPECT_EQ(ContentOf(Path("other.csv")), whole.substr(0, whole.size() / 2));
  const std::string text = ContentOf(record_);
  Write("shorter.csv", text.substr(0, text.rfind('\n', text.size() / 4) + 1));
  EXPECT_EQ(
      RunCommand({"track", Path("shorter.csv"), "--output", Path("other.csv"), "--resume"}).status,
      2);
  EXPECT_EQ(ContentOf(Path("other.csv")), whole.substr(0, whole.size() / 2));
  Write("else.csv", "x,F\n1,2\n");
  const Outcome table = RunCommand({"track", record_, "--output", Path("else.csv"), "--resume"});
  EXPECT_EQ(table.status, 2);
  EXPECT_EQ(ContentOf(Path("else.csv")), "x,F\n1,2\n");
}

// The last batch of the table is the same; what came long before it is not.
TEST_F(TrackCommand, RefusesToGoOnWhereAnEarlyRowOfTheRecordWasChanged) {
  std::string part = Whole();
  part.resize(part.size() * 4 / 5);
  for (const std::size_t changed : {1U, 500U, 5'000U}) {
    std::vector<std::string> lines = Lines(ContentOf(record_));
    lines[changed] = lines[changed].substr(0, lines[changed].rfind(',')) + ",0.125";
    const std::string other = Write("other.csv", fmt::format("{}\n", fmt::join(lines, "\n")));
    Write("part.csv", part);
    const Outcome outcome = RunCommand({"track", other, "--output", Path("part.csv"), "--resume"});
    EXPECT_EQ(outcome.status, 2) << changed;
    EXPECT_NE(outcome.err.find("what was read before its row"), std::string::npos) << outcome.err;
    EXPECT_TRUE(ContentOf(Path("part.csv")) == part);
  }
}

// A bound that no cycle reaches changes no value, and yet the rows were made with other options.
TEST_F(TrackCommand, RefusesToGoOnWithOptionsOfNoEffectYet) {
  std::string part = Whole();
  part.resize(part.size() * 4 / 5);
  Write("part.csv", part);
  const auto resume = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"track", record_, "--output", Path("part.csv"), "--resume"};
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words).status;
  };
  EXPECT_EQ(resume({"--bound", "slip_force=1:1000"}), 2);
  EXPECT_EQ(ContentOf(Path("part.csv")), part);
  EXPECT_EQ(resume({"--threads", "2", "--average", "1"}), 0) << "the default, said";
}

TEST_F(TrackCommand, GivesNoFrictionOfASlipForceThatIsOpen) {
  const std::string record = std::string(MINDAHL_SOURCE_DIR) + "/data/far_from_slip.csv";
  ASSERT_EQ(
      RunCommand({"track", record, "--output", Path("far.csv"), "--normal-load", "80"}).status, 0);
  const std::vector<std::string> rows = Lines(ContentOf(Path("far.csv")));
  const std::vector<std::string> names = Cells(rows[0]);
  const auto place = [&](const std::string& name) {
    return static_cast<std::size_t>(std::ranges::find(names, name) - names.begin());
  };
  std::size_t open = 0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    const std::vector<std::string> cells = Cells(rows[k]);
    if (cells[place("flags")].find("slip_force_open") == std::string::npos) continue;
    ++open;
    EXPECT_EQ(cells[place("friction_coefficient")], "") << rows[k];
    EXPECT_EQ(cells[place("normal_load [N]")], "80");
  }
  EXPECT_GT(open, 0U);
}

TEST_F(TrackCommand, ReadsStandardInput) {
  const std::string whole = Whole();
  const testing::StandardInput input(record_);
  EXPECT_EQ(RunCommand({"track", "-", "--output", Path("piped.csv")}).status, 0);
  EXPECT_EQ(ContentOf(Path("piped.csv")), whole);
}

TEST_F(TrackCommand, WritesOverNothingUnasked) {
  const std::string whole = Whole();
  const Outcome refused = RunCommand({"track", record_, "--output", Path("whole.csv")});
  EXPECT_EQ(refused.status, 2);
  EXPECT_EQ(refused.Errors().size(), 1U);
  EXPECT_NE(refused.err.find("--resume"), std::string::npos) << refused.err;
  EXPECT_EQ(ContentOf(Path("whole.csv")), whole);
  EXPECT_EQ(
      RunCommand({"track", record_, "--output", Path("whole.csv"), "--overwrite", "--every", "50"})
          .status,
      0);
  EXPECT_EQ(Lines(ContentOf(Path("whole.csv"))).size(), 5U);
}

TEST_F(TrackCommand, KeepsFinishedCyclesIfARowIsBroken) {
  std::vector<std::string> lines = Lines(ContentOf(record_));
  const std::string good = lines[15'000];
  lines[15'000] = "12.3,oops,4";
  const std::string broken = Write("broken.csv", fmt::format("{}\n", fmt::join(lines, "\n")));
  const std::string output = Path("broken_table.csv");
  const Outcome outcome = RunCommand({"track", broken, "--output", output});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("broken.csv:15001:2: 'oops' is not a number"), std::string::npos)
      << outcome.err;
  EXPECT_NE(outcome.err.find("add --resume"), std::string::npos);
  const std::string part = ContentOf(output);
  EXPECT_GT(Lines(part).size(), 100U);
  lines[15'000] = good;
  Write("broken.csv", fmt::format("{}\n", fmt::join(lines, "\n")));
  EXPECT_EQ(RunCommand({"track", broken, "--output", output, "--resume"}).status, 0);
  EXPECT_EQ(ContentOf(output), Whole());
}

TEST_F(TrackCommand, SkipsBrokenRowsWhereAsked) {
  std::vector<std::string> lines = Lines(ContentOf(record_));
  lines[15'000] = "12.3,oops,4";
  const std::string broken = Write("broken.csv", fmt::format("{}\n", fmt::join(lines, "\n")));
  const Outcome outcome = RunCommand(
      {"track", broken, "--output", Path("t.csv"), "--broken-rows", "skip", "--json", "-"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_EQ(outcome.Json()["input"]["broken_rows"], 1);
  EXPECT_EQ(outcome.Json()["fits"], kCycles);
  EXPECT_THAT(outcome.Json()["notes"].get<std::vector<std::string>>(),
              Contains(HasSubstr("broken.csv: 1 broken row")));
}

/// Lets no file grow beyond a size while it lives, as a full disk does.
class FullDisk {
 public:
  explicit FullDisk(std::size_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
    rlimit limit = before_;
    limit.rlim_cur = bytes;
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*handler_)(int) = nullptr;
};

TEST_F(TrackCommand, KeepsWholeRowsOnAFullDisk) {
  const std::string whole = Whole();
  const std::string output = Path("full.csv");
  {
    const FullDisk full(whole.size() / 2);
    const Outcome outcome = RunCommand({"track", record_, "--output", output});
    EXPECT_EQ(outcome.status, 2);
    EXPECT_NE(outcome.err.find("cannot write"), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.Errors().size(), 1U);
  }
  const std::string part = ContentOf(output);
  EXPECT_EQ(part, whole.substr(0, part.size()));
  EXPECT_EQ(part.back(), '\n');
  EXPECT_EQ((Lines(part).size() - 1) % campaign::kBatch, 0U);
  EXPECT_EQ(RunCommand({"track", record_, "--output", output, "--resume"}).status, 0);
  EXPECT_EQ(ContentOf(output), whole);
}

TEST_F(TrackCommand, SaysWhatChangedAndWhen) {
  const Outcome outcome = RunCommand({"track", record_, "--output", Path("t.csv"), "--json", "-"});
  const nlohmann::json json = outcome.Json();
  EXPECT_EQ(json["schema"], "mindahl.track/1");
  const nlohmann::json slip_force = json["quantities"]["slip_force"];
  ASSERT_EQ(slip_force["steps"].size(), 1U);
  EXPECT_NEAR(slip_force["steps"][0]["cycle"].get<double>(), 120.5, 2);
  EXPECT_TRUE(json["quantities"]["sigma"]["steps"].empty());
  const Outcome text = RunCommand({"track", record_, "--output", Path("u.csv")});
  EXPECT_NE(text.out.find("a step"), std::string::npos) << text.out;
  EXPECT_TRUE(text.out.starts_with("Tc ")) << text.out;
}

TEST_F(TrackCommand, SummarisesItsOwnTableWhateverItsRowsStandFor) {
  for (const char* average : {"1", "10"}) {
    const nlohmann::json quantities =
        RunCommand({"track", record_, "--output", Path("t.csv"), "--overwrite", "--average",
                    average, "--json", "-"})
            .Json()["quantities"];
    const std::vector<std::string> rows = Lines(ContentOf(Path("t.csv")));
    for (const auto& [name, column] : {std::pair("slip_force", 16U), {"half_gap", 7U}}) {
      EXPECT_EQ(quantities[name]["first"].get<double>(), std::stod(Cells(rows[1])[column]));
      EXPECT_EQ(quantities[name]["last"].get<double>(), std::stod(Cells(rows.back())[column]));
    }
  }
}

TEST_F(TrackCommand, StandsForTheCyclesThatItLeavesOut) {
  const auto energy = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"track",       record_,  "--output", Path("e.csv"),
                                      "--overwrite", "--json", "-"};
    words.insert(words.end(), more.begin(), more.end());
    return RunCommand(words).Json()["accumulated_energy"].get<double>();
  };
  const double whole = energy({});
  EXPECT_NEAR(energy({"--every", "4"}), whole, 0.01 * whole);
  EXPECT_NEAR(energy({"--average", "5"}), whole, 1e-3 * whole);
}

TEST_F(TrackCommand, RefusesATableThatIsNoFile) {
  const Outcome outcome = RunCommand({"track", record_, "--output", "/dev/null"});
  EXPECT_EQ(outcome.status, 2);
  EXPECT_NE(outcome.err.find("/dev/null is no file"), std::string::npos) << outcome.err;
  EXPECT_EQ(outcome.Errors().size(), 1U);
}

// A spike of the displacement turns it, and makes two pieces of a cycle.
TEST_F(TrackCommand, CountsPiecesOfACycleForThatCycle) {
  const std::vector<std::string> clean = Lines(ContentOf(record_));
  const auto energy_of = [&](const std::vector<std::string>& lines) {
    const std::string file = Write("spiked.csv", fmt::format("{}\n", fmt::join(lines, "\n")));
    const Outcome outcome = RunCommand(
        {"track", file, "--output", Path("spiked_table.csv"), "--overwrite", "--json", "-"});
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    return outcome.Json();
  };
  const nlohmann::json whole = energy_of(clean);
  EXPECT_EQ(whole["energy_counts"]["measured"], kCycles);
  EXPECT_EQ(whole["energy_counts"]["replaced"], 0);
  const std::vector<std::string> rows = Lines(Whole());
  std::vector<std::string> spiked = clean;
  for (const std::size_t cycle : {40U, 90U, 150U}) {
    const std::size_t line = std::stoul(Cells(rows[cycle])[1]) - 1 + testing::kCycleSamples / 3;
    const std::vector<std::string> cells = Cells(spiked[line]);
    spiked[line] = fmt::format("{},{},{}", cells[0], 5 * testing::kCycleReach, cells[2]);
  }
  const nlohmann::json json = energy_of(spiked);
  EXPECT_EQ(json["energy_counts"]["replaced"], 6);
  // Two of 200 cycles would be one per cent.
  EXPECT_NEAR(json["accumulated_energy"].get<double>(), whole["accumulated_energy"].get<double>(),
              1e-3 * whole["accumulated_energy"].get<double>());
  // The last nine before a batch are had from the table, too.
  const std::string table = ContentOf(Path("spiked_table.csv"));
  for (const double share : {0.4, 0.7, 0.9}) {
    Write("part.csv",
          table.substr(0, static_cast<std::size_t>(share * static_cast<double>(table.size()))));
    ASSERT_EQ(
        RunCommand({"track", Path("spiked.csv"), "--output", Path("part.csv"), "--resume"}).status,
        0);
    EXPECT_EQ(ContentOf(Path("part.csv")), table) << share;
  }
}

TEST_F(TrackCommand, RefusesWhatItCannotDo) {
  struct Case {
    std::vector<std::string> words;
    std::string said;
  };
  const std::string one_stroke = Write("stroke.csv", "x,F\n0,0\n1,1\n2,2\n3,2.5\n4,2.7\n");
  for (const Case& refused :
       {Case{{record_, "--compare"}, "--compare"},
        Case{{record_, "--covariate", "1"}, "--covariate"},
        Case{{record_, "--terms", "asymmetry"}, "--terms asymmetry is not available in track"},
        Case{{record_, "--normal-load", "-3"}, "--normal-load"},
        Case{{record_, "--resume", "--overwrite"}, "--resume excludes --overwrite"},
        Case{{record_, "--threads", "0"}, "--threads"}, Case{{one_stroke}, "no whole cycle"},
        Case{{Path("nowhere.csv")}, "nowhere.csv"}}) {
    std::vector<std::string> words = {"track"};
    words.insert(words.end(), refused.words.begin(), refused.words.end());
    if (std::ranges::find(words, "--output") == words.end()) {
      words.insert(words.end(), {"--output", Path("refused.csv")});
    }
    const Outcome outcome = RunCommand(words);
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_NE(outcome.err.find(refused.said), std::string::npos) << outcome.err;
    EXPECT_EQ(outcome.Errors().size(), 1U) << outcome.err;
    EXPECT_TRUE(outcome.out.empty());
    EXPECT_FALSE(std::filesystem::exists(Path("refused.csv"))) << outcome.err;
  }
}

}  // namespace
}  // namespace mindahl::track_command_test
