#include "mindahl/request/track.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.h"
#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/campaign/cycle_splitter.h"
#include "mindahl/campaign/test_summary.h"
#include "mindahl/campaign/tracker.h"
#include "mindahl/core/error.h"
#include "mindahl/io/record_stream.h"
#include "mindahl/report/units.h"
#include "mindahl/request/fit_request.h"
#include "record.h"

namespace mindahl::python {

namespace py = pybind11;
using campaign::CycleFit;
using request::FitRequest;

namespace {

struct TrackRequest {
  FitRequest fit;
  std::optional<double> normal_load;
  std::size_t together = 1;
  std::size_t every = 1;
  std::size_t threads = 1;
  bool shares_alpha = false;
};

struct Tracked {
  std::vector<CycleFit> fits;
  std::vector<double> accumulated_energy;  // [J], with each fit
  request::TrackedTest test;
  std::vector<std::string> warnings;
};

/// Fits of one test, whose samples come as the function gives them.
class Run {
 public:
  /// @param shared_alpha  held in all fits; empty where each cycle has its own
  explicit Run(const TrackRequest& request,
               const std::optional<campaign::PooledValue>& shared_alpha = {})
      : request_(request),
        fit_(request::MakeCycleFitOptions(request.fit)),
        tracked_{.fits = {},
                 .accumulated_energy = {},
                 .test = request::TrackedTest(request.together * request.every),
                 .warnings = {}} {
    tracked_.test.shared_alpha = shared_alpha;
    if (shared_alpha) fit_.fixed["alpha"] = shared_alpha->mean();
    if (request.normal_load) RequirePositive("--normal-load [N]", *request.normal_load);
    if (request.normal_load) fit_.normal_loads = {*request.normal_load};
  }

  [[nodiscard]] bool has_begun() const { return tracker_.has_value(); }
  [[nodiscard]] bool is_torsional() const { return tracked_.test.is_torsional; }

  void Begin(const loop::RecordView& head, bool is_torsional, std::string_view source) {
    tracked_.test.is_torsional = is_torsional;
    reading_ = campaign::ChooseReading(head, fit_);
    request::ChooseTermsOfCycles(request_.fit, head, fit_);
    if (auto doubt = campaign::DoubtAbout(reading_, source)) Warn(std::move(*doubt));
    tracker_.emplace(campaign::TrackOptions{.fit = fit_,
                                            .together = request_.together,
                                            .every = request_.every,
                                            .threads = request_.threads},
                     [this](std::span<const CycleFit> fits) {
                       tracked_.fits.insert(tracked_.fits.end(), fits.begin(), fits.end());
                       for (const CycleFit& fit : fits) {
                         tracked_.test.Add(fit);
                         tracked_.test.energy.Add(fit);
                         tracked_.accumulated_energy.push_back(tracked_.test.energy.total());
                       }
                     });
  }

  void Add(const loop::RecordView& samples, std::span<const std::size_t> lines) {
    tracked_.test.samples += samples.size();
    tracker_->Add(samples, lines);
  }

  void NextFile() { tracked_.test.unused_samples += tracker_->NextFile(); }

  void SkipRows(std::size_t count) { tracked_.test.broken_rows += count; }

  void Warn(std::string message) { tracked_.warnings.push_back(std::move(message)); }

  Tracked Finish(std::string_view source, std::vector<std::string> files) {
    tracker_->Finish();
    request::TrackedTest& test = tracked_.test;
    test.files = std::move(files);
    test.cycles = tracker_->cycles();
    test.reversal_gate = *fit_.preparation.reversal_gate;
    test.is_gate_certain = reading_.gate.certain;
    campaign::RequireCycles(tracker_->cycles(), request_.together, reading_,
                            *fit_.preparation.reversal_gate, source);
    return std::move(tracked_);
  }

