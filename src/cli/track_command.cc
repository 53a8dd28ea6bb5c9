#include <filesystem>
#include <fstream>
#include <map>
#include <thread>

#include "cli/command.h"
#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/tracker.h"
#include "mindahl/core/interruption.h"
#include "mindahl/report/units.h"
#include "report/html.h"

namespace mindahl::cli {

using campaign::CycleFit;
using campaign::Evolution;

namespace {

struct TrackCommandOptions {
  FitRequest fit;  // model of each cycle, and what is known of the contact
  campaign::TrackOptions track{.threads = std::max(1U, std::thread::hardware_concurrency())};
  std::string output;
  std::string report_path;
  bool resume = false;
  bool overwrite = false;
};

/// Holds the answer for a test of many cycles, apart from its rows.
struct TrackedTest {
  std::vector<std::string> files = {};
  std::string columns = {};  // as ColumnsText() names them, of the first file
  std::string output = {};
  bool is_torsional = false;
  std::size_t samples = 0;
  std::size_t cycles = 0;
  std::size_t unused_samples = 0;  // at the ends, part of no whole cycle
  std::size_t broken_rows = 0;     // rows skipped
  loop::ReversalGate gate = {};
  std::size_t fits = 0;
  bool is_established = false;                                 // a fit converged
  std::map<std::string, std::size_t, std::less<>> flags = {};  // how many fits have each
  std::size_t cycles_without = 0;         // cycles that have no fit or are no loop
  std::size_t last_with = 0;              // last cycle that has one and is one
  double energy = 0.0;                    // [J] dissipated
  std::vector<campaign::Cycle> log = {};  // loops of the cycles 1, 10, 100, …
  std::vector<Evolution> evolutions = {};
  std::vector<std::string> notes = {};  // what was assumed, one sentence each

