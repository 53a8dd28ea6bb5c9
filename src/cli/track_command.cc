#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "cli/commands.h"
#include "cli/examples.h"
#include "cli/file_list.h"
#include "cli/fit_records.h"
#include "cli/fit_request.h"
#include "cli/json_output.h"
#include "cli/kept_cycles.h"
#include "cli/one_of.h"
#include "cli/output_path.h"
#include "cli/progress.h"
#include "cli/provenance.h"
#include "cli/whole_number.h"
#include "mindahl/campaign/changes.h"
#include "mindahl/campaign/cycle_table.h"
#include "mindahl/campaign/dissipated_energy.h"
#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/pages.h"
#include "mindahl/campaign/pooled_value.h"
#include "mindahl/campaign/reading.h"
#include "mindahl/campaign/shared_alpha.h"
#include "mindahl/campaign/tracked_quantities.h"
#include "mindahl/campaign/tracker.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_stream.h"
#include "mindahl/report/quantity.h"
#include "mindahl/report/units.h"
#include "mindahl/request/fit_records.h"
#include "report/statements.h"

namespace mindahl::cli {
namespace {

using campaign::CycleFit;
using identification::FitOptions;

constexpr std::string_view kOwnAlpha = "cycle";
constexpr std::string_view kSharedAlpha = "shared";

struct TrackCommandOptions {
  FitRequest request;
  FileList list;
  std::optional<double> normal_load;
  std::size_t average = 1;
  std::size_t every = 1;
  std::size_t threads = std::max(1U, std::thread::hardware_concurrency());
  std::string broken_rows = "refuse";
  std::string alpha = std::string(kOwnAlpha);
  std::string output;
  std::string json_path;
  std::string plot_path;
  std::string report_path;
  bool resume = false;
  bool overwrite = false;
};

/// Holds the sums over all cycles of a run.
struct Totals {
  std::size_t fits = 0;
  std::size_t flagged = 0;
  std::map<std::string, std::size_t> flags;
  campaign::TrackedCourses courses;

  void Add(const CycleFit& fit) {
    ++fits;
    flagged += fit.flags.empty() ? 0 : 1;
    for (const std::string& flag : fit.flags) ++flags[flag];
    courses.Add(fit);
  }
};

/// Counts the rows and cycles that were read.
struct WhatWasRead {
  std::size_t samples = 0;
  std::size_t cycles = 0;
  std::size_t unused_samples = 0;
  std::size_t broken_rows = 0;
  campaign::Reading of_head;
};

void RequireTrackOptions(const TrackCommandOptions& options) {
  request::MakeCycleFitOptions(options.request);
  if (options.normal_load) RequirePositive("--normal-load [N]", *options.normal_load);
  if (options.alpha == kSharedAlpha) {
    campaign::RequireThatAlphaCanBeShared(request::MakeCycleFitOptions(options.request),
                                          options.request.files);
  }
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
  constexpr std::array<std::string_view, 9> kOfNoRow = {
      "help", "output", "json", "plot", "report", "resume", "overwrite", "threads", "files-from"};
  std::uint64_t seed = 0xcbf29ce484222325U;
  const auto add = [&seed](std::string_view text) {
    for (const char character : text) {
      seed = (seed ^ static_cast<unsigned char>(character)) * 0x100000001b3U;
    }
  };
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_lnames().empty()) continue;  // the files, whose content counts
    const std::string& name = option->get_lnames().front();
    if (std::ranges::find(kOfNoRow, name) != kOfNoRow.end()) continue;
    add(name);
    for (const std::string& value : option->results()) add("=" + value);
    if (option->count() == 0) add("=" + option->get_default_str());
  }
  return seed;
}

io::BrokenRows BrokenRowsOf(const TrackCommandOptions& options) {
  return options.broken_rows == "skip" ? io::BrokenRows::kSkip : io::BrokenRows::kRefuse;
}