 private:
  const TrackRequest& request_;
  identification::FitOptions fit_;
  campaign::Reading reading_;
  std::optional<campaign::Tracker> tracker_;
  Tracked tracked_;
};

void RequireOneKind(const Run& run, bool is_torsional, const std::string& first,
                    const std::string& other) {
  if (!run.has_begun() || run.is_torsional() == is_torsional) return;
  throw InputError(fmt::format("{} holds a {} and {} a {}: track them apart", first,
                               run.is_torsional() ? "torque" : "force", other,
                               is_torsional ? "torque" : "force"));
}

/// What all cycles of a first pass have in common.
campaign::PooledValue AlphaOf(const Tracked& first_pass) {
  campaign::PooledValue alpha;
  for (const CycleFit& fit : first_pass.fits) campaign::PoolAlpha(fit, alpha);
  campaign::RequireSharedAlpha(alpha);
  return alpha;
}

/// By one pass, or where alpha is shared by a second with that of the first.
/// @param pass   tracks all samples once with the alpha that is given
/// @param files  that it reads
template <typename Pass>
Tracked TrackInPasses(const TrackRequest& request, const std::vector<std::string>& files,
                      Pass pass) {
  if (!request.shares_alpha) return pass(std::optional<campaign::PooledValue>());
  campaign::RequireThatAlphaCanBeShared(request::MakeCycleFitOptions(request.fit), files);
  const campaign::PooledValue alpha = AlphaOf(pass(std::optional<campaign::PooledValue>()));
  return pass(std::optional(alpha));
}

Tracked TrackFiles(const TrackRequest& request, const std::vector<std::string>& files,
                   bool skip_broken_rows,
                   const std::optional<campaign::PooledValue>& shared_alpha) {
  Run run(request, shared_alpha);
  const io::BrokenRows broken = skip_broken_rows ? io::BrokenRows::kSkip : io::BrokenRows::kRefuse;
  io::JoinedTimes times;
  for (const std::string& file : files) {
    io::RecordStream stream(file, request.fit.columns, broken);
    RequireOneKind(run, stream.layout().is_torsional, files.front(), file);
    for (const std::string& note : stream.layout().notes) run.Warn(note);
    io::Samples piece;
    if (run.has_begun()) {
      stream.Next(piece);
    } else {
      piece = campaign::ReadHead(stream);
      run.Begin(campaign::ViewOf(piece), stream.layout().is_torsional, file);
    }
    while (piece.size() > 0) {
      times.Shift(piece.time);
      run.Add(campaign::ViewOf(piece), piece.lines);
      if (!stream.Next(piece)) break;
    }
    if (request.fit.join) {
      times.NextFile();
    } else {
      run.NextFile();
      times = {};
    }
    run.SkipRows(stream.broken_rows());
    if (stream.footer_lines() > 0) {
      run.Warn(fmt::format("{}: {} lines below the data skipped, since they begin with a text",
                           file, stream.footer_lines()));
    }
    if (stream.broken_rows() > 0) {
      run.Warn(fmt::format("{} broken rows of {} were skipped, the first: {}", stream.broken_rows(),
                           file, stream.first_broken_row()));
    }
  }
  return run.Finish(fmt::format("{}", fmt::join(files, ", ")), files);
}

Tracked TrackRecords(const TrackRequest& request, const std::vector<NamedRecord>& records,
                     const std::optional<campaign::PooledValue>& shared_alpha) {
  constexpr std::size_t kMostOfHead = 1'000'000;
  Run run(request, shared_alpha);
  io::JoinedTimes times;
  for (const NamedRecord& record : records) {
    const bool is_torsional = record.file.is_torsional;
    RequireOneKind(run, is_torsional, records.front().name, record.name);
    const loop::Record& samples = record.file.record;
    if (!run.has_begun()) {
      const std::size_t head = std::min(samples.size(), kMostOfHead);
      const auto first = [head](const std::vector<double>& column) {
        return std::span(column).first(std::min(head, column.size()));
      };
      run.Begin({first(samples.displacement), first(samples.force), first(samples.time),
                 first(samples.normal_load)},
                is_torsional, record.name);
    }
    std::vector<double> time = samples.time;
    times.Shift(time);
    run.Add({samples.displacement, samples.force, time, samples.normal_load}, record.file.lines);
    if (request.fit.join) {
      times.NextFile();
    } else {
      run.NextFile();
      times = {};
    }
  }
  std::vector<std::string> names;
  for (const NamedRecord& record : records) names.push_back(record.name);
  return run.Finish(records.front().name, names);
}

template <typename Value, typename Of>
py::array_t<Value> CycleColumn(const std::vector<CycleFit>& fits, Of of) {
  py::array_t<Value> column(static_cast<py::ssize_t>(fits.size()));
  Value* const values = column.mutable_data();
  for (std::size_t k = 0; k < fits.size(); ++k) values[k] = of(fits[k]);
  return column;
}

/// A test whose time histories are described when they are asked for, which takes a while.
struct DescribedTest {
  request::TrackedTest test;

