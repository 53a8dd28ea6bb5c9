#include <fmt/ranges.h>

#include <array>
#include <cerrno>
#include <cstring>
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
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
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
  std::string json_path;
  std::string report_path;
  bool resume = false;
  bool overwrite = false;
};

/// Holds the answer for a test of many cycles, apart from its rows.
struct TrackedTest {
  std::vector<std::string> files = {};
  std::string output = {};
  bool is_torsional = false;
  std::size_t samples = 0;
  std::size_t cycles = 0;
  std::size_t unused_samples = 0;  // at the ends, part of no whole cycle
  std::size_t broken_rows = 0;     // rows skipped
  loop::ReversalGate gate = {};
  std::size_t fits = 0;
  std::size_t flagged = 0;
  std::size_t resumed = 0;                                     // fits that the table had already
  std::map<std::string, std::size_t, std::less<>> flags = {};  // how many fits have each
  campaign::DissipatedEnergy energy = {};
  std::vector<campaign::Cycle> log = {};  // loops of the cycles 1, 10, 100, …
  std::vector<Evolution> evolutions = {};
  std::vector<std::string> notes = {};  // what was assumed, one sentence each

  /// Adds a fit whose row is in the table, in their order, but for its energy.
  void Add(const CycleFit& fit) {
    ++fits;
    flagged += fit.flags.empty() ? 0 : 1;
    for (const std::string& flag : fit.flags) ++flags[flag];
    campaign::AddTo(evolutions, fit);
  }
  /// Returns the number of fits with a flag.
  [[nodiscard]] std::size_t CountOf(std::string_view flag) const {
    return flags.contains(flag) ? flags.find(flag)->second : 0;
  }
  /// False where no fit converged.
  [[nodiscard]] bool established() const { return fits == 0 || CountOf("not_converged") < fits; }
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
        {"steps", Json::array()},
        {"trends", Json::array()}};
    for (const campaign::Change& change : course.changes) {
      Json& row = quantities[std::string(evolution.quantity->name)];
      if (change.is_step()) {
        row["steps"].push_back({{"cycle", change.first_cycle},
                                {"before", change.from},
                                {"after", change.to},
                                {"p_value", change.p_value}});
      } else {
        row["trends"].push_back({{"first_cycle", change.first_cycle},
                                 {"last_cycle", change.last_cycle},
                                 {"from", change.from},
                                 {"to", change.to},
                                 {"p_value", change.p_value}});
      }
    }
  }
  return quantities;
}

std::string ToJson(const TrackedTest& test, const Json& quantities) {
  Json flags = Json::object();
  for (const campaign::CycleFlag& flag : campaign::CycleFlags()) {
    flags[flag.name] = test.CountOf(flag.name);
  }
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
                          {"flagged", test.flagged},
                          {"flags", std::move(flags)},
                          {"accumulated_energy", test.energy.total},
                          {"headline", campaign::Headline(test.evolutions)},
                          {"changes", campaign::ChangeStatements(test.evolutions)},
                          {"quantities", quantities},
                          {"notes", test.notes}});
}

/// Returns the flags that a cycle has, with what they say.
Json FlagRows(const TrackedTest& test) {
  Json rows = Json::object();
  for (const campaign::CycleFlag& flag : campaign::CycleFlags()) {
    const std::size_t cycles = test.CountOf(flag.name);
    if (cycles > 0) rows[flag.name] = {{"cycles", cycles}, {"what it says", flag.meaning}};
  }
  return rows;
}

/// Returns what was read, fitted and dissipated, one sentence each.
std::vector<std::string> Facts(const TrackedTest& test) {
  std::vector<std::string> facts = {
      fmt::format("{} cycles in {} samples, {} fits in {}", test.cycles, test.samples, test.fits,
                  test.output),
      report::Quantity(test.energy.total, "J", 6) + " dissipated in all"};
  if (test.resumed > 0) facts.push_back(fmt::format("{} fits existed already", test.resumed));
  if (test.unused_samples > 0) {
    facts.push_back(
        fmt::format("{} samples at the ends belong to no whole cycle", test.unused_samples));
  }
  for (const std::string& note : test.notes) facts.push_back("note: " + note);
  return facts;
}