/// Refuses the unit of a column that the record does not have.
void RequireUnitOf(std::string_view option, const io::ColumnChoice& choice,
                   const std::optional<io::ChosenColumn>& column) {
  if (choice.unit.empty() || column) return;
  throw InputError(fmt::format(
      "{} {}: the record has no such column, so this has no effect: name it with {}", option,
      choice.unit, option == "--time-unit" ? "--time" : "--normal-load-column"));
}

class TrackRun {
 public:
  TrackRun(const TrackCommandOptions& options, const CLI::App& command, Console& console)
      : options_(options),
        command_(command),
        console_(console),
        messages_{console.err, "track"},
        energy_(options.average * options.every) {}

  void Go();

 private:
  void PoolAlpha();
  [[nodiscard]] FitOptions OptionsFor(const io::Samples& head, campaign::Reading& reading);
  void Begin(io::RecordStream& stream, const io::Samples& head);
  void ReadFile(const std::string& file, io::Samples piece, io::RecordStream& stream);
  void SayReading() const;
  void RequireNoSignal() const;
  void Take(std::span<const CycleFit> fits);
  [[noreturn]] void ThrowOther() const;
  void SayProgress();
  void WriteSummary();
  /// Time histories that a figure of the test shows: of friction coefficient and slip force, which
  /// say the same, the first where it is known.
  [[nodiscard]] std::vector<campaign::Evolution> Evolutions() const;
  [[nodiscard]] campaign::TestSummary Summary() const;
  void Draw();
  [[nodiscard]] nlohmann::ordered_json Json() const;
  [[nodiscard]] std::string_view UnitOf(std::string_view unit) const {
    return report::UnitIn(is_torsional_ ? report::kUnitsOfTorque : report::kUnitsOfForce, unit);
  }

