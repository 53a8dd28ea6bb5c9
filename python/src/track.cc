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
#include "mindahl/campaign/cycle_table.h"
#include "mindahl/campaign/dissipated_energy.h"
#include "mindahl/campaign/pooled_value.h"
#include "mindahl/campaign/reading.h"
#include "mindahl/campaign/shared_alpha.h"
#include "mindahl/campaign/tracked_quantities.h"
#include "mindahl/campaign/tracker.h"
#include "mindahl/core/error.h"
#include "mindahl/io/record_stream.h"
#include "mindahl/report/quantity.h"
#include "mindahl/report/units.h"
#include "mindahl/request/fit_records.h"
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
  campaign::TrackedCourses courses;
  std::optional<campaign::PooledValue> shared_alpha;
  bool is_torsional = false;
  std::size_t cycles_per_row = 1;
  std::vector<std::string> warnings;
};

/// Fits of one test, whose samples come as the function gives them.
class Run {
 public:
  /// @param shared_alpha  held in all fits; empty where each cycle has its own
  explicit Run(const TrackRequest& request,
               const std::optional<campaign::PooledValue>& shared_alpha = {})
      : request_(request), fit_(request::MakeCycleFitOptions(request.fit)) {
    tracked_.shared_alpha = shared_alpha;
    if (shared_alpha) fit_.fixed["alpha"] = shared_alpha->mean();
    if (request.normal_load) RequirePositive("--normal-load [N]", *request.normal_load);
    if (request.normal_load) fit_.normal_loads = {*request.normal_load};
    tracked_.cycles_per_row = request.together * request.every;
  }

  [[nodiscard]] bool has_begun() const { return tracker_.has_value(); }
  [[nodiscard]] bool is_torsional() const { return tracked_.is_torsional; }

  void Begin(const loop::RecordView& head, bool is_torsional, std::string_view source) {
    tracked_.is_torsional = is_torsional;
    reading_ = campaign::ChooseReading(head, fit_);
    request::ChooseTermsOfCycles(request_.fit, head, fit_);
    if (auto doubt = campaign::DoubtAbout(reading_, source)) Warn(std::move(*doubt));
    tracker_.emplace(campaign::TrackOptions{.fit = fit_,
                                            .together = request_.together,
                                            .every = request_.every,
                                            .threads = request_.threads},
                     [this](std::span<const CycleFit> fits) {
                       tracked_.fits.insert(tracked_.fits.end(), fits.begin(), fits.end());
                       for (const CycleFit& fit : fits) tracked_.courses.Add(fit);
                     });
  }

  void Add(const loop::RecordView& samples, std::span<const std::size_t> lines) {
    tracker_->Add(samples, lines);
  }

  void NextFile() { tracker_->NextFile(); }

  void Warn(std::string message) { tracked_.warnings.push_back(std::move(message)); }

  Tracked Finish(std::string_view source) {
    tracker_->Finish();
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
    if (stream.broken_rows() > 0) {
      run.Warn(fmt::format("{} broken rows of {} were skipped, the first: {}", stream.broken_rows(),
                           file, stream.first_broken_row()));
    }
  }
  return run.Finish(fmt::format("{}", fmt::join(files, ", ")));
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
  return run.Finish(records.front().name);
}

template <typename Value, typename Of>
py::array_t<Value> CycleColumn(const std::vector<CycleFit>& fits, Of of) {
  py::array_t<Value> column(static_cast<py::ssize_t>(fits.size()));
  Value* const values = column.mutable_data();
  for (std::size_t k = 0; k < fits.size(); ++k) values[k] = of(fits[k]);
  return column;
}

/// Courses of a test in the units of its records.
struct CoursesOfTest {
  campaign::TrackedCourses courses;
  report::Units units;
};