std::string ToText(const TrackedTest& test, const Json& quantities) {
  std::string text = campaign::Headline(test.evolutions) + '\n' +
                     fmt::format("{}\n", fmt::join(Facts(test), "\n"));
  if (test.flagged > 0) {
    text += fmt::format("\ncycles with a flag: {}\n{}", test.flagged,
                        report::TableText(FlagRows(test)));
  }
  if (test.evolutions.empty()) return text;
  text += '\n' + report::TableText(quantities);
  const std::vector<std::string> changes = campaign::ChangeStatements(test.evolutions);
  const bool is_tested = std::ranges::any_of(test.evolutions, &campaign::Evolution::is_tested);
  if (changes.empty() && !is_tested) return text;
  if (changes.empty()) return text + "\nNo step of 2 % and no trend of 1 % is beyond chance.\n";
  return text + fmt::format("\nChanges beyond chance:\n  {}\n", fmt::join(changes, "\n  "));
}

std::string ToPage(const TrackedTest& test, const report::Provenance& provenance) {
  const std::vector<std::string> changes = campaign::ChangeStatements(test.evolutions);
  std::string figures;
  std::size_t count = 0;
  std::vector<io::PlotPanel> panels = campaign::EvolutionPanels(test.evolutions);
  if (test.log.size() > 1) panels.push_back(campaign::FrettingLog(test.log, test.is_torsional));
  for (const io::PlotPanel& panel : panels) {
    figures += report::FigureHtml(
        {.id = fmt::format("evolution-{}", ++count),
         .title = panel.y_label,
         .text = "Dashed lines are steps beyond chance, and where the quantity settled.",
         .element = "h3"},
        panel);
  }
  const bool is_failed = !test.established();
  const std::string flags = report::TableHtml("cycles with a flag", FlagRows(test));
  return report::PageHtml(
      fmt::format("{}: {} cycles", report::NameOf(test.files), test.cycles),
      (is_failed ? report::VerdictHtml("bad", "failed", "no fit of a cycle converged")
                 : report::VerdictHtml(changes.empty() ? "good" : "poor",
                                       changes.empty() ? "steady" : "changed",
                                       campaign::Headline(test.evolutions)) +
                       report::ListHtml(changes)) +
          report::SectionHtml("Over the test",
                              report::ListHtml(Facts(test)) +
                                  report::TableHtml("first and last row of the table of cycles",
                                                    QuantityRows(test))) +
          report::SectionHtml("Evolution", report::SideBySide(figures)) +
          report::SectionHtml(
              "What to mind",
              (flags.empty() ? report::ParagraphHtml("No cycle has a flag.") : flags) +
                  report::ParagraphHtml("Errors assume that the model is adequate: check some "
                                        "cycles with mindahl fit.")) +
          report::ProvenanceHtml(provenance));
}

// --- the run

void RequireTrackOptions(const TrackCommandOptions& options) {
  MakeCycleFitOptions(options.fit);
  Validate(options.fit.contact);
  // A table is the work of hours; a device loses nothing.
  std::error_code ignored;
  if (options.resume || options.overwrite) return;
  if (!std::filesystem::is_regular_file(options.output, ignored)) return;
  Refuse("--output: {} exists: add --resume to go on with it, or --overwrite", options.output);
}

/// Returns a word of the options that rows depend on, FNV-1a (Fowler, Noll & Vo 1991) of their
/// names and values: rows made with others are not gone on with, though the last ones be the same.
std::uint64_t SeedOf(const CLI::App& command) {
  constexpr auto kOfNoRow = std::to_array<std::string_view>(
      {"help", "output", "json", "report", "resume", "overwrite", "threads"});
  std::string words;
  for (const CLI::Option* option : OptionsOf(command)) {  // not the files, whose content counts
    if (std::ranges::find(kOfNoRow, NameOf(*option)) != kOfNoRow.end()) continue;
    words += NameOf(*option);
    for (const std::string& value : option->results()) words += "=" + value;
    if (option->count() == 0) words += "=" + option->get_default_str();
  }
  std::uint64_t seed = 0xcbf29ce484222325U;
  for (const char letter : words) {
    seed = (seed ^ static_cast<unsigned char>(letter)) * 0x100000001b3U;
  }
  return seed;
}

/// Holds what a resumed run keeps of the table on disk: its whole batches, if it has any.
struct KeptCycles {
  std::size_t fits = 0;
  std::uintmax_t bytes = 0;    // size of the header and these
  std::uint64_t checksum = 0;  // of what the last of them was made from
};

