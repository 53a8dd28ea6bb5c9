#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/campaign/evolution.h"
#include "mindahl/campaign/test_summary.h"
#include "mindahl/campaign/tracker.h"
#include "mindahl/io/plot.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/io/record_stream.h"
#include "mindahl/report/page.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::request {

/// Holds the answer for a test of many cycles, apart from its rows.
struct TrackedTest {
  /// @param cycles_per_row  that a fit stands for, >= 1
  explicit TrackedTest(std::size_t cycles_per_row = 1) : energy(cycles_per_row) {}

  /// Adds a fit, in their order, but for its energy: of rows that are made again that counts once.
  void Add(const campaign::CycleFit& fit);
  /// True unless no fit converged.
  [[nodiscard]] bool established() const;

  std::vector<std::string> files;
  std::string output;  ///< path of the table of cycles; "" where none was written
  bool is_torsional = false;
  std::size_t samples = 0;  ///< number of samples read
  std::size_t cycles = 0;
  std::size_t unused_samples = 0;  ///< at the ends, part of no whole cycle
  std::size_t broken_rows = 0;     ///< number of rows skipped
  double reversal_gate = 0.0;      ///< [m]
  bool is_gate_certain = true;
  std::size_t fits = 0;
  std::size_t flagged = 0;
  std::size_t resumed = 0;  ///< fits that the table had already
  std::map<std::string, std::size_t> flags;
  campaign::TrackedCourses courses;
  campaign::DissipatedEnergy energy;
  std::vector<campaign::Cycle> log = {};  ///< loops of the cycles 1, 10, 100, …
};

/// Holds what is asked for of a test of many cycles. Its files are those of `fit`.
struct TrackRequest {
  FitRequest fit = {};      ///< model of each cycle, and what is known of the contact
  std::size_t average = 1;  ///< cycles in a row that are fitted together
  std::size_t every = 1;    ///< one fit of so many that there could be
  std::size_t threads = 1;
};

/// @throws InputError or InvalidArgument naming the option
void Validate(const TrackRequest& request);

/// Receives what a run has to say as it goes on. `fits` is needed, the others may be empty.
struct TrackEvents {
  std::function<void(std::span<const campaign::CycleFit>)> fits{};  ///< in their order, by batches
  std::function<void(std::string_view)> note = {};
  std::function<void(std::string_view)> warn = {};
  /// Called before the first fit: may set which are skipped, and the seed.
  std::function<void(campaign::TrackOptions&)> begins = {};
  std::function<void()> piece_is_read = {};  ///< may throw, which ends the run
};

/// Reads a test of many cycles piece by piece, and fits each.
class TrackRun {
 public:
  /// @param request  valid; kept by reference
  TrackRun(const TrackRequest& request, TrackEvents events);

  /// Reads and fits all cycles.
  /// @param records  in memory; none: the files of the request
  /// @throws InputError naming the place in a file
  void Read(std::span<const io::NamedRecord> records = {});

  /// Fits what was read before Read() threw.
  void FitTheRest() { tracker_->Finish(); }

  /// Completes the description of the test.
  /// @throws InputError where it has no cycle
  void Finish();

  /// True once a cycle may have been fitted.
  [[nodiscard]] bool has_begun() const { return tracker_.has_value(); }
  [[nodiscard]] std::size_t cycles() const { return tracker_->cycles(); }
  [[nodiscard]] std::uintmax_t bytes_read() const { return bytes_read_; }
  [[nodiscard]] const campaign::Reading& reading() const { return reading_; }
  /// Says which terms the first cycles require; empty where that was not asked for.
  [[nodiscard]] const std::string& chosen_terms() const { return chosen_terms_; }
  /// Returns the columns of the first file.
  [[nodiscard]] const io::RecordFile& layout() const { return *layout_; }
  [[nodiscard]] TrackedTest& test() { return test_; }
  [[nodiscard]] const TrackedTest& test() const { return test_; }

 private:
  void ReadFile(const std::string& file);
  void ReadRecord(const io::NamedRecord& record);
  void BeginSource(const io::RecordFile& layout, const std::string& name);
  void BeginFits(const loop::RecordView& head, std::string_view source);
  void EndSource();

  const TrackRequest& request_;
  TrackEvents events_;
  identification::FitOptions fit_;
  std::string chosen_terms_;
  campaign::Reading reading_;  // of the head
  io::JoinedTimes times_;
  std::optional<io::RecordFile> layout_;
  std::vector<std::string> names_;  // of what was read
  TrackedTest test_;
  std::optional<campaign::Tracker> tracker_;
  std::uintmax_t bytes_before_ = 0;  // of the files that are done
  std::uintmax_t bytes_read_ = 0;
};

/// Returns the JSON of schema mindahl.track/1, as `mindahl track --json` writes it.
/// @param evolutions  of the test's courses, by Describe()
std::string ToJson(const TrackedTest& test, const std::vector<campaign::Evolution>& evolutions);

/// Returns the summary that `mindahl track` prints, likewise.
std::string ToText(const TrackedTest& test, const std::vector<campaign::Evolution>& evolutions);

/// Returns the page of the test, as report::ToPage() makes one of a fit.
std::string ToPage(const TrackedTest& test, const std::vector<campaign::Evolution>& evolutions,
                   const report::Provenance& provenance = {});

/// Returns the time histories, one below the other.
/// @throws InvalidArgument where none has two cycles
io::Plot ToPlot(const TrackedTest& test, const std::vector<campaign::Evolution>& evolutions);

}  // namespace mindahl::request
