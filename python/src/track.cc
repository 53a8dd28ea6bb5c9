#include "mindahl/request/track.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.h"
#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/io/record_stream.h"
#include "mindahl/report/units.h"
#include "mindahl/request/fit_request.h"
#include "record.h"

namespace mindahl::python {

namespace py = pybind11;
using campaign::CycleFit;
using request::TrackRequest;

namespace {

/// A test that was tracked, with its rows.
struct Tracked {
  std::vector<CycleFit> fits;
  std::vector<double> accumulated_energy;  // [J], with each fit
  request::TrackedTest test;
  std::vector<std::string> warnings;
};

/// Tracks records in memory, or without any the files of the request.
Tracked Track(const TrackRequest& request, const std::vector<NamedRecord>& records) {
  request::Validate(request);
  Tracked tracked;
  const auto warn = [&](std::string_view text) { tracked.warnings.emplace_back(text); };
  std::optional<request::TrackRun> run;
  const auto take = [&](std::span<const CycleFit> fits) {
    AskWhetherToGoOn();
    tracked.fits.insert(tracked.fits.end(), fits.begin(), fits.end());
    for (const CycleFit& fit : fits) {
      run->test().Add(fit);
      run->test().energy.Add(fit);
      tracked.accumulated_energy.push_back(run->test().energy.total());
    }
  };
  run.emplace(request, request::TrackEvents{
                           .fits = take, .note = warn, .warn = warn, .piece_is_read = [](auto...) {
                             AskWhetherToGoOn();
                           }});
  run->Read(records);
  run->Finish();
  tracked.test = std::move(run->test());
  return tracked;
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
    const std::vector<campaign::Evolution> evolutions = test.courses.Describe(test.is_torsional);
    return {ToJson(test, evolutions), ToText(test, evolutions),
            campaign::ChangeStatements(evolutions)};
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
      units[py::str(name)] = report::UnitIn(names, column.unit);
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
      .def_readwrite("average", &TrackRequest::average)
      .def_readwrite("every", &TrackRequest::every)
      .def_readwrite("threads", &TrackRequest::threads)
      .def_property(
          "skips_broken_rows",
          [](const TrackRequest& self) { return self.broken_rows == io::BrokenRows::kSkip; },
          [](TrackRequest& self, bool skips) {
            self.broken_rows = skips ? io::BrokenRows::kSkip : io::BrokenRows::kRefuse;
          });
  module.def(
      "track",
      [](const TrackRequest& request, const std::vector<NamedRecord>& records) {
        Tracked tracked;
        {
          const Running running;
          tracked = Track(request, records);
        }
        return TrackedColumns(std::move(tracked));
      },
      py::arg("request"), py::arg("records"));
}

}  // namespace mindahl::python