  /// Adds the fit of the next row of the table.
  void Add(const CycleFit& fit) {
    // The work of a cycle that does not close is not all dissipated.
    const bool is_loop = !fit.HasFlag("not_closed") && !fit.HasFlag("rows_missing");
    if (is_loop) energy += static_cast<double>(fit.cycles) * fit["energy"].value_or(0.0);
    ++fits;
    is_established = is_established || !fit.HasFlag("not_converged");
    for (const std::string& flag : fit.flags) ++flags[flag];
    if (fit.HasFlag("not_converged") || fit.HasFlag("no_loop")) {
      cycles_without += fit.cycles;
    } else {
      last_with = fit.number + fit.cycles - 1;
    }
    campaign::AddTo(evolutions, fit);
  }
  /// Returns the test in one line, with the cycles that say nothing of it.
  [[nodiscard]] std::string Headline() const {
    std::string text = campaign::Headline(evolutions);
    if (cycles_without == 0) return text;
    text += fmt::format("{}{} of {} cycles without a fit or a loop", text.empty() ? "" : "; ",
                        cycles_without, cycles);
    const bool ends_without = last_with > 0 && last_with < cycles;
    return ends_without ? text + fmt::format(", the last with both is {}", last_with) : text;
  }
};

// --- the answer

Json QuantityRows(const TrackedTest& test) {
  Json quantities = Json::object();
  for (const Evolution& evolution : test.evolutions) {
    const campaign::CourseDescription& course = evolution.description;
    quantities[std::string(evolution.quantity->name)] = {
        {"first", evolution.course.first()},
        {"last", evolution.course.last()},
        {"known", evolution.known},
        {"unit", evolution.unit},
        {"settled_at", course.settled_at ? Json(*course.settled_at) : Json()},
        {"varies", course.varies ? Json{course.from, course.to} : Json::array()},
        {"changes", report::ListOf(course.changes, [](const campaign::Change& change) -> Json {
           return {{"first_cycle", change.first_cycle},
                   {"last_cycle", change.last_cycle},
                   {"from", change.from},
                   {"to", change.to},
                   {"p_value", change.p_value}};
         })}};
  }
  return quantities;
}

std::string ToJson(const TrackedTest& test, const Json& quantities) {
  return report::Document(
      "mindahl.track/1", {{"input",
                           {{"files", test.files},
                            {"samples", test.samples},
                            {"cycles", test.cycles},
                            {"unused_samples", test.unused_samples},
                            {"broken_rows", test.broken_rows}}},
                          {"reversals", {{"gate", test.gate.gate}, {"certain", test.gate.certain}}},
                          {"output", test.output},
                          {"fits", test.fits},
                          {"flags", test.flags},
                          {"accumulated_energy", test.energy},
                          {"headline", test.Headline()},
                          {"changes", campaign::ChangeStatements(test.evolutions)},
                          {"quantities", quantities},
                          {"notes", test.notes}});
}

/// Returns the flags that a cycle has, with what they say.
Json FlagRows(const TrackedTest& test) {
  Json rows = Json::object();
  for (const campaign::CycleFlag& flag : campaign::kCycleFlags) {
    const auto found = test.flags.find(flag.name);
    if (found == test.flags.end()) continue;
    rows[flag.name] = {{"cycles", found->second}, {"what it says", flag.meaning}};
  }
  return rows;
}

/// Returns what was read, fitted and dissipated, one sentence each.
std::vector<std::string> Facts(const TrackedTest& test) {
  std::vector<std::string> facts = {
      "columns: " + test.columns,
      fmt::format("{} cycles in {} samples, {} fits in {}", test.cycles, test.samples, test.fits,
                  test.output),
      report::Quantity(test.energy, "J", 6) + " dissipated by the cycles that close"};
  if (test.unused_samples > 0) {
    facts.push_back(
        fmt::format("{} samples at the ends belong to no whole cycle", test.unused_samples));
  }
  for (const std::string& note : test.notes) facts.push_back("note: " + note);
  return facts;
}

std::string ToText(const TrackedTest& test, const Json& quantities) {
  std::string text = fmt::format("{}\n{}\n", test.Headline(), fmt::join(Facts(test), "\n"));
  if (!test.flags.empty()) text += '\n' + report::TableText(FlagRows(test));
  text += '\n' + report::TableText(quantities);
  const std::vector<std::string> changes = campaign::ChangeStatements(test.evolutions);
  if (changes.empty()) return text;
  return text + fmt::format("\nChanges beyond chance:\n  {}\n", fmt::join(changes, "\n  "));
}

std::string ToPage(const TrackedTest& test, const Json& quantities, std::string_view command) {
  const std::vector<std::string> changes = campaign::ChangeStatements(test.evolutions);
  std::string figures;
  std::size_t count = 0;
  for (const io::PlotPanel& panel : campaign::EvolutionPanels(test.evolutions)) {
    figures += report::FigureHtml(
        fmt::format("evolution-{}", ++count), panel.y_label,
        "Dashed lines are steps beyond chance, and where the quantity settled.", panel);
  }
  if (test.log.size() > 1) {
    figures += report::FigureHtml("loops", "Loops", "Measured, of the cycles in the legend.",
                                  campaign::FrettingLog(test.log, test.is_torsional));
  }
  const bool is_steady = changes.empty() && test.cycles_without == 0;
  const char* const word = is_steady ? "steady" : changes.empty() ? "incomplete" : "changed";
  const std::string verdict =
      test.is_established ? report::VerdictHtml(is_steady ? "good" : "poor", word, test.Headline())
                          : report::VerdictHtml("bad", "failed", "no fit of a cycle converged");
  return report::PageHtml(
      fmt::format("{}: {} cycles", report::NameOf(test.files), test.cycles),
      verdict + (test.is_established ? report::ListHtml(changes) : "") +
          report::SectionHtml(
              "Over the test",
              report::ListHtml(Facts(test)) +
                  report::TableHtml("first and last row of the table of cycles", quantities)) +
          report::SectionHtml("Evolution", report::SideBySide(figures)) +
          report::SectionHtml(
              "What to mind",
              report::TableHtml("cycles with a flag", FlagRows(test)) +
                  report::ParagraphHtml("Errors assume that the model is adequate: check some "
                                        "cycles with mindahl fit.")),
      command);
}

// --- the run

/// Reads a test of many cycles piece by piece, fits each, and appends its row to the table.
class TrackRun {
 public:
  explicit TrackRun(const TrackCommandOptions& options)
      : options_(options), test_{.output = options.output} {}