  const TrackCommandOptions& options_;
  const CLI::App& command_;
  Console& console_;
  Messages messages_;
  FitOptions fit_;
  bool is_torsional_ = false;
  std::string chosen_terms_;
  WhatWasRead reading_;
  Totals totals_;
  campaign::DissipatedEnergy energy_;
  std::optional<campaign::PooledValue> shared_alpha_;
  std::optional<KeptCycles> kept_;  // until its last batch was made again
  std::size_t resumed_ = 0;         // fits that were there
  std::optional<io::AppendedFile> output_;
  bool has_write_failed_ = false;               // or is at work
  std::optional<io::DeferredSignals> signals_;  // while rows are written
  std::optional<campaign::Tracker> tracker_;
  std::optional<Progress> progress_;
  std::uintmax_t bytes_ = 0;         // of all files
  std::uintmax_t bytes_before_ = 0;  // of the files that are done
  std::uintmax_t bytes_read_ = 0;
  std::span<const campaign::TrackedQuantity> tracked_ = campaign::TrackedQuantities();
  std::vector<campaign::CourseDescription> courses_;  // of each, once all is read
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

FitOptions TrackRun::OptionsFor(const io::Samples& head, campaign::Reading& reading) {
  FitOptions fit = request::MakeCycleFitOptions(options_.request);
  if (options_.normal_load) fit.normal_loads = {*options_.normal_load};
  reading = campaign::ChooseReading(campaign::ViewOf(head), fit);
  chosen_terms_ = request::ChooseTermsOfCycles(options_.request, campaign::ViewOf(head), fit);
  return fit;
}

/// Fits every cycle with an alpha of its own, for what they have in common.
void TrackRun::PoolAlpha() {
  campaign::PooledValue alpha;
  std::optional<campaign::Tracker> tracker;
  Progress progress(console_.err, "fitting alpha, the first of two passes");
  for (const std::string& file : options_.request.files) {
    io::RecordStream stream(file, options_.request.columns, BrokenRowsOf(options_));
    io::Samples piece;
    if (!tracker) {
      piece = campaign::ReadHead(stream);
      campaign::Reading reading;
      tracker.emplace(campaign::TrackOptions{.fit = OptionsFor(piece, reading),
                                             .together = options_.average,
                                             .every = options_.every,
                                             .threads = options_.threads},
                      [&](std::span<const CycleFit> fits) {
                        for (const CycleFit& fit : fits) campaign::PoolAlpha(fit, alpha);
                      });
    } else {
      stream.Next(piece);
    }
    while (piece.size() > 0) {
      tracker->Add(campaign::ViewOf(piece), piece.lines);
      if (!stream.Next(piece)) break;
    }
    tracker->NextFile();
  }
  tracker->Finish();
  if (tracker->cycles() == 0) return;  // as the second pass will say
  campaign::RequireSharedAlpha(alpha);
  shared_alpha_ = alpha;
}

void TrackRun::Begin(io::RecordStream& stream, const io::Samples& head) {
  is_torsional_ = stream.layout().is_torsional;
  RequireUnitOf("--time-unit", options_.request.columns.time, stream.layout().time);
  RequireUnitOf("--normal-load-unit", options_.request.columns.normal_load,
                stream.layout().normal_load);
  fit_ = OptionsFor(head, reading_.of_head);
  if (shared_alpha_) fit_.fixed["alpha"] = shared_alpha_->mean();
  SayReading();
  const std::string header = campaign::CycleTableHeader(is_torsional_);
  std::error_code error;
  if (options_.resume && std::filesystem::file_size(options_.output, error) > 0 && !error) {
    campaign::DissipatedEnergy energy = energy_;
    kept_ = ReadKeptCycles(options_.output, header, [&](const campaign::CycleTableEntry& entry) {
      if (totals_.fits % campaign::kBatch == 0) energy_ = energy;  // before the last batch
      energy.Add(entry.fit);
      totals_.Add(entry.fit);
    });
    resumed_ = kept_->fits;
    if (kept_->fits == 0) kept_.reset();
  }
  tracker_.emplace(campaign::TrackOptions{.fit = fit_,
                                          .together = options_.average,
                                          .every = options_.every,
                                          .threads = options_.threads,
                                          .skipped = kept_ ? kept_->fits - campaign::kBatch : 0,
                                          .seed = SeedOf(command_)},
                   [this](std::span<const CycleFit> fits) { Take(fits); });
  progress_.emplace(console_.err, "tracking cycles");
}

void TrackRun::SayReading() const {
  if (!chosen_terms_.empty()) messages_.Note(chosen_terms_);
  const campaign::Reading& reading = reading_.of_head;
  const double gate = *fit_.preparation.reversal_gate;
  if (!reading.gate_is_given && gate > 0) {
    messages_.Note(
        fmt::format("excursions up to {:.4g} m are noise, by the first {} samples: --reversal-gate "
                    "says another",
                    gate, reading.samples));
  }
  const auto doubt = campaign::DoubtAbout(reading, options_.request.files.front());
  if (doubt) messages_.Warn(*doubt);
}

/// The rows of a batch: appended; or, of the last that is kept, compared with what is there.
void TrackRun::Take(std::span<const CycleFit> fits) {
  std::string rows;
  for (const CycleFit& fit : fits) {
    energy_.Add(fit);
    rows += campaign::CycleTableRow(fit, energy_.total());
  }
  if (kept_) {
    if (rows != kept_->last_batch) ThrowOther();
    output_.emplace(options_.output, kept_->bytes);
    kept_.reset();
    return;
  }
  has_write_failed_ = true;
  if (!output_) {
    output_.emplace(options_.output, 0);
    output_->Append(campaign::CycleTableHeader(is_torsional_));
  }
  output_->Append(rows);
  has_write_failed_ = false;
  for (const CycleFit& fit : fits) totals_.Add(fit);
  SayProgress();
}

void TrackRun::ThrowOther() const {
  throw InputError(fmt::format(
      "--resume: {} was made from another record or with other options, its rows {} to {} "
      "come out differently or what was read before them: give those, another "
      "--output, or --overwrite",
      options_.output, kept_->fits - campaign::kBatch + 1, kept_->fits));
}

void TrackRun::SayProgress() {
  const double seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  const double share =
      static_cast<double>(bytes_read_) / static_cast<double>(std::max<std::uintmax_t>(bytes_, 1));
  const auto made = static_cast<double>(totals_.fits - resumed_);
  progress_->Say(fmt::format("{} cycles, {:.0f} % of {:.3g} MB, {:.3g} a second, {:.0f} s left",
                             tracker_->cycles(), 100 * share, static_cast<double>(bytes_) / 1e6,
                             made / seconds, seconds * (1 - share) / std::max(share, 1e-3)));
}

/// @throws InputError where a signal asks the run to end
void TrackRun::RequireNoSignal() const {
  if (signals_->noted() != 0) throw InputError("stopped by a signal");
}

void TrackRun::ReadFile(const std::string& file, io::Samples piece, io::RecordStream& stream) {
  while (piece.size() > 0) {
    bytes_read_ = bytes_before_ + stream.bytes();
    reading_.samples += piece.size();
    tracker_->Add(campaign::ViewOf(piece), piece.lines);
    RequireNoSignal();
    if (!stream.Next(piece)) break;
  }
  reading_.unused_samples += tracker_->NextFile();
  reading_.broken_rows += stream.broken_rows();
  bytes_before_ += stream.bytes();
  if (stream.broken_rows() > 0) {
    messages_.Warn(fmt::format("{} broken rows of {} were skipped, the first: {}",
                               stream.broken_rows(), file, stream.first_broken_row()));
  }
}

void TrackRun::Go() {
  RequireTrackOptions(options_);
  const std::vector<std::string>& files = options_.request.files;
  for (const std::string& file : files) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error) bytes_ += size;
  }
  const io::BrokenRows broken = BrokenRowsOf(options_);
  if (options_.alpha == kSharedAlpha) PoolAlpha();
  signals_.emplace();
  try {
    for (const std::string& file : files) {
      io::RecordStream stream(file, options_.request.columns, broken);
      for (const std::string& note : stream.layout().notes) messages_.Note(note);
      if (tracker_ && stream.layout().is_torsional != is_torsional_) {
        throw InputError(fmt::format("{} holds a {} and {} a {}: track them apart", files.front(),
                                     is_torsional_ ? "torque" : "force", file,
                                     is_torsional_ ? "force" : "torque"));
      }
      io::Samples first;
      if (!tracker_) {
        first = campaign::ReadHead(stream);
        Begin(stream, first);
      } else {
        stream.Next(first);
      }
      ReadFile(file, std::move(first), stream);
    }
    tracker_->Finish();
    if (kept_) ThrowOther();  // a record that ends before them
    if (output_) output_->Finish();
    RequireNoSignal();
  } catch (const InputError& error) {
    // Finished rows are kept, unless they are another run's, or there are none.
    const bool is_stopped = signals_->noted() != 0;
    if (!tracker_ && is_stopped) throw InputError("stopped by a signal before the first row");
    if (!tracker_ || (kept_ && !is_stopped)) throw;
    try {
      if (!has_write_failed_) tracker_->Finish();
      if (output_) output_->Finish();
    } catch (const InputError&) {  // NOLINT(bugprone-empty-catch): the disk, as the first one says
    }
    throw InputError(fmt::format("{}; {} rows are kept in {}: {}add --resume",
                                 is_stopped ? "stopped by a signal" : error.what(), totals_.fits,
                                 options_.output, is_stopped ? "" : "repair the fault and "));
  }
  signals_.reset();
  progress_.reset();
  reading_.cycles = tracker_->cycles();
  campaign::RequireCycles(reading_.cycles, options_.average, reading_.of_head,
                          *fit_.preparation.reversal_gate,
                          fmt::format("{}", fmt::join(files, ", ")));
  const auto failed = totals_.flags.find("not_converged");
  const bool none = failed != totals_.flags.end() && failed->second == totals_.fits;
  console_.exit_status = none ? kNotEstablished : kDone;
  courses_ = totals_.courses.Describe();
  Draw();
  if (!options_.json_path.empty()) WriteJson(Json(), options_.json_path, console_);
  if (options_.json_path != "-") WriteSummary();
}

