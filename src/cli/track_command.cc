#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "cli/app.h"
#include "cli/contact_options.h"
#include "cli/file_list.h"
#include "cli/fit_request.h"
#include "cli/kept_cycles.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/provenance.h"
#include "io/source.h"
#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/test_summary.h"
#include "mindahl/campaign/tracker.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_stream.h"
#include "mindahl/request/fit_request.h"
#include "mindahl/request/track.h"

namespace mindahl::cli {
namespace {

using campaign::CycleFit;
using request::TrackedTest;

struct TrackCommandOptions {
  request::TrackRequest track{.threads = std::max(1U, std::thread::hardware_concurrency())};
  FileList list;
  std::string broken_rows = "refuse";
  std::string output;
  std::string json_path;
  std::string plot_path;
  std::string report_path;
  bool separate = false;
  bool resume = false;
  bool overwrite = false;
};

/// Says where the rows of a test stand in a table of several separate tests.
struct RowPlace {
  bool is_one_of_many = false;
  std::string before;         // cells before those of a cycle
  std::uintmax_t offset = 0;  // [bytes] of the table before the test's first row
  bool has_rows = false;      // some of them are there, of a run that was ended
};

void RequireTrackOptions(const TrackCommandOptions& options) {
  request::Validate(options.track);
  if (options.resume && options.overwrite) {
    throw InputError("--resume and --overwrite contradict each other: give one of the two");
  }
  std::error_code error;
  const std::string extension = std::filesystem::path(options.output).extension().string();
  if (extension == ".parquet" || extension == ".xlsx" || extension == ".h5") {
    throw InputError(fmt::format(
        "--output: {}: the table is CSV: give a name that ends in .csv (docs/queries.md makes "
        "Parquet of it)",
        options.output));
  }
  const auto status = std::filesystem::status(options.output, error);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    throw InputError(
        fmt::format("--output: {} is no file: rows are appended to the table, give the name of one",
                    options.output));
  }
  if (options.resume || options.overwrite) return;
  RequireNotThere({"--output", options.output}, "--resume to go on with it, or --overwrite");
}

/// Returns a word of the options that rows depend on, FNV-1a (Fowler, Noll & Vo 1991) of their
/// names and values: rows made with others are not gone on with, though the last ones be the same.
std::uint64_t SeedOf(const CLI::App& command) {
  constexpr std::array<std::string_view, 11> kOfNoRow = {
      "help",     "output",    "json",    "plot",       "report", "resume",
      "separate", "overwrite", "threads", "files-from", "shard"};
  std::uint64_t seed = 0xcbf29ce484222325U;
  const auto add = [&seed](std::string_view text) {
    for (const char character : text) {
      seed = (seed ^ static_cast<unsigned char>(character)) * 0x100000001b3U;
    }
  };
  for (const OptionState& option : OptionsOf(command)) {  // not the files, whose content counts
    if (std::ranges::find(kOfNoRow, option.name) != kOfNoRow.end()) continue;
    add(option.name);
    for (const std::string& value : option.values) add("=" + value);
    if (!option.is_given) add("=" + option.default_text);
  }
  return seed;
}

class TrackRun {
 public:
  TrackRun(const TrackCommandOptions& options, const CLI::App& command, Console& console,
           RowPlace place = {})
      : options_(options),
        command_(command),
        console_(console),
        place_(std::move(place)),
        messages_{console.err, "track"},
        run_(options.track, {.fits = [this](std::span<const CycleFit> fits) { Take(fits); },
                             .note = [this](std::string_view text) { messages_.Note(text); },
                             .warn = [this](std::string_view text) { messages_.Warn(text); },
                             .begins = [this](campaign::TrackOptions& made) { Begin(made); },
                             .piece_is_read = [this] { RequireNoSignal(); }}),
        end_(place_.offset) {}

  void Go();
  /// Reads a record of one of many tests and writes its rows, up to its fault where it has one.
  void TrackOneOfMany();

