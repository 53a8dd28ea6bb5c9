#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
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
#include "cli/fit_request.h"
#include "cli/options.h"
#include "cli/output.h"
#include "cli/provenance.h"
#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/test_summary.h"
#include "mindahl/campaign/tracker.h"
#include "mindahl/core/error.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/request/fit_request.h"
#include "mindahl/request/track.h"

namespace mindahl::cli {
namespace {

using campaign::CycleFit;

struct TrackCommandOptions {
  request::TrackRequest track{.threads = std::max(1U, std::thread::hardware_concurrency())};
  std::string broken_rows = "refuse";
  std::string output;
  std::string json_path;
  std::string plot_path;
  std::string report_path;
  bool resume = false;
  bool overwrite = false;
};

void RequireTrackOptions(const TrackCommandOptions& options) {
  request::Validate(options.track);
  if (options.resume && options.overwrite) {
    throw InputError("--resume and --overwrite contradict each other: give one of the two");
  }
  std::error_code error;
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
  constexpr std::array<std::string_view, 8> kOfNoRow = {"help",   "output", "json",      "plot",
                                                        "report", "resume", "overwrite", "threads"};
  std::uint64_t seed = 0xcbf29ce484222325U;
  const auto add = [&seed](std::string_view text) {
    for (const char character : text) {
      seed = (seed ^ static_cast<unsigned char>(character)) * 0x100000001b3U;
    }
  };
  for (const CLI::Option* option : OptionsOf(command)) {  // not the files, whose content counts
    if (std::ranges::find(kOfNoRow, NameOf(*option)) != kOfNoRow.end()) continue;
    add(NameOf(*option));
    for (const std::string& value : option->results()) add("=" + value);
    if (option->count() == 0) add("=" + option->get_default_str());
  }
  return seed;
}

/// Holds what a resumed run keeps of the table on disk: its whole batches.
struct KeptCycles {
  std::size_t fits = 0;
  std::uintmax_t bytes = 0;  // size of the header and these
  std::string last_batch;    // its rows, to compare with
};

/// @param visit  is given every row that is kept
/// @throws InputError where the file is no such table
KeptCycles ReadKeptCycles(const std::string& path, bool is_torsional,
                          const std::function<void(const campaign::CycleFit&)>& visit) {
  constexpr std::string_view kRemedy = "give another --output, or --overwrite";
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(fmt::format("cannot read '{}': {}", path, std::strerror(errno)));
  std::string line;
  std::getline(file, line);
  const std::string header = campaign::CycleTableHeader(is_torsional);
  if (line + '\n' != header) {
    throw InputError(fmt::format(
        "--resume: {} is no table of such cycles, its first line is another: {}", path, kRemedy));
  }
  KeptCycles kept;
  kept.bytes = header.size();
  std::vector<std::string> batch;
  // A line without a line feed was being written when a run was killed, and is no row.
  while (std::getline(file, line) && !file.eof()) {
    batch.push_back(line);
    if (batch.size() < campaign::kBatch) continue;
    kept.last_batch.clear();
    for (const std::string& row : batch) {
      ++kept.fits;
      try {
        visit(campaign::ReadCycleTableRow(row, is_torsional).fit);
      } catch (const InputError& error) {
        throw InputError(
            fmt::format("--resume: {}:{}: {}: {}", path, kept.fits + 1, error.what(), kRemedy));
      }
      kept.last_batch += row + '\n';
    }
    kept.bytes += kept.last_batch.size();
    batch.clear();
  }
  return kept;
}

class TrackRun {
 public:
  TrackRun(const TrackCommandOptions& options, const CLI::App& command, Console& console)
      : options_(options),
        command_(command),
        console_(console),
        messages_{console.err, "track"},
        run_(options.track, {.fits = [this](std::span<const CycleFit> fits) { Take(fits); },
                             .note = [this](std::string_view text) { messages_.Note(text); },
                             .warn = [this](std::string_view text) { messages_.Warn(text); },
                             .begins = [this](campaign::TrackOptions& made) { Begin(made); },
                             .piece_is_read = [this] { RequireNoSignal(); }}) {}

  void Go();

 private:
  void Track();
  void Begin(campaign::TrackOptions& made);
  void RequireNoSignal() const;
  void Take(std::span<const CycleFit> fits);
  [[noreturn]] void ThrowOther() const;