std::vector<campaign::Evolution> TrackRun::Evolutions() const {
  std::vector<campaign::Evolution> evolutions;
  const auto is_known = [this](std::string_view name) {
    const auto found = std::ranges::find(tracked_, name, &campaign::TrackedQuantity::name);
    const auto k = static_cast<std::size_t>(found - tracked_.begin());
    return !courses_[k].stretches.empty();
  };
  for (std::size_t k = 0; k < tracked_.size(); ++k) {
    const campaign::TrackedQuantity& quantity = tracked_[k];
    if (!quantity.is_drawn || courses_[k].stretches.empty()) continue;
    if (quantity.name == "slip_force" && is_known("friction_coefficient")) continue;
    evolutions.push_back(
        {.name = std::string(quantity.name),
         .unit = std::string(UnitOf(quantity.unit)),
         .has_errors = quantity.has_standard_error && totals_.courses.have_errors()[k],
         .course = totals_.courses.courses()[k],
         .description = courses_[k]});
  }
  return evolutions;
}

campaign::TestSummary TrackRun::Summary() const {
  campaign::TestSummary test{.files = options_.request.files,
                             .cycles = reading_.cycles,
                             .samples = reading_.samples,
                             .fits = totals_.fits,
                             .unused_samples = reading_.unused_samples,
                             .dissipated = energy_.total(),
                             .energy_counts = energy_.counts(),
                             .shared_alpha = shared_alpha_,
                             .evolutions = Evolutions()};
  for (const campaign::CycleFlag& flag : campaign::CycleFlags()) {
    const auto found = totals_.flags.find(std::string(flag.name));
    if (found == totals_.flags.end()) continue;
    test.flags.push_back(
        {.name = found->first, .meaning = std::string(flag.meaning), .cycles = found->second});
  }
  for (std::size_t k = 0; k < tracked_.size(); ++k) {
    const std::string name = report::WithUnit(tracked_[k].name, UnitOf(tracked_[k].unit));
    for (const std::string& line : campaign::ChangeStatements(courses_[k])) {
      test.changes.push_back(fmt::format("{}: {}", name, line));
    }
  }
  return test;
}