  /// Returns why one of many tests ended before its record; empty where it did not.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const TrackedTest& test() const { return run_.test(); }
  /// Returns the size [bytes] of the table with the test's last row.
  [[nodiscard]] std::uintmax_t end() const { return end_; }

 private:
  void Track();
  [[nodiscard]] bool EndsTheTestAlone() const;
  [[nodiscard]] std::string After() const;
  void Begin(campaign::TrackOptions& made);
  void RequireNoSignal() const;
  void Take(std::span<const CycleFit> fits);
  [[noreturn]] void ThrowOther();
  void SayProgress();
  void Draw(const std::vector<campaign::Evolution>& evolutions);

  const TrackCommandOptions& options_;
  const CLI::App& command_;
  Console& console_;
  RowPlace place_;
  Messages messages_;
  request::TrackRun run_;
  std::optional<KeptCycles> kept_;  // until its last batch was made again
  std::optional<io::AppendedFile> output_;
  std::uintmax_t end_ = 0;         // [bytes] of the table that is written
  bool has_write_failed_ = false;  // or is at work
  bool is_refused_ = false;        // rows that are there are another run's
  std::string fault_;
  std::optional<io::DeferredSignals> signals_;  // while rows are written
  std::optional<Progress> progress_;
  std::uintmax_t bytes_ = 0;  // of all files
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

void TrackRun::Begin(campaign::TrackOptions& made) {
  TrackedTest& test = run_.test();
  if (!run_.chosen_terms().empty()) messages_.Note(run_.chosen_terms());
  const double gate = *made.fit.preparation.reversal_gate;
  if (!run_.reading().gate_is_given && gate > 0) {
    messages_.Note(
        fmt::format("excursions up to {:.4g} m are noise, by the first {} samples: --reversal-gate "
                    "says another",
                    gate, run_.reading().samples));
  }
  const std::string header = campaign::CycleTableHeader(test.is_torsional);
  std::error_code error;
  const bool has_rows =
      place_.is_one_of_many
          ? place_.has_rows
          : options_.resume && std::filesystem::file_size(options_.output, error) > 0 && !error;
  if (has_rows) {
    if (!place_.is_one_of_many) RequireHeader(options_.output, header);
    campaign::DissipatedEnergy energy = test.energy;
    kept_ = ReadKeptCycles(options_.output,
                           {.offset = place_.is_one_of_many ? place_.offset : header.size(),
                            .before = place_.before,
                            .after = After()},
                           [&](const campaign::CycleTableEntry& entry) {
                             if (test.fits % campaign::kBatch == 0)
                               test.energy = energy;  // before the last batch
                             energy.Add(entry.fit);
                             test.Add(entry.fit);
                           });
    test.resumed = kept_->fits;
    if (kept_->fits == 0) kept_.reset();
  }
  made.skipped = kept_ ? kept_->fits - campaign::kBatch : 0;
  made.seed = SeedOf(command_);
  progress_.emplace(console_.err, "tracking cycles");
}

/// The rows of a batch: appended; or, of the last that is kept, compared with what is there.
void TrackRun::Take(std::span<const CycleFit> fits) {
  std::string rows;
  const std::string after = After() + "\n";
  for (const CycleFit& fit : fits) {
    run_.test().energy.Add(fit);
    const std::string row = campaign::CycleTableRow(fit, test().energy.total());
    rows.append(place_.before).append(row, 0, row.size() - 1).append(after);
  }
  if (kept_) {
    if (rows != kept_->last_batch) ThrowOther();
    has_write_failed_ = true;
    output_.emplace(options_.output, kept_->bytes);
    has_write_failed_ = false;
    end_ = kept_->bytes;
    kept_.reset();
    return;
  }
  has_write_failed_ = true;
  if (!output_) {
    output_.emplace(options_.output, place_.offset);
    if (!place_.is_one_of_many) output_->Append(campaign::CycleTableHeader(test().is_torsional));
  }
  output_->Append(rows);
  has_write_failed_ = false;
  end_ += rows.size();
  for (const CycleFit& fit : fits) run_.test().Add(fit);
  SayProgress();
}

/// Returns the cells after those of a cycle.
std::string TrackRun::After() const {
  if (!place_.is_one_of_many) return "";
  return test().is_torsional ? ",torque" : ",force";
}

void TrackRun::ThrowOther() {
  is_refused_ = true;
  throw InputError(fmt::format(
      "--resume: {} was made from another record or with other options, its rows {} to {} "
      "come out differently or what was read before them: give those, another "
      "--output, or --overwrite",
      options_.output, kept_->fits - campaign::kBatch + 1, kept_->fits));
}

void TrackRun::SayProgress() {
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double share = static_cast<double>(run_.bytes_read()) /
                       static_cast<double>(std::max<std::uintmax_t>(bytes_, 1));
  const auto made = static_cast<double>(test().fits - test().resumed);
  progress_->Say(fmt::format("{} cycles, {:.0f} % of {:.3g} MB, {:.3g} a second, {:.0f} s left",
                             run_.cycles(), 100 * share, static_cast<double>(bytes_) / 1e6,
                             made / seconds, seconds * (1 - share) / std::max(share, 1e-3)));
}

void TrackRun::RequireNoSignal() const {
  if (signals_->noted() != 0) throw InputError("stopped by a signal");
}

void TrackRun::Track() {
  const std::vector<std::string>& files = options_.track.fit.files;
  for (const std::string& file : files) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error) bytes_ += size;
  }
  signals_.emplace();
  try {
    run_.Read();
    if (kept_) ThrowOther();  // a record that ends before them
    has_write_failed_ = true;
    if (output_) output_->Finish();
    has_write_failed_ = false;
    RequireNoSignal();
  } catch (const InputError& error) {
    if (EndsTheTestAlone()) throw;
    // Finished rows are kept, unless they are another run's, or there are none.
    const bool is_stopped = signals_->noted() != 0;
    if (!run_.has_begun() && is_stopped)
      throw InputError("stopped by a signal before the first row");
    if (!run_.has_begun() || (kept_ && !is_stopped)) throw;
    try {
      if (!has_write_failed_) run_.FitTheRest();
      if (output_) output_->Finish();
    } catch (const InputError&) {  // NOLINT(bugprone-empty-catch): the disk, as the first one says
    }
    const std::string what = is_stopped ? "stopped by a signal" : error.what();
    if (place_.is_one_of_many) throw InputError(what);
    throw InputError(fmt::format("{}; {} rows are kept in {}: {}add --resume", what, test().fits,
                                 options_.output, is_stopped ? "" : "repair the fault and "));
  }
  signals_.reset();
  progress_.reset();
  run_.Finish();
}