  const TrackCommandOptions& options_;
  const CLI::App& command_;
  Console& console_;
  Messages messages_;
  request::TrackRun run_;
  std::optional<KeptCycles> kept_;  // until its last batch was made again
  std::optional<io::AppendedFile> output_;
  bool has_write_failed_ = false;               // or is at work
  std::optional<io::DeferredSignals> signals_;  // while rows are written
};

void TrackRun::Begin(campaign::TrackOptions& made) {
  request::TrackedTest& test = run_.test();
  if (!run_.chosen_terms().empty()) messages_.Note(run_.chosen_terms());
  const double gate = *made.fit.preparation.reversal_gate;
  if (!run_.reading().gate_is_given && gate > 0) {
    messages_.Note(
        fmt::format("excursions up to {:.4g} m are noise, by the first {} samples: --reversal-gate "
                    "says another",
                    gate, run_.reading().samples));
  }
  std::error_code error;
  if (options_.resume && std::filesystem::file_size(options_.output, error) > 0 && !error) {
    campaign::DissipatedEnergy energy = test.energy;
    kept_ = ReadKeptCycles(options_.output, test.is_torsional, [&](const CycleFit& fit) {
      if (test.fits % campaign::kBatch == 0) test.energy = energy;  // before the last batch
      energy.Add(fit);
      test.Add(fit);
    });
    test.resumed = kept_->fits;
    if (kept_->fits == 0) kept_.reset();
  }
  made.skipped = kept_ ? kept_->fits - campaign::kBatch : 0;
  made.seed = SeedOf(command_);
}

/// The rows of a batch: appended; or, of the last that is kept, compared with what is there.
void TrackRun::Take(std::span<const CycleFit> fits) {
  request::TrackedTest& test = run_.test();
  std::string rows;
  for (const CycleFit& fit : fits) {
    test.energy.Add(fit);
    rows += campaign::CycleTableRow(fit, test.energy.total(), test.is_torsional);
  }
  if (kept_ && rows != kept_->last_batch) ThrowOther();
  has_write_failed_ = true;
  if (kept_) {
    output_.emplace(options_.output, kept_->bytes);
    kept_.reset();
  } else {
    if (!output_) {
      output_.emplace(options_.output, 0);
      output_->Append(campaign::CycleTableHeader(test.is_torsional));
    }
    output_->Append(rows);
    for (const CycleFit& fit : fits) test.Add(fit);
  }
  has_write_failed_ = false;
}

void TrackRun::ThrowOther() const {
  throw InputError(fmt::format(
      "--resume: {} was made from another record or with other options, its rows {} to {} "
      "come out differently or what was read before them: give those, another "
      "--output, or --overwrite",
      options_.output, kept_->fits - campaign::kBatch + 1, kept_->fits));
}

void TrackRun::RequireNoSignal() const {
  if (signals_->noted() != 0) throw InputError("stopped by a signal");
}

void TrackRun::Track() {
  signals_.emplace();
  try {
    run_.Read();
    if (kept_) ThrowOther();  // a record that ends before them
    has_write_failed_ = true;
    if (output_) output_->Finish();
    has_write_failed_ = false;
    RequireNoSignal();
  } catch (const InputError& error) {
    // Finished rows are kept, unless they are another run's, or there are none.
    const bool is_stopped = signals_->noted() != 0;
    if (!run_.has_begun() && is_stopped) {
      throw InputError("stopped by a signal before the first row");
    }
    if (!run_.has_begun() || (kept_ && !is_stopped)) throw;
    try {
      if (!has_write_failed_) run_.FitTheRest();
      if (output_) output_->Finish();
    } catch (const InputError&) {  // NOLINT(bugprone-empty-catch): the disk, as the first one says
    }
    throw InputError(fmt::format("{}; {} rows are kept in {}: {}add --resume",
                                 is_stopped ? "stopped by a signal" : error.what(),
                                 run_.test().fits, options_.output,
                                 is_stopped ? "" : "repair the fault and "));
  }
  signals_.reset();
  run_.Finish();
}

void TrackRun::Go() {
  Track();
  request::TrackedTest& test = run_.test();
  test.output = options_.output;
  console_.exit_status = test.established() ? kDone : kNotEstablished;
  const std::vector<campaign::Evolution> evolutions = test.courses.Describe(test.is_torsional);
  if (!options_.plot_path.empty()) io::WritePlot(ToPlot(test, evolutions), options_.plot_path);
  if (!options_.report_path.empty()) {
    io::WriteFileAtomically(
        options_.report_path,
        ToPage(test, evolutions, ProvenanceOf(command_, console_, options_.track.fit.files)));
  }
  WriteAnswer(options_.json_path, console_, test, evolutions);
}

void RunTrack(const TrackCommandOptions& options, const CLI::App& command, Console& console) {
  RequireDistinctFiles(options.track.fit.files);
  RequireOutputPaths({{"--output", options.output},
                      {"--json", options.json_path, /*dash_is_stdout=*/true},
                      {"--plot", options.plot_path},
                      {"--report", options.report_path}},
                     console, options.track.fit.files);
  if (!options.plot_path.empty()) io::RequirePlotName(options.plot_path);
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
           "CSV records of one test, in order; no cycle extends over two files", "FILE")
      ->required();
  AddJoin(command, options->track.fit);
  AddColumnOptions(command, options->track.fit.columns);
  AddModelOptions(command, options->track.fit);
  AddContactOptions(command, options->track.fit.contact);
  const OptionGroup cycles(command, "Cycles");
  cycles
      .AddShown("--average", options->track.average,
                "number of consecutive cycles that are fitted together")
      ->check(WholeNumber(1, 1'000'000));
  cycles.AddShown("--every", options->track.every, "fit only one cycle of this many")
      ->check(WholeNumber(1, 1'000'000'000));
  cycles
      .AddShown("--broken-rows", options->broken_rows,
                "refuse: a row without a number in a needed column ends the run; skip:\nit is "
                "skipped and counted")
      ->check(OneOf({"refuse", "skip"}));
  cycles
      .Add("--threads", options->track.threads,
           "number of worker threads (default: one per core); they do not change\nthe table")
      ->check(WholeNumber(1, 1024));
  const OptionGroup group(command, "Results");
  group.Add("--output", options->output, "table of cycles as CSV, one row a cycle", "PATH")
      ->required();
  group.Add("--json", options->json_path, "summary as JSON; - for standard output alone", "PATH");
  group.Add("--plot", options->plot_path,
            "evolution over the cycles with its changes, as svg or png", "PATH");
  group.Add("--report", options->report_path,
            "everything with its figures on one self-contained page of HTML", "PATH");
  group.AddFlag("--resume", options->resume,
                "continue an existing table, with the same files and options");
  group.AddFlag("--overwrite", options->overwrite, "replace an existing table");
  command.callback([options, &command, &console] {
    options->track.fit.columns.skip_broken_rows = options->broken_rows == "skip";
    RunTrack(*options, command, console);
  });
}

}  // namespace mindahl::cli
