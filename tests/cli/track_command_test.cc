#include "campaign/test_record.h"
#include "cli/command_line.h"
#include "cli/standard_input.h"

// mindahl track: a table that nothing ends half-way.
namespace mindahl::track_command_test {
namespace {

using testing::CommandTest;
using testing::Done;
using testing::ExpectRefused;
using testing::json;
using testing::JsonOf;
using testing::Outcome;
using testing::Words;
using Table = std::vector<std::vector<std::string>>;

constexpr std::size_t kCycles = 200;  // three batches and a part

std::string Joined(const std::vector<std::string>& lines) {
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

class TrackCommand : public CommandTest {
 protected:
  /// Its slip force falls by a tenth after the 120th cycle.
  static std::string StepText() {
    const loop::Record record =
        TestRecord(kCycles + 1, 1, testing::kCycleNoise,
                   [](std::size_t cycle) { return cycle <= 120 ? 1.0 : 0.9; });
    std::string text = "time [s],displacement [m],force [N]\n";
    for (std::size_t i = 0; i < record.size(); ++i) {
      text += fmt::format("{},{},{}\n", record.time[i], record.displacement[i], record.force[i]);
    }
    return text;
  }

  /// The command that tracks the record, or another file.
  Words Track(const std::string& table, const std::string& record = "record.csv") const {
    return {"track", Path(record), "--output", Path(table)};
  }
  std::string ContentOf(const std::string& name) const { return FileContent(Path(name)); }
  /// The table of an undisturbed run.
  std::string Whole() const {
    Done(Track("whole.csv") + "--overwrite");
    return ContentOf("whole.csv");
  }
  /// Expects that a part of a table is not gone on with, and stays.
  void ExpectKept(const std::string& part, const Words& command, const std::string& message) {
    Write("part.csv", part);
    ExpectRefused(command + "--resume", message);
    EXPECT_EQ(ContentOf("part.csv"), part);
  }
  void ExpectCompleted(const std::string& part, const std::string& whole,
                       const std::string& record = "record.csv") {
    Write("part.csv", part);
    Done(Track("part.csv", record) + "--resume");
    EXPECT_EQ(ContentOf("part.csv"), whole) << "after " << part.size() << " bytes";
  }

  std::string text_ = StepText();
  std::string record_ = Write("record.csv", text_);
};

TEST_F(TrackCommand, WritesARowACycle) {
  const Table rows = Rows(Whole());
  ASSERT_EQ(rows.size(), 1 + kCycles);
  EXPECT_EQ(rows[0][0], "cycle");
  EXPECT_EQ(rows[0][4], "start_time [s]");
  double energy = 0.0;
  for (std::size_t k = 1; k < rows.size(); ++k) {
    EXPECT_EQ(rows[k][0], std::to_string(k));
    energy += std::stod(rows[k][9]);
    EXPECT_NEAR(std::stod(rows[k][24]), energy, 1e-12 * energy);
  }
}

TEST_F(TrackCommand, WritesTheSameBytesWithAnyNumberOfThreadsAndOfStandardInput) {
  const std::string whole = Whole();
  for (const char* threads : {"1", "2", "5"}) {
    Done(Track("other.csv") + Words{"--overwrite", "--threads", threads});
    EXPECT_EQ(ContentOf("other.csv"), whole) << threads;
  }
  const testing::StandardInput input(record_);
  Done("track - --output " + Path("piped.csv"));
  EXPECT_EQ(ContentOf("piped.csv"), whole);
}

TEST_F(TrackCommand, GoesOnFromWhereverItWasKilled) {
  const std::string whole = Whole();
  const std::size_t step = whole.size() / 11;
  ExpectCompleted("", whole);
  ExpectKept(whole.substr(0, 5), Track("part.csv"), "");  // the header is written as one block
  for (std::size_t bytes = step; bytes <= whole.size(); bytes += step) {
    ExpectCompleted(whole.substr(0, bytes), whole);
  }
}

TEST_F(TrackCommand, SummarisesAResumedRunLikeAWholeOne) {
  const auto summary = [&](const Words& command) {
    json all = JsonOf(command);
    all.erase("output");
    return all;
  };
  const json whole = summary(Track("one.csv"));
  const std::string text = ContentOf("one.csv");
  Write("two.csv", text.substr(0, text.size() * 2 / 3));
  EXPECT_EQ(summary(Track("two.csv") + "--resume"), whole);
}

TEST_F(TrackCommand, RefusesToGoOnWithAnotherTest) {
  std::string part = Whole();
  part.resize(part.size() / 2);
  ExpectKept(part, Track("part.csv") + "--fix alpha=0.3",
             "made from another record or with other options");
  Write("shorter.csv", text_.substr(0, text_.rfind('\n', text_.size() / 4) + 1));
  ExpectKept(part, Track("part.csv", "shorter.csv"), "");
  ExpectKept("x,F\n1,2\n", Track("part.csv"), "");
  Write("part.csv", part);
  Done(Track("part.csv") + "--resume --threads 2 --average 1");  // the default, said
}

TEST_F(TrackCommand, RefusesToGoOnWhereTheLastBatchIsOfAnotherRecord) {
  std::string part = Whole();
  part.resize(part.size() * 4 / 5);
  std::vector<std::string> lines = Lines(text_);
  lines[10'000] = lines[10'000].substr(0, lines[10'000].rfind(',')) + ",0.125";
  Write("other.csv", Joined(lines));
  ExpectKept(part, Track("part.csv", "other.csv"), "made from another record");
}

TEST_F(TrackCommand, RefusesToGoOnWithATableOfLessThanABatchOfAnotherTest) {
  std::vector<std::string> lines = Lines(Whole());
  lines.resize(30);
  ExpectKept(Joined(lines), Track("part.csv") + "--average 2", "made from another record");
  lines.back() = lines[1];  // the last row of a record that has grown since
  ExpectCompleted(Joined(lines), Whole());
}

TEST_F(TrackCommand, NamesItsColumns) {
  EXPECT_THAT(Done(Track("table.csv")).out,
              HasSubstr("columns: displacement 'displacement [m]' (2), force 'force [N]' (3)"));
}

TEST_F(TrackCommand, WritesOverNothingUnasked) {
  const std::string whole = Whole();
  ExpectRefused(Track("whole.csv"), "--resume");
  EXPECT_EQ(ContentOf("whole.csv"), whole);
  Done(Track("whole.csv") + "--overwrite --average 50");
  EXPECT_THAT(Lines(ContentOf("whole.csv")), SizeIs(5));
}

TEST_F(TrackCommand, KeepsFinishedBatchesIfARowIsBrokenAndSkipsItWhereAsked) {
  const std::string whole = Whole();
  std::vector<std::string> lines = Lines(text_);
  lines[18'000] = "12.3,oops,4";
  Write("broken.csv", Joined(lines));
  const Words track = Track("part.csv", "broken.csv") + "--threads 1";
  ExpectRefused(track, "broken.csv:18001:2: 'oops' is not a number");
  ExpectRefused(track, "add --resume");
  const std::string part = ContentOf("part.csv");
  EXPECT_GT(Lines(part).size(), 60U);
  const json skipped = JsonOf(track + "--overwrite --broken-rows skip");
  EXPECT_EQ(skipped["input"]["broken_rows"], 1);
  EXPECT_EQ(skipped["fits"], kCycles);
  EXPECT_THAT(skipped["notes"].get<std::vector<std::string>>(),
              Contains(AllOf(HasSubstr("1 row is left out, the first: "),
                             HasSubstr("broken.csv:18001:2: 'oops' is not a number"))));
  Write("broken.csv", text_);
  ExpectCompleted(part, whole, "broken.csv");
}

TEST_F(TrackCommand, SummarisesItsOwnTableWhateverItsRowsStandFor) {
  const auto summary = [&](const Words& options) {
    return JsonOf(Track("t.csv") + "--overwrite" + options);
  };
  const auto energy = [](const json& all) { return all["accumulated_energy"].get<double>(); };
  const json single = summary({});
  const double whole = energy(single);
  EXPECT_NEAR(energy(summary("--average 5")), whole, 1e-3 * whole);
  // 150 does not divide the number of cycles: the last row averages fewer cycles, and every cycle
  // is in a row.
  const json unequal = summary("--average 150");
  EXPECT_EQ(unequal["input"]["cycles"], kCycles);
  EXPECT_EQ(unequal["input"]["unused_samples"], single["input"]["unused_samples"]);
  EXPECT_NEAR(energy(unequal), whole, 1e-3 * whole);
  EXPECT_EQ(Rows(ContentOf("t.csv")).back()[3], std::to_string(kCycles - 150));
  for (const char* options : {"--average 1", "--average 10"}) {
    const json quantities = summary(options)["quantities"];
    const Table rows = Rows(ContentOf("t.csv"));
    for (const auto& [name, column] : {std::pair("slip_force", 17U), {"half_gap", 8U}}) {
      EXPECT_EQ(quantities[name]["first"].get<double>(), std::stod(rows[1][column]));
      EXPECT_EQ(quantities[name]["last"].get<double>(), std::stod(rows.back()[column]));
    }
  }
}

TEST_F(TrackCommand, RefusesAForceAndATorqueTogether) {
  Write("torques.csv", "time [s],angle [rad],torque [N m]" + text_.substr(text_.find('\n')));
  ExpectRefused(Track("part.csv") + Path("torques.csv"),
                "hold a force and a torque: track them apart");
}

TEST_F(TrackCommand, NotesAGateThatIsNotCertain) {
  std::string text = "displacement [m],force [N]\n";
  for (std::size_t i = 0; i < 1000; ++i) {
    // A vibration that grows and falls again: no gate parts it from the cycles.
    const double phase = 2 * std::numbers::pi * static_cast<double>(i) / 120;
    const double vibration = 0.1 * std::sin(7.3 * phase) * (1 + std::sin(phase / 3));
    text += fmt::format("{},{}\n", 2e-6 * (std::sin(phase) + vibration), 40 * std::cos(phase));
  }
  Write("vibrating.csv", text);
  const auto notes = [](const json& all) { return all["notes"].get<std::vector<std::string>>(); };
  EXPECT_THAT(notes(JsonOf(Track("part.csv", "vibrating.csv"))),
              ElementsAre(HasSubstr("is not certain: set --reversal-gate")));
  EXPECT_THAT(notes(JsonOf(Track("whole.csv"))), IsEmpty());
}

TEST_F(TrackCommand, SaysInTheFirstLineThatCyclesHaveNoFit) {
  const Table rows = Rows(Whole());
  std::vector<std::string> lines = Lines(text_);
  const auto make_constant = [&](std::size_t first_cycle, std::size_t end_cycle) {
    for (std::size_t k = std::stoul(rows[first_cycle][1]); k < std::stoul(rows[end_cycle][1]);
         ++k) {
      lines[k] = lines[k].substr(0, lines[k].rfind(',')) + ",3.2";
    }
  };
  make_constant(30, 33);
  Write("dead.csv", Joined(lines));
  const Words track = Track("table.csv", "dead.csv") + "--overwrite";
  EXPECT_THAT(JsonOf(track)["headline"].get<std::string>(),
              EndsWith("; 3 of 200 cycles without a fit or a loop"));
  make_constant(91, 100);
  lines.resize(std::stoul(rows[100][1]));
  Write("dead.csv", Joined(lines));
  EXPECT_THAT(Lines(Done(track + "--report" + Path("page.html")).out)[0],
              EndsWith("; 11 of 98 cycles without a fit or a loop, the last with both is 90"));
  const std::string page = ContentOf("page.html");
  EXPECT_THAT(page, HasSubstr("incomplete"));
  // The last figure shows the loops; its caption does not explain lines of steps.
  const std::string loops = page.substr(page.find("<figure id=\"loops\">"));
  EXPECT_THAT(loops, HasSubstr("Measured, of the cycles in the legend."));
  EXPECT_THAT(loops, Not(HasSubstr("Dashed")));
}

TEST_F(TrackCommand, NamesTheFileWhoseDisplacementNeverChanges) {
  Write("still.csv", "x [um],F [N]\n1,0\n1,4\n1,2\n1,3\n");
  ExpectRefused(Track("table.csv", "still.csv"),
                "still.csv:2:1: the displacement never changes, it is 1e-06 m in every row: choose "
                "another column with --displacement");
}

TEST(TrackHelp, HasNoChoiceThatTrackRefuses) {
  const std::string fit = Done("fit --help-all").out;
  const std::string track = Done("track --help-all").out;
  for (const char* of_fit : {"dahl, by the record", "asymmetry: ", "A column's name"}) {
    EXPECT_THAT(fit, HasSubstr(of_fit));
    EXPECT_THAT(track, Not(HasSubstr(of_fit)));
  }
}

// A spike of the displacement turns it, and makes two pieces of a cycle with ten times its energy.
TEST_F(TrackCommand, CountsNoEnergyOfPiecesOfACycle) {
  const json whole = JsonOf(Track("clean.csv"));
  const Table rows = Rows(ContentOf("clean.csv"));
  std::vector<std::string> lines = Lines(text_);
  std::string& line = lines[std::stoul(rows[90][1]) - 1 + testing::kCycleSamples / 3];
  const std::vector<std::string> cells = testing::Cells(line);
  line = fmt::format("{},{},{}", cells[0], 5 * testing::kCycleReach, cells[2]);
  Write("spiked.csv", Joined(lines));
  const json spiked = JsonOf(Track("spiked_table.csv", "spiked.csv"));
  constexpr double kOneCycle = 1.1 / kCycles;
  const double energy = whole["accumulated_energy"];
  EXPECT_LT(spiked["accumulated_energy"].get<double>(), energy);
  EXPECT_NEAR(spiked["accumulated_energy"].get<double>(), energy, kOneCycle * energy);
}

}  // namespace
}  // namespace mindahl::track_command_test