  /// @throws InputError naming the place in a file; the batches before it are in the table
  TrackedTest Track() {
    for (const std::string& file : options_.fit.files) ReadFile(file);
    tracker_->Finish();
    if (!last_batch_.empty()) RefuseTable();  // the record ends before the table
    if (output_) output_->Finish();
    test_.cycles = tracker_->cycles();
    test_.log = tracker_->log();
    if (test_.cycles == 0) {
      Refuse(
          "{}: no whole cycle: it lasts from one turning point to the next but one, which the ends "
          "of a file are not, and there are not three by more than {:.3g} m: use mindahl fit for a "
          "single cycle, another --displacement, or a smaller --reversal-gate",
          fmt::join(test_.files, ", "), test_.gate.gate);
    }
    campaign::Describe(test_.evolutions);
    return std::move(test_);
  }

 private:
  void BeginFits(const loop::RecordView& head, const io::RecordFile& layout) {
    campaign::TrackOptions options = options_.track;
    options.fit = MakeCycleFitOptions(options_.fit);
    if (!test_.is_torsional) {
      options.compliance = contact::TangentialCompliance(options_.fit.contact.known);
    }
    test_.gate = campaign::ChooseGate(head, options.fit);
    test_.columns = report::ColumnsText(layout, *options.fit.preparation.force_sense);
    const std::string chosen_terms = ChooseTermsOfCycles(options_.fit, head, options.fit);
    if (!chosen_terms.empty()) test_.notes.push_back(chosen_terms);
    campaign::RequireFit(head, options.fit);
    test_.evolutions = campaign::BeginEvolutions(test_.is_torsional);
    Resume();
    options.skipped = test_.fits;
    if (!test_.gate.certain) {
      test_.notes.push_back(
          fmt::format("{}: the number of reversals under a gate of {:.3g} m is not certain: set "
                      "--reversal-gate",
                      layout.name, test_.gate.gate));
    }
    tracker_.emplace(std::move(options), [this](std::span<const CycleFit> fits) { Take(fits); });
  }

  void ReadFile(const std::string& file) {
    io::RecordStream stream(file, options_.fit.columns);
    const io::RecordFile& layout = stream.layout();
    test_.files.push_back(layout.name);
    if (!tracker_) test_.is_torsional = layout.is_torsional;
    if (layout.is_torsional != test_.is_torsional) {
      Refuse("{} and {} hold a force and a torque: track them apart", test_.files.front(),
             layout.name);
    }
    test_.notes.insert(test_.notes.end(), layout.notes.begin(), layout.notes.end());
    io::Samples piece;
    if (tracker_) {
      stream.Next(piece);
    } else {
      piece = campaign::ReadHead(stream);
      io::RecordFile head = layout;
      head.record.displacement = piece.displacement;
      head.lines = piece.lines;
      request::RequireLoops({head});
      BeginFits(piece, layout);
    }
    while (piece.size() > 0) {
      test_.samples += piece.size();
      tracker_->Add(piece, piece.lines);
      AskWhetherToGoOn();
      if (!stream.Next(piece)) break;
    }
    test_.unused_samples += tracker_->NextFile();
    const io::LeftOutRows& left_out = layout.left_out;
    if (left_out.count == 0) return;
    test_.broken_rows += left_out.count;
    test_.notes.push_back(left_out.InWords());
  }

  /// Takes over the batches that the table has already, but for the last, which is fitted again to
  /// compare, as are the rows behind it.
  /// @throws InputError where the file is no such table
  void TakeOverTable() {
    std::ifstream file(options_.output, std::ios::binary);
    const std::string header = campaign::CycleTableHeader(test_.is_torsional);
    std::string line;
    std::getline(file, line);
    if (line + '\n' != header) Refuse("its first line is another");
    kept_bytes_ = header.size();
    std::string batch;
    std::size_t rows = 0;
    // A line without a line feed was being written when a run was killed, and is no row.
    while (std::getline(file, line) && !file.eof()) {
      batch += line + '\n';
      if (++rows % campaign::kBatch != 0) continue;
      for (const std::string_view row : PartsOf(last_batch_, '\n')) {
        if (!row.empty()) test_.Add(campaign::ReadCycleTableRow(row, test_.is_torsional));
      }
      kept_bytes_ += batch.size();
      last_batch_ = std::exchange(batch, {});
    }
    // The last row may be that of a record which has grown since.
    batch.erase(batch.rfind('\n', batch.empty() ? 0 : batch.size() - 2) + 1);
    rows_behind_ = std::move(batch);
  }

  /// Takes over what the table has already, where that is asked for and there is one.
  void Resume() {
    std::error_code error;
    if (!options_.resume || std::filesystem::file_size(options_.output, error) == 0 || error)
      return;
    try {
      TakeOverTable();
    } catch (const InputError& fault) {
      Refuse("--resume: {} is no table of such cycles: {}", options_.output, fault.what());
    }
  }