void TrackRun::Draw() {
  if (options_.plot_path.empty() && options_.report_path.empty()) return;
  const campaign::TestSummary test = Summary();
  if (!options_.plot_path.empty()) {
    const std::string_view changes =
        test.changes.empty() ? campaign::kNothingChanged : "dashed where it changed beyond chance";
    io::WritePlot(campaign::EvolutionPlot(test.evolutions, report::NameOf(test.files),
                                          fmt::format("{} cycles: {}", test.cycles, changes)),
                  options_.plot_path);
  }
  if (!options_.report_path.empty()) {
    io::WriteFileAtomically(
        options_.report_path,
        campaign::ToPage(test, ProvenanceOf(command_, console_, options_.request.files)));
  }
}

void TrackRun::WriteSummary() {
  std::string text = fmt::format("{} cycles of {} samples, {} fits in {}\n", reading_.cycles,
                                 reading_.samples, totals_.fits, options_.output);
  if (resumed_ > 0) text += fmt::format("{} of them were there already\n", resumed_);
  if (reading_.unused_samples > 0) {
    text +=
        fmt::format("{} samples at the ends are part of no whole cycle\n", reading_.unused_samples);
  }
  text += fmt::format("{:.6g} J dissipated in all{}\n", energy_.total(),
                      campaign::InWords(energy_.counts()));
  if (shared_alpha_) text += campaign::SharedAlphaInWords(*shared_alpha_) + "\n";
  if (totals_.flagged > 0) {
    text += fmt::format("\n{} {} a flag:\n", totals_.flagged,
                        totals_.flagged == 1 ? "cycle has" : "cycles have");
    for (const campaign::CycleFlag& flag : campaign::CycleFlags()) {
      const auto found = totals_.flags.find(std::string(flag.name));
      if (found == totals_.flags.end()) continue;
      text += fmt::format("  {:<18}{:>8}   {}\n", flag.name, found->second, flag.meaning);
    }
  }
  std::string courses;
  std::string changes;
  std::string small_trends;
  for (std::size_t k = 0; k < tracked_.size(); ++k) {
    const campaign::CourseDescription& course = courses_[k];
    if (course.stretches.empty()) continue;
    const std::string name = report::WithUnit(tracked_[k].name, UnitOf(tracked_[k].unit));
    courses += fmt::format("  {:<30}{:>14.5g}{:>14.5g}\n", name, course.stretches.front().at_start,
                           course.stretches.back().at_end);
    for (const std::string& line : campaign::ChangeStatements(course)) {
      changes += fmt::format("  {:<21} {}\n", tracked_[k].name, line);
    }
    for (const std::string& line : campaign::SmallTrendStatements(course)) {
      small_trends += fmt::format("  {:<21} {}\n", tracked_[k].name, line);
    }
  }
  if (!courses.empty()) {
    text +=
        fmt::format("\n  {:<30}{:>14}{:>14}\n{}", "over the test", "at first", "at last", courses);
    text += changes.empty() ? fmt::format("\nN{}.\n", campaign::kNothingChanged.substr(1))
                            : "\nChanges:\n" + changes;
    if (!small_trends.empty()) text += "\nBeyond chance, but less than 1 %:\n" + small_trends;
  }
  console_.out << text;
}