/// True where an error is one of this test's record, and other tests can go on.
bool TrackRun::EndsTheTestAlone() const {
  const bool is_stopped = signals_ && signals_->noted() != 0;
  return place_.is_one_of_many && !is_stopped && !has_write_failed_ && !is_refused_;
}

void TrackRun::TrackOneOfMany() {
  try {
    Track();
  } catch (const InvalidArgument& error) {
    if (!EndsTheTestAlone()) throw;
    fault_ = fmt::format("{}: {}", options_.track.fit.files.front(), error.what());
  } catch (const InputError& error) {
    if (!EndsTheTestAlone()) throw;
    fault_ = error.what();
  }
  if (fault_.empty() || !run_.has_begun()) return;
  run_.FitTheRest();  // what was read before the fault
  if (kept_) ThrowOther();
  if (output_) output_->Finish();
}

void TrackRun::Go() {
  Track();
  run_.test().output = options_.output;
  console_.exit_status = test().established() ? kDone : kNotEstablished;
  const std::vector<campaign::Evolution> evolutions = test().courses.Describe(test().is_torsional);
  Draw(evolutions);
  WriteAnswer(options_.json_path, console_, test(), evolutions);
}

void TrackRun::Draw(const std::vector<campaign::Evolution>& evolutions) {
  if (!options_.plot_path.empty()) io::WritePlot(ToPlot(test(), evolutions), options_.plot_path);
  if (!options_.report_path.empty()) {
    io::WriteFileAtomically(
        options_.report_path,
        ToPage(test(), evolutions, ProvenanceOf(command_, console_, options_.track.fit.files)));
  }
}