/// @param visit  is given every row that is kept
/// @throws InputError where the file is no such table
KeptCycles ReadKeptCycles(const std::string& path, bool is_torsional,
                          const std::function<void(const CycleFit&)>& visit) {
  constexpr std::string_view kRemedy = "give another --output, or --overwrite";
  std::ifstream file(path, std::ios::binary);
  if (!file) Refuse("cannot read '{}': {}", path, std::strerror(errno));
  std::string line;
  std::getline(file, line);
  const std::string header = campaign::CycleTableHeader(is_torsional);
  if (line + '\n' != header) {
    Refuse("--resume: {} is no table of such cycles, its first line is another: {}", path, kRemedy);
  }
  KeptCycles kept;
  std::vector<CycleFit> batch;
  std::uintmax_t bytes = header.size();
  // A line without a line feed was being written when a run was killed, and is no row.
  while (std::getline(file, line) && !file.eof()) {
    try {
      batch.push_back(campaign::ReadCycleTableRow(line, is_torsional));
    } catch (const InputError& error) {
      Refuse("--resume: {}:{}: {}: {}", path, kept.fits + batch.size() + 2, error.what(), kRemedy);
    }
    bytes += line.size() + 1;
    if (batch.size() < campaign::kBatch) continue;
    std::ranges::for_each(batch, visit);
    kept = {kept.fits + batch.size(), bytes, batch.back().checksum};
    batch.clear();
  }
  return kept;
}

/// Reads a test of many cycles piece by piece, fits each, and appends its row to the table.
class TrackRun {
 public:
  TrackRun(const TrackCommandOptions& options, const CLI::App& command)
      : options_(options),
        command_(command),
        test_{.output = options.output, .energy = {.together = options.track.together}} {}

  /// @throws InputError naming the place in a file; the batches before it are in the table
  TrackedTest Track() {
    for (const std::string& file : options_.fit.files) ReadFile(file);
    tracker_->Finish();
    if (kept_.fits > 0) OpenTable();  // also of a record that ends with it, or before
    if (output_) output_->Finish();
    test_.cycles = tracker_->cycles();
    test_.log = tracker_->log();
    if (test_.cycles == 0) {
      Refuse(
          "{}: no whole cycle{}: the displacement turns {} times by more than {:.3g} m: choose "
          "another column with --displacement, or a smaller --reversal-gate",
          fmt::join(test_.files, ", "),
          options_.track.together > 1 ? ", or fewer than --average says" : "", test_.gate.count,
          test_.gate.gate);
    }
    campaign::Describe(test_.evolutions);
    return std::move(test_);
  }

 private:
  void BeginSource(const io::RecordFile& layout) {
    test_.files.push_back(layout.name);
    if (test_.files.size() == 1) {
      test_.is_torsional = layout.is_torsional;
      test_.evolutions = campaign::BeginEvolutions(test_.is_torsional);
    }
    test_.notes.insert(test_.notes.end(), layout.notes.begin(), layout.notes.end());
    if (layout.is_torsional == test_.is_torsional) return;
    Refuse("{} holds a {} and {} a {}: track them apart", test_.files.front(),
           test_.is_torsional ? "torque" : "force", layout.name,
           layout.is_torsional ? "torque" : "force");
  }

  void BeginFits(const loop::RecordView& head, std::string_view source) {
    const contact::KnownContact& known = options_.fit.contact.known;
    campaign::TrackOptions options = options_.track;
    options.fit = MakeCycleFitOptions(options_.fit);
    if (!test_.is_torsional) options.compliance = contact::TangentialCompliance(known);
    if (known.normal_load) options.fit.normal_loads = {known.normal_load->value};
    test_.gate = campaign::ChooseGate(head, options.fit);
    const std::string chosen_terms = ChooseTermsOfCycles(options_.fit, head, options.fit);
    if (!chosen_terms.empty()) test_.notes.push_back(chosen_terms);
    Resume(options);
    const loop::ReversalGate& gate = test_.gate;
    if (!gate.certain) {
      test_.notes.push_back(fmt::format(
          "{}: the number of reversals is not certain: in the first {} samples {} with a gate of "
          "{:.3g} m, {} with {:.3g} m: set --reversal-gate",
          source, head.size(), gate.count, gate.gate, gate.other_count, gate.other_gate));
    }
    tracker_.emplace(std::move(options), [this](std::span<const CycleFit> fits) { Take(fits); });
  }

  void ReadFile(const std::string& file) {
    io::RecordStream stream(file, options_.fit.columns);
    BeginSource(stream.layout());
    io::Samples piece;
    if (tracker_) {
      stream.Next(piece);
    } else {
      piece = campaign::ReadHead(stream);
      BeginFits(piece, file);
    }
    while (piece.size() > 0) {
      test_.samples += piece.size();
      tracker_->Add(piece, piece.lines);
      AskWhetherToGoOn();
      if (!stream.Next(piece)) break;
    }
    test_.unused_samples += tracker_->NextFile();
    const io::LeftOutRows& left_out = stream.layout().left_out;
    if (left_out.count == 0) return;
    if (options_.fit.columns.skip_broken_rows) test_.broken_rows += left_out.count;
    test_.notes.push_back(left_out.InWords());
  }