nlohmann::ordered_json TrackRun::Json() const {
  nlohmann::ordered_json json;
  json["schema"] = "mindahl.track/1";
  json["version"] = Version();
  json["input"] = {{"files", options_.request.files},
                   {"samples", reading_.samples},
                   {"cycles", reading_.cycles},
                   {"unused_samples", reading_.unused_samples},
                   {"broken_rows", reading_.broken_rows}};
  json["reversals"] = {{"gate", *fit_.preparation.reversal_gate},
                       {"certain", reading_.of_head.gate.certain}};
  json["output"] = options_.output;
  json["fits"] = totals_.fits;
  json["flagged"] = totals_.flagged;
  nlohmann::ordered_json flags = nlohmann::ordered_json::object();
  for (const campaign::CycleFlag& flag : campaign::CycleFlags()) {
    const auto found = totals_.flags.find(std::string(flag.name));
    flags[std::string(flag.name)] = found == totals_.flags.end() ? 0 : found->second;
  }
  json["flags"] = flags;
  json["accumulated_energy"] = energy_.total();
  const campaign::EnergyCounts& counts = energy_.counts();
  json["energy_counts"] = {
      {"measured", counts.measured}, {"replaced", counts.replaced}, {"left_out", counts.left_out}};
  json["shared_alpha"] = nullptr;
  if (shared_alpha_) {
    json["shared_alpha"] = {{"value", shared_alpha_->mean()},
                            {"standard_error", shared_alpha_->standard_error()},
                            {"cycles", shared_alpha_->count()},
                            {"scatter", shared_alpha_->scatter()},
                            {"p_value", shared_alpha_->p_value()}};
  }
  nlohmann::ordered_json quantities = nlohmann::ordered_json::object();
  for (std::size_t k = 0; k < tracked_.size(); ++k) {
    const campaign::CourseDescription& course = courses_[k];
    if (course.stretches.empty()) continue;
    nlohmann::ordered_json stretches = nlohmann::ordered_json::array();
    for (const campaign::Stretch& stretch : course.stretches) {
      stretches.push_back(
          {{"first_cycle", stretch.first_cycle},
           {"last_cycle", stretch.last_cycle},
           {"at_start", stretch.at_start},
           {"at_end", stretch.at_end},
           {"slope", stretch.slope},
           {"slope_p_value", stretch.slope_p_value},
           {"trends", stretch.trends},
           {"time_constant", stretch.time_constant ? nlohmann::ordered_json(*stretch.time_constant)
                                                   : nlohmann::ordered_json(nullptr)}});
    }
    nlohmann::ordered_json changes = nlohmann::ordered_json::array();
    for (const campaign::Change& change : course.changes) {
      changes.push_back({{"kind", campaign::NameOf(change.kind)},
                         {"cycle", change.cycle},
                         {"ci95", {change.lower95, change.upper95}},
                         {"before", change.before},
                         {"after", change.after},
                         {"p_value", change.p_value}});
    }
    quantities[std::string(tracked_[k].name)] = {
        {"unit", UnitOf(tracked_[k].unit)}, {"stretches", stretches}, {"changes", changes}};
  }
  json["quantities"] = quantities;
  return json;
}