/// Returns the first line of a table of separate tests: names without units, which are SI, so that
/// queries need no quotes.
std::string SeparateHeader() {
  std::string header = "test,version,sha256,options,fault,";
  bool is_unit = false;
  for (const char character : campaign::CycleTableHeader(false)) {
    if (character == ' ') continue;
    if (character == '[') is_unit = true;
    if (!is_unit && character != '\n') header += character;
    if (character == ']') is_unit = false;
  }
  return header + ",kind\n";
}

/// Returns the text of a cell as io::CsvCell() writes it.
std::string TextOfCell(std::string_view cell) {
  if (!cell.starts_with('"')) return std::string(cell);
  std::string text;
  for (std::size_t at = 1; at + 1 < cell.size(); ++at) {
    text += cell[at];
    if (cell[at] == '"') ++at;  // one of two
  }
  return text;
}

/// Tracks tests one after the other into one table: of each its rows, then a row of its fault where
/// it has one.
class SeparateRuns {
 public:
  SeparateRuns(const TrackCommandOptions& options, const CLI::App& command, Console& console)
      : options_(options), command_(command), console_(console), messages_{console.err, "track"} {}

  void Go();

 private:
  /// Holds the cells before those of a cycle.
  struct Cells {
    std::string test;  // with the comma after it
    std::string sha256;
    std::string rest;   // from the version to the options
    std::string fault;  // why there is no digest of a file that is there
  };

  [[nodiscard]] Cells CellsOf(const std::string& file) const;
  void ReadKept();
  void Track(const std::string& file);
  void AppendFault(const std::string& before, const std::string& fault);
  [[noreturn]] void ThrowOther(const std::string& row) const;

  const TrackCommandOptions& options_;
  const CLI::App& command_;
  Console& console_;
  Messages messages_;
  std::string options_word_ = fmt::format("{:016x}", SeedOf(command_));
  std::string header_ = SeparateHeader();
  std::uintmax_t end_ = header_.size();  // [bytes] of the table with the tests that are done
  bool has_rows_ = false;                // of the next test, behind that
  request::SeparateTests tests_{options_.output, !options_.json_path.empty()};
};

SeparateRuns::Cells SeparateRuns::CellsOf(const std::string& file) const {
  Cells cells{.test = io::CsvCell(file) + ",", .sha256 = "", .rest = "", .fault = ""};
  try {
    cells.sha256 = io::Sha256OfFile(file).value_or("");
  } catch (const InputError& error) {
    cells.fault = error.what();
  }
  cells.rest = fmt::format("{},{},{},", Version(), cells.sha256, options_word_);
  return cells;
}

void SeparateRuns::ThrowOther(const std::string& row) const {
  throw InputError(
      fmt::format("--resume: {} was made from other files, with other options or by another "
                  "version, as its row '{:.60}…' says: give those, another --output, or "
                  "--overwrite",
                  options_.output, row));
}