  /// Takes over what the table has already, where that is asked for.
  void Resume(campaign::TrackOptions& made) {
    made.seed = SeedOf(command_);
    std::error_code error;
    if (!options_.resume || std::filesystem::file_size(options_.output, error) == 0 || error)
      return;
    kept_ = ReadKeptCycles(options_.output, test_.is_torsional, [&](const CycleFit& fit) {
      test_.energy.Add(fit);
      test_.Add(fit);
    });
    test_.resumed = kept_.fits;
    made.skipped = kept_.fits;
  }

  /// Opens the table behind what is kept of it.
  void OpenTable() {
    if (output_) return;
    if (kept_.fits > 0 && tracker_->skipped_up_to() != kept_.checksum) {
      Refuse(
          "--resume: {} was made from another record or with other options, or what was read "
          "before "
          "its row {} was another: give those, another --output, or --overwrite",
          options_.output, kept_.fits);
    }
    output_.emplace(options_.output, kept_.bytes);
    if (kept_.fits == 0) output_->Append(campaign::CycleTableHeader(test_.is_torsional));
  }

  /// Appends the rows of a batch.
  void Take(std::span<const CycleFit> fits) {
    OpenTable();
    std::string rows;
    for (const CycleFit& fit : fits) {
      test_.energy.Add(fit);
      rows += campaign::CycleTableRow(fit, test_.energy.total, test_.is_torsional);
    }
    output_->Append(rows);
    for (const CycleFit& fit : fits) test_.Add(fit);
  }

  const TrackCommandOptions& options_;
  const CLI::App& command_;
  TrackedTest test_;
  std::optional<campaign::Tracker> tracker_;
  KeptCycles kept_;
  std::optional<io::AppendedFile> output_;
};

void RunTrack(const TrackCommandOptions& options, const CLI::App& command, Console& console) {
  RequireDistinctFiles(options.fit.files);
  RequireTrackOptions(options);
  const TrackedTest test = TrackRun(options, command).Track();
  console.exit_status = test.established() ? kDone : kNotEstablished;
  if (!options.report_path.empty()) {
    io::WriteFileAtomically(options.report_path,
                            ToPage(test, ProvenanceOf(console.command_line, InputsOf(command))));
  }
  const Json quantities = QuantityRows(test);
  WriteAnswer(options.json_path, console, ToJson(test, quantities), ToText(test, quantities));
}

}  // namespace

void AddTrackCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<TrackCommandOptions>();
  CLI::App& command =
      AddCommand(app, "track",
                 "Fits every cycle of a long record while reading it, in constant\n"
                 "memory: one row a cycle, and the changes over the test. --resume\n"
                 "continues a run that was ended. Exit status 3 when no fit converged.",
                 {"mindahl track day1.csv --output cycles.csv",
                  "mindahl track day1.csv day2.csv --output all_cycles.csv --normal-load 50 --json "
                  "track.json"});
  OptionGroup(command, kPlainGroup)
      .Add("files", options->fit.files,
           "CSV records of one test, in order; no cycle extends over two files", "FILE")
      ->required();
  AddColumnOptions(command, options->fit.columns);
  AddModelOptions(command, options->fit);
  for (const char* refused : {"--compare", "--covariate", "--noise-in"}) {
    command.get_option(refused)->group("");
  }
  AddContactOptions(command, options->fit.contact);
  const OptionGroup cycles(command, "Cycles");
  cycles.AddCount("--average", options->track.together,
                  "number of consecutive cycles that are fitted together", 1, 1'000'000);
  cycles.AddChoice("--broken-rows", options->fit.columns.skip_broken_rows,
                   {{"refuse", false}, {"skip", true}},
                   "rows without a number in a needed column; skip counts them");
  AddThreads(cycles, options->track.threads, "the table");
  const OptionGroup group(command, "Results");
  group.Add("--output", options->output, "table of cycles as CSV, one row a cycle", "PATH")
      ->required();
  group.Add("--json", options->json_path, "summary as JSON; - for standard output alone", "PATH");
  group.Add("--report", options->report_path,
            "everything with its figures on one self-contained page of HTML", "PATH");
  CLI::Option* const resume = group.AddFlag(
      "--resume", options->resume, "continue an existing table, with the same files and options");
  group.AddFlag("--overwrite", options->overwrite, "replace an existing table")->excludes(resume);
  OnRun(command, [options, &command, &console] { RunTrack(*options, command, console); });
}

}  // namespace mindahl::cli