void RunTrack(const TrackCommandOptions& options, const CLI::App& command, Console& console) {
  RequireDistinctFiles(options.request.files);
  std::vector<std::string> read = console.inputs;
  read.insert(read.end(), options.request.files.begin(), options.request.files.end());
  RequireOutputPaths({{"--output", options.output},
                      {"--json", options.json_path, /*dash_is_stdout=*/true},
                      {"--plot", options.plot_path},
                      {"--report", options.report_path}},
                     read);
  if (!options.plot_path.empty()) io::RequirePlotName(options.plot_path);
  TrackRun(options, command, console).Go();
}

}  // namespace

void AddTrackCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<TrackCommandOptions>();
  CLI::App* command =
      app.add_subcommand("track",
                         "Fits every cycle of a long record as it is read, in memory that its\n"
                         "length does not change: one row a cycle, and what changed over the\n"
                         "test. A run that was ended goes on with --resume. Exit status 3 when\n"
                         "no fit converged.");
  AddExamples(*command, app,
              {"mindahl track day1.csv --output cycles.csv",
               "mindahl track day1.csv day2.csv --output all_cycles.csv --normal-load 50 --json "
               "track.json"});
  command
      ->add_option("files", options->request.files,
                   "CSV records of one test, in order; a cycle ends with its file")
      ->type_name("FILE");
  AddFilesFrom(*command, options->list);
  AddColumnOptions(*command, options->request.columns);
  AddModelOptions(*command, options->request);
  const std::string cycles = "Cycles";
  AddOptional(*command, "--normal-load", options->normal_load,
              "normal load N [N] of all cycles; default the column's mean over each", "N")
      ->group(cycles);
  command->add_option("--average", options->average, "fit so many cycles in a row together")
      ->capture_default_str()
      ->check(WholeNumber(1, 1'000'000))
      ->group(cycles);
  command->add_option("--every", options->every, "fit one cycle of so many")
      ->capture_default_str()
      ->check(WholeNumber(1, 1'000'000'000))
      ->group(cycles);
  command
      ->add_option("--alpha", options->alpha,
                   "cycle: each has its own; shared: all have one, the mean by errors of a\n"
                   "first pass, and a second one fits sigma and Tc")
      ->capture_default_str()
      ->check(CLI::IsMember({std::string(kOwnAlpha), std::string(kSharedAlpha)}))
      ->group(cycles);
  command
      ->add_option("--broken-rows", options->broken_rows,
                   "a row without a number in a column that is needed ends the run, or is\n"
                   "skipped and counted")
      ->capture_default_str()
      ->check(OneOf({"refuse", "skip"}))
      ->group(cycles);
  command
      ->add_option("--threads", options->threads,
                   "that fit; the table does not depend on it; default one a core")
      ->check(WholeNumber(1, 1024))
      ->group(cycles);
  const std::string group = "Results";
  command->add_option("--output", options->output, "table of cycles as CSV, one row a cycle")
      ->type_name("PATH")
      ->required()
      ->group(group);
  command->add_option("--json", options->json_path, "summary as JSON; - for standard output alone")
      ->type_name("PATH")
      ->group(group);
  command
      ->add_option("--plot", options->plot_path,
                   "evolution over the cycles with what changed, as svg or png")
      ->type_name("PATH")
      ->group(group);
  command
      ->add_option("--report", options->report_path,
                   "all of it as one page of HTML with its figures; it loads nothing")
      ->type_name("PATH")
      ->group(group);
  command
      ->add_flag("--resume", options->resume,
                 "go on with the table that is there: the same files and options")
      ->group(group);
  command->add_flag("--overwrite", options->overwrite, "write over a table that is there")
      ->group(group);
  command->callback([options, command, &console] {
    options->request.files = FilesOf(options->request.files, options->list);
    RunTrack(*options, *command, console);
  });
}

}  // namespace mindahl::cli