/// Takes the tests that the table has: all of them but the last, which may have been ended, and
/// none from one on that failed and whose record is another now.
void SeparateRuns::ReadKept() {
  RequireHeader(options_.output, header_);
  std::ifstream file(options_.output, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(end_));
  std::string line;
  bool has_line = std::getline(file, line) && !file.eof();
  for (const std::string& name : options_.track.fit.files) {
    if (!has_line) return;
    const Cells cells = CellsOf(name);
    if (!line.starts_with(cells.test)) ThrowOther(line);
    TrackedTest test(options_.track.average * options_.track.every);
    std::uintmax_t end = end_;
    std::string fault;
    bool is_another = false;
    for (; has_line && line.starts_with(cells.test);
         has_line = std::getline(file, line) && !file.eof()) {
      end += line.size() + 1;
      std::string_view row = std::string_view(line).substr(cells.test.size());
      if (!row.starts_with(cells.rest)) {
        // The same but for the digest?
        const std::string version = std::string(Version()) + ",";
        const std::size_t comma = row.find(',', std::min(version.size(), row.size()));
        if (!row.starts_with(version) || comma == std::string_view::npos ||
            !row.substr(comma + 1).starts_with(options_word_ + ",")) {
          ThrowOther(line);
        }
        is_another = true;
        row.remove_prefix(comma + 1 + options_word_.size() + 1);
      } else {
        row.remove_prefix(cells.rest.size());
      }
      if (!row.starts_with(',')) {  // the cell of the fault, then nothing
        fault = TextOfCell(row.substr(0, row.find_last_not_of(',') + 1));
        continue;
      }
      const std::size_t last = row.rfind(',');
      test.is_torsional = row.substr(last + 1) == "torque";
      try {
        const campaign::CycleTableEntry entry =
            campaign::ReadCycleTableRow(row.substr(1, last - 1));
        test.Add(entry.fit);
        test.energy.Add(entry.fit);
      } catch (const InputError&) {  // a row that is none of such a table
        ThrowOther(line);
      }
    }
    if (is_another && fault.empty()) ThrowOther(cells.test);
    // A file that could not be read then and can be now is tracked again.
    is_another = is_another || (fault.starts_with("cannot read") && !cells.sha256.empty());
    if (is_another) return;
    has_rows_ = fault.empty() && !has_line;
    if (has_rows_) return;
    tests_.Add(name, fault, test, /*was_there=*/true);
    end_ = end;
  }
  if (has_line) ThrowOther(line);
}

void SeparateRuns::AppendFault(const std::string& before, const std::string& fault) {
  const std::string header = campaign::CycleTableHeader(false);
  const auto commas = static_cast<std::size_t>(std::ranges::count(header, ','));
  const std::string row =
      fmt::format("{}{}{}\n", before, io::CsvCell(fault), std::string(commas + 2, ','));
  io::AppendedFile table(options_.output, end_);
  table.Append(row);
  table.Finish();
  end_ += row.size();
}

void SeparateRuns::Track(const std::string& file) {
  const Cells cells = CellsOf(file);
  TrackCommandOptions options = options_;
  options.track.fit.files = {file};
  TrackRun run(options, command_, console_,
               {.is_one_of_many = true,
                .before = cells.test + cells.rest + ",",
                .offset = end_,
                .has_rows = std::exchange(has_rows_, false)});
  if (cells.fault.empty()) run.TrackOneOfMany();
  end_ = run.end();
  const std::string& fault = cells.fault.empty() ? run.fault() : cells.fault;
  if (!fault.empty()) {
    AppendFault(cells.test + cells.rest, fault);
    messages_.Warn(fault);
  }
  tests_.Add(file, fault, run.test(), /*was_there=*/false);
}

void SeparateRuns::Go() {
  RequireTrackOptions(options_);
  for (const auto& [option, path] :
       {std::pair{"--plot", options_.plot_path}, std::pair{"--report", options_.report_path}}) {
    if (path.empty()) continue;
    throw InputError(
        fmt::format("{} shows one test, and --separate makes many: track that one "
                    "alone",
                    option));
  }
  for (const std::string& file : options_.track.fit.files) {
    if (file != "-" && file.find_first_of("\r\n") == std::string::npos) continue;
    throw InputError(
        fmt::format("--separate: '{}': a test is called by the name of its file, of "
                    "one line, and is read twice: give such files",
                    file));
  }
  std::error_code error;
  if (options_.resume && std::filesystem::file_size(options_.output, error) > 0 && !error) {
    ReadKept();
  } else {
    io::AppendedFile table(options_.output, 0);
    table.Append(header_);
    table.Finish();
  }
  const std::vector<std::string>& files = options_.track.fit.files;
  while (tests_.size() < files.size()) {
    const std::string& file = files[tests_.size()];
    try {
      Track(file);
    } catch (const InputError& fatal) {
      throw InputError(fmt::format("{}: {}; {} tests are done in {}: add --resume", file,
                                   fatal.what(), tests_.size(), options_.output));
    }
  }
  console_.exit_status = tests_.established() ? kDone : kNotEstablished;
  if (!options_.json_path.empty()) WriteText(tests_.ToJson(), options_.json_path, console_);
  if (options_.json_path != "-") console_.out << tests_.ToText();
}