  [[noreturn]] void RefuseTable() const {
    Refuse(
        "--resume: {} was made from another record or with other options: give those, another "
        "--output, or --overwrite",
        options_.output);
  }

  /// Appends the rows of a batch, or compares them with the last that are kept.
  void Take(std::span<const CycleFit> fits) {
    std::string rows;
    for (const CycleFit& fit : fits) {
      test_.Add(fit);
      rows += campaign::CycleTableRow(fit, test_.energy, test_.is_torsional);
    }
    const bool is_kept = !last_batch_.empty();
    if (is_kept && std::exchange(last_batch_, {}) != rows) RefuseTable();
    if (!is_kept && !rows.starts_with(std::exchange(rows_behind_, {}))) RefuseTable();
    if (!output_) {
      output_.emplace(options_.output, kept_bytes_);
      if (kept_bytes_ == 0) output_->Append(campaign::CycleTableHeader(test_.is_torsional));
    }
    if (!is_kept) output_->Append(rows);
  }

  const TrackCommandOptions& options_;
  TrackedTest test_;
  std::optional<campaign::Tracker> tracker_;
  // A resumed run keeps the complete batches of the table on disk; a new run keeps none.
  std::uintmax_t kept_bytes_ = 0;  // size of the header and of all batches
  std::string last_batch_;         // rows of the last one
  std::string rows_behind_;        // whole rows behind it, but for the last
  std::optional<io::AppendedFile> output_;
};

void RunTrack(const TrackCommandOptions& options, Console& console) {
  Validate(options.fit.contact);
  // A table is the work of hours; a device loses nothing.
  std::error_code ignored;
  if (!options.resume && !options.overwrite &&
      std::filesystem::is_regular_file(options.output, ignored)) {
    Refuse("--output: {} exists: add --resume to go on with it, or --overwrite", options.output);
  }
  const TrackedTest test = TrackRun(options).Track();
  console.exit_status = test.is_established ? kDone : kNotEstablished;
  const Json quantities = QuantityRows(test);
  if (!options.report_path.empty()) {
    io::WriteFileAtomically(options.report_path, ToPage(test, quantities, console.command_line));
  }
  WriteAnswer(console, ToJson(test, quantities), ToText(test, quantities));
}

}  // namespace

void AddTrackCommand(CLI::App& app, Console& console) {
  const auto [command, options] =
      AddCommand(app, console, "track",
                 "Fits every cycle of a long record while reading it, in constant\n"
                 "memory: one row a cycle, and the changes over the test. --resume\n"
                 "continues a run that was ended. Exit status 3 when no fit converged.",
                 {"mindahl track day1.csv --output cycles.csv",
                  "mindahl track day1.csv day2.csv --output all_cycles.csv --normal-load 50 --json "
                  "track.json"},
                 &RunTrack);
  OptionGroup(command, kPlainGroup)
      .Add("files", options.fit.files,
           "CSV records of one test, in order; no cycle extends over two files", "FILE")
      ->required();
  AddColumnOptions(command, options.fit.columns);
  AddModelOptions(command, options.fit, /*of_cycles=*/true);
  for (const char* refused : {"--compare", "--covariate", "--noise-in"}) {
    command.get_option(refused)->group("");
  }
  AddContactOptions(command, options.fit.contact);
  const OptionGroup cycles(command, "Cycles");
  cycles.AddCount("--average", options.track.together,
                  "consecutive cycles that are fitted together, fewer at a file's end", 1,
                  1'000'000);
  cycles.AddChoice("--broken-rows", options.fit.columns.skip_broken_rows,
                   {{"refuse", false}, {"skip", true}},
                   "rows without a number in a needed column; skip counts them");
  cycles.AddThreads(options.track.threads, "the table");
  const OptionGroup group(command, "Results");
  group.Add("--output", options.output, "table of cycles as CSV, one row a cycle", "PATH")
      ->required();
  group.AddJson(console);
  group.Add("--report", options.report_path,
            "everything with its figures on one self-contained page of HTML", "PATH");
  CLI::Option* const resume = group.AddFlag(
      "--resume", options.resume, "continue an existing table, with the same files and options");
  group.AddFlag("--overwrite", options.overwrite, "replace an existing table")->excludes(resume);
}

}  // namespace mindahl::cli