  /// Returns the JSON, the text, and the changes in sentences.
  [[nodiscard]] std::tuple<std::string, std::string, std::vector<std::string>> Describe() const {
    const py::gil_scoped_release others_may_run;
    const std::vector<campaign::CourseDescription> described = test.courses.Describe();
    return {ToJson(test, described), ToText(test, described), SummaryOf(test, described).changes};
  }
};

/// The columns of the command line's table, with NaN for what is not known; their units; what is to
/// be warned of; and the test.
std::tuple<py::dict, py::dict, std::vector<std::string>, DescribedTest> TrackedColumns(
    Tracked tracked) {
  py::dict columns;
  py::dict units;
  const report::Units& names =
      tracked.test.is_torsional ? report::kUnitsOfTorque : report::kUnitsOfForce;
  const auto number = [&](const char* name, std::size_t CycleFit::*member) {
    columns[name] = CycleColumn<std::int64_t>(tracked.fits, [member](const CycleFit& fit) {
      return static_cast<std::int64_t>(fit.*member);
    });
  };
  number("cycle", &CycleFit::number);
  number("first_line", &CycleFit::first_line);
  number("samples", &CycleFit::samples);
  for (const campaign::CycleNumber& column : campaign::CycleNumbers()) {
    py::array_t<double> values(static_cast<py::ssize_t>(tracked.fits.size()));
    double* const written = values.mutable_data();
    for (std::size_t k = 0; k < tracked.fits.size(); ++k) {
      written[k] = column.of(tracked.fits[k]).value_or(std::numeric_limits<double>::quiet_NaN());
    }
    const std::string name(column.name);
    columns[py::str(name)] = values;
    if (!column.unit.empty()) {
      units[py::str(name)] = std::string(report::UnitIn(names, column.unit));
    }
  }
  py::list regimes;
  py::list flags;
  const std::vector<double>& energy = tracked.accumulated_energy;
  columns["accumulated_energy"] =
      py::array_t<double>(static_cast<py::ssize_t>(energy.size()), energy.data());
  units["accumulated_energy"] = "J";
  for (const CycleFit& fit : tracked.fits) {
    regimes.append(!fit.slips_grossly ? "" : *fit.slips_grossly ? "gross" : "partial");
    flags.append(fmt::format("{}", fmt::join(fit.flags, " ")));
  }
  columns["slip_regime"] = regimes;
  columns["flags"] = flags;
  return {columns, units, tracked.warnings, {std::move(tracked.test)}};
}

}  // namespace

void AddTrack(py::module_& module) {
  py::class_<DescribedTest>(module, "TrackedTest")
      .def("describe", &DescribedTest::Describe)
      .def_property_readonly("established",
                             [](const DescribedTest& self) { return self.test.established(); });
  py::class_<TrackRequest>(module, "TrackRequest")
      .def(py::init<>())
      .def_readwrite("fit", &TrackRequest::fit)
      .def_readwrite("normal_load", &TrackRequest::normal_load)
      .def_readwrite("average", &TrackRequest::together)
      .def_readwrite("every", &TrackRequest::every)
      .def_readwrite("threads", &TrackRequest::threads)
      .def_readwrite("shares_alpha", &TrackRequest::shares_alpha);
  module.def(
      "track_files",
      [](const TrackRequest& request, const std::vector<std::string>& files, bool skip) {
        Tracked tracked;
        {
          const py::gil_scoped_release others_may_run;
          tracked = TrackInPasses(request, files, [&](const auto& alpha) {
            return TrackFiles(request, files, skip, alpha);
          });
        }
        return TrackedColumns(std::move(tracked));
      },
      py::arg("request"), py::arg("files"), py::arg("skip_broken_rows"));
  module.def(
      "track_records",
      [](const TrackRequest& request, const std::vector<NamedRecord>& records) {
        Tracked tracked;
        {
          const py::gil_scoped_release others_may_run;
          tracked = TrackInPasses(request, {}, [&](const auto& alpha) {
            return TrackRecords(request, records, alpha);
          });
        }
        return TrackedColumns(std::move(tracked));
      },
      py::arg("request"), py::arg("records"));
}

}  // namespace mindahl::python