void RunTrack(const TrackCommandOptions& options, const CLI::App& command, Console& console) {
  RequireDistinctFiles(options.track.fit.files);
  RequireOutputPaths({{"--output", options.output},
                      {"--json", options.json_path, /*dash_is_stdout=*/true},
                      {"--plot", options.plot_path},
                      {"--report", options.report_path}},
                     console, options.track.fit.files);
  if (!options.plot_path.empty()) io::RequirePlotName(options.plot_path);
  // Pieces of one test, whose cycles and energy count on from file to file, have no shards.
  const bool is_separate = options.separate || !options.list.shard.empty();
  if (is_separate && options.track.fit.join) {
    throw InputError("--separate, or --shard, and --join contradict each other: leave one out");
  }
  if (is_separate) return SeparateRuns(options, command, console).Go();
  RequireTrackOptions(options);
  TrackRun(options, command, console).Go();
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
      .Add("files", options->track.fit.files,
           "CSV records of one test, in order; no cycle extends over two files.\nWith "
           "--separate each file is a test of its own",
           "FILE");
  AddFilesFrom(command, options->list);
  OptionGroup(command, "Files")
      .AddFlag("--separate", options->separate,
               "each file is a test of its own: one table of all, with columns for\ntest, version, "
               "SHA-256 of the file and fault; a test that fails does\nnot stop the others; "
               "implied by --shard");
  AddShard(command, options->list);
  AddJoin(command, options->track.fit);
  AddColumnOptions(command, options->track.fit.columns);
  AddModelOptions(command, options->track.fit);
  AddContactOptions(command, options->track.fit.contact);
  const OptionGroup cycles(command, "Cycles");
  cycles
      .AddShown("--average", options->track.average,
                "number of consecutive cycles that are fitted together")
      .WholeNumber(1, 1'000'000);
  cycles.AddShown("--every", options->track.every, "fit only one cycle of this many")
      .WholeNumber(1, 1'000'000'000);
  cycles
      .AddShown("--broken-rows", options->broken_rows,
                "refuse: a row without a number in a needed column ends the run; skip:\nit is "
                "skipped and counted")
      .OneOf({"refuse", "skip"});
  cycles
      .Add("--threads", options->track.threads,
           "number of worker threads (default: one per core); they do not change\nthe table")
      .WholeNumber(1, 1024);
  const OptionGroup group(command, "Results");
  group.Add("--output", options->output, "table of cycles as CSV, one row a cycle", "PATH")
      .Required();
  group.Add("--json", options->json_path, "summary as JSON; - for standard output alone", "PATH");
  group.Add("--plot", options->plot_path,
            "evolution over the cycles with its changes, as svg or png", "PATH");
  group.Add("--report", options->report_path,
            "everything with its figures on one self-contained page of HTML", "PATH");
  group.AddFlag("--resume", options->resume,
                "continue an existing table, with the same files and options");
  group.AddFlag("--overwrite", options->overwrite, "replace an existing table");
  WhenCalled(command, [options, &command, &console] {
    options->track.fit.files = FilesOf(options->track.fit.files, options->list);
    options->track.fit.columns.skip_broken_rows = options->broken_rows == "skip";
    RunTrack(*options, command, console);
  });
}

}  // namespace mindahl::cli