py::dict Describe(const campaign::CourseDescription& course, std::string_view unit) {
  py::list stretches;
  for (const campaign::Stretch& stretch : course.stretches) {
    py::dict described;
    described["first_cycle"] = stretch.first_cycle;
    described["last_cycle"] = stretch.last_cycle;
    described["at_start"] = stretch.at_start;
    described["at_end"] = stretch.at_end;
    described["slope"] = stretch.slope;
    described["slope_p_value"] = stretch.slope_p_value;
    described["trends"] = stretch.trends;
    described["time_constant"] = py::cast(stretch.time_constant);
    stretches.append(described);
  }
  py::list changes;
  for (const campaign::Change& change : course.changes) {
    py::dict described;
    described["kind"] = std::string(campaign::NameOf(change.kind));
    described["cycle"] = change.cycle;
    described["ci95"] = std::vector<std::size_t>{change.lower95, change.upper95};
    described["before"] = change.before;
    described["after"] = change.after;
    described["p_value"] = change.p_value;
    changes.append(described);
  }
  py::dict described;
  described["unit"] = std::string(unit);
  described["stretches"] = stretches;
  described["changes"] = changes;
  return described;
}

/// `quantities` of what `mindahl track --json` writes, and its changes in sentences.
std::pair<py::dict, std::vector<std::string>> Describe(const CoursesOfTest& test) {
  std::vector<campaign::CourseDescription> courses;
  {
    const py::gil_scoped_release others_may_run;
    courses = test.courses.Describe();
  }
  py::dict quantities;
  std::vector<std::string> statements;
  for (std::size_t k = 0; k < courses.size(); ++k) {
    if (courses[k].stretches.empty()) continue;
    const campaign::TrackedQuantity& quantity = campaign::TrackedQuantities()[k];
    const std::string_view unit = report::UnitIn(test.units, quantity.unit);
    quantities[py::str(std::string(quantity.name))] = Describe(courses[k], unit);
    for (const std::string& statement : campaign::ChangeStatements(courses[k])) {
      statements.push_back(fmt::format("{}: {}", report::WithUnit(quantity.name, unit), statement));
    }
  }
  return {quantities, statements};
}

/// `energy_counts` and `shared_alpha` of what `mindahl track --json` writes.
py::dict SummaryOf(const campaign::EnergyCounts& counts,
                   const std::optional<campaign::PooledValue>& alpha) {
  py::dict energy;
  energy["measured"] = counts.measured;
  energy["replaced"] = counts.replaced;
  energy["left_out"] = counts.left_out;
  py::dict summary;
  summary["energy_counts"] = energy;
  summary["shared_alpha"] = py::none();
  if (alpha) {
    py::dict shared;
    shared["value"] = alpha->mean();
    shared["standard_error"] = alpha->standard_error();
    shared["cycles"] = alpha->count();
    shared["scatter"] = alpha->scatter();
    shared["p_value"] = alpha->p_value();
    summary["shared_alpha"] = shared;
  }
  return summary;
}

/// The columns of the command line's table, with NaN for what is not known; their units; what is to
/// be warned of; the courses, which are described when they are asked for; and SummaryOf().
std::tuple<py::dict, py::dict, std::vector<std::string>, CoursesOfTest, py::dict> TrackedColumns(
    Tracked tracked) {
  py::dict columns;
  py::dict units;
  const report::Units& names =
      tracked.is_torsional ? report::kUnitsOfTorque : report::kUnitsOfForce;
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
  campaign::DissipatedEnergy energy(tracked.cycles_per_row);
  columns["accumulated_energy"] = CycleColumn<double>(tracked.fits, [&](const CycleFit& fit) {
    energy.Add(fit);
    return energy.total();
  });
  units["accumulated_energy"] = "J";
  for (const CycleFit& fit : tracked.fits) {
    regimes.append(!fit.slips_grossly ? "" : *fit.slips_grossly ? "gross" : "partial");
    flags.append(fmt::format("{}", fmt::join(fit.flags, " ")));
  }
  columns["slip_regime"] = regimes;
  columns["flags"] = flags;
  return {columns,
          units,
          tracked.warnings,
          {std::move(tracked.courses), names},
          SummaryOf(energy.counts(), tracked.shared_alpha)};
}

}  // namespace

void AddTrack(py::module_& module) {
  py::class_<CoursesOfTest>(module, "TrackedCourses")
      .def("describe", py::overload_cast<const CoursesOfTest&>(&Describe));
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
