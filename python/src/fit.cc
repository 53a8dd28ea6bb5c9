#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "mindahl/core/error.h"
#include "mindahl/report/page.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"
#include "record.h"
#include "request.h"

namespace mindahl::python {

namespace py = pybind11;
using contact::UncertainValue;
using report::Report;
using request::FitRequest;

namespace {

/// A report and what was assumed on the way to it.
struct Fitted {
  Report report;
  std::vector<std::string> notes;
};

std::shared_ptr<Fitted> Fit(const std::vector<NamedRecord>& records, FitRequest request) {
  const Running running;
  request.files.clear();
  std::vector<io::RecordFile> files;
  std::vector<std::string> notes;
  for (const NamedRecord& record : records) request.files.push_back(record.name);
  request::Validate(request);
  for (const NamedRecord& record : records) {
    io::RecordFile& file = files.emplace_back(record.file);
    request::KeepTimeWindow(request, record.name, file);
    notes.insert(notes.end(), file.notes.begin(), file.notes.end());
  }
  Report report = request::FitRecords(request, std::move(files),
                                      [&](std::string_view note) { notes.emplace_back(note); });
  return std::make_shared<Fitted>(Fitted{std::move(report), std::move(notes)});
}

std::string TextOf(const Fitted& fitted) {
  if (fitted.report.failed()) return "the fit failed: " + fitted.report.fit.solver.message + '\n';
  return report::ToText(fitted.report);
}

/// One dict a record: its arrays, and those of the fit where it did not fail.
py::list RecordsOf(const py::object& self) {
  const Fitted& fitted = self.cast<const Fitted&>();
  py::list records;
  for (std::size_t r = 0; r < fitted.report.records.size(); ++r) {
    const loop::Record& record = fitted.report.records[r].record;
    py::dict arrays;
    arrays["name"] = fitted.report.files[r];
    arrays["displacement"] = ViewOf(record.displacement, self);
    arrays["force"] = ViewOf(record.force, self);
    arrays["time"] = record.time.empty() ? py::object(py::none()) : ViewOf(record.time, self);
    arrays["fitted_force"] = py::none();
    arrays["fitted_displacement"] = py::none();
    arrays["residual"] = py::none();
    if (!fitted.report.failed()) {
      arrays["fitted_force"] = ViewOf(fitted.report.fit.records[r].fitted_force, self);
      if (!fitted.report.fit.records[r].fitted_displacement.empty()) {
        arrays["fitted_displacement"] =
            ViewOf(fitted.report.fit.records[r].fitted_displacement, self);
      }
      arrays["residual"] = ViewOf(fitted.report.fit.records[r].residual, self);
    }
    records.append(arrays);
  }
  return records;
}

/// The log-likelihood of a fit, which keeps its records.
class Likelihood {
 public:
  explicit Likelihood(std::shared_ptr<const Fitted> fitted)
      : fitted_(std::move(fitted)), of_(LikelihoodOf(*fitted_)) {}

  [[nodiscard]] std::vector<std::string> names() const {
    return {of_.names().begin(), of_.names().end()};
  }
  double operator()(const Array& values) { return of_(SpanOf(values, "values")); }

 private:
  static identification::LogLikelihood LikelihoodOf(const Fitted& fitted) {
    const Report& report = fitted.report;
    if (report.failed()) throw InputError("a fit that failed has no likelihood");
    std::vector<loop::RecordView> views;
    for (const io::RecordFile& input : report.records) views.emplace_back(input.record);
    return {views, report.options, report.fit};
  }

  std::shared_ptr<const Fitted> fitted_;
  identification::LogLikelihood of_;
};

void SetRigStiffness(FitRequest& request, std::optional<double> value,
                     std::optional<double> standard_uncertainty) {
  request.rig_stiffness = {.value = value, .standard_uncertainty = standard_uncertainty};
}

void AddCovariate(FitRequest& request, const std::string& column, std::optional<double> value) {
  request.covariates.push_back({.column = column, .coefficient = value});
}

void SetBound(FitRequest& request, const std::string& name, double lower, double upper) {
  request.bound[name] = {.lower = lower, .upper = upper};
}

/// A pair, or None, as an optional range.
template <auto member, typename Number>
void SetRange(FitRequest& request, const std::optional<std::pair<Number, Number>>& range) {
  (request.*member).reset();
  if (range) (request.*member) = {range->first, range->second};
}

void SetNormalLoads(FitRequest& request, const std::vector<UncertainValue>& loads) {
  request::SetNormalLoads(request.contact, loads);
}

}  // namespace

void AddFit(py::module_& module) {
  AddRequest(module)
      .def("set_time_window", &SetRange<&FitRequest::time_window, double>)
      .def_readwrite("model", &FitRequest::model)
      .def_readwrite("initial_state", &FitRequest::initial_state)
      .def_readwrite("force_sign", &FitRequest::force_sign)
      .def_readwrite("noise_in", &FitRequest::noise_in)
      .def_readwrite("offsets", &FitRequest::offsets)
      .def("add_covariate", &AddCovariate, py::arg("column"), py::arg("value"))
      .def_readwrite("terms", &FitRequest::terms)
      .def_readwrite("compare", &FitRequest::compare)
      .def("set_load_window", &SetRange<&FitRequest::load_window, double>)
      .def("set_cycles", &SetRange<&FitRequest::cycles, std::size_t>)
      .def("set_samples", &SetRange<&FitRequest::samples, std::size_t>)
      .def_readwrite("trim", &FitRequest::trim)
      .def_readwrite("loss", &FitRequest::loss)
      .def_readwrite("fix", &FitRequest::fix)
      .def_readwrite("start", &FitRequest::start)
      .def_readwrite("prior", &FitRequest::prior)
      .def("set_bound", &SetBound, py::arg("name"), py::arg("lower"), py::arg("upper"))
      .def_readwrite("confidence", &FitRequest::confidence)
      .def_readwrite("force_noise", &FitRequest::force_noise)
      .def_readwrite("displacement_noise", &FitRequest::displacement_noise)
      .def_readwrite("reversal_gate", &FitRequest::reversal_gate)
      .def_readwrite("columns", &FitRequest::columns)
      .def_readwrite("files", &FitRequest::files)
      .def_readwrite("join", &FitRequest::join)
      .def_readwrite("contact", &FitRequest::contact)
      .def("set_rig_stiffness", &SetRigStiffness, py::arg("value"), py::arg("standard_uncertainty"))
      .def("set_normal_loads", &SetNormalLoads, py::arg("loads"))
      .def("covariate_columns", &request::CovariateColumns);
  py::class_<Fitted, std::shared_ptr<Fitted>>(module, "Fitted")
      .def("json",
           [](const Fitted& fitted) {
             const py::gil_scoped_release others_may_run;
             return report::ToJson(fitted.report);
           })
      .def("page",
           [](const Fitted& fitted) {
             const py::gil_scoped_release others_may_run;
             return report::ToPage(fitted.report);
           })
      .def("text", &TextOf)
      .def("residuals_csv",
           [](const Fitted& fitted) { return report::ResidualsCsv(fitted.report); })
      .def_property_readonly("records", &RecordsOf)
      .def_property_readonly("failed", [](const Fitted& fitted) { return fitted.report.failed(); })
      .def_property_readonly("units",
                             [](const Fitted& fitted) {
                               return std::pair(std::string(fitted.report.units.displacement),
                                                std::string(fitted.report.units.force));
                             })
      .def_readonly("notes", &Fitted::notes);
  py::class_<Likelihood>(module, "Likelihood")
      .def(py::init([](const std::shared_ptr<Fitted>& fitted) { return Likelihood(fitted); }),
           py::arg("fitted"))
      .def_property_readonly("names", &Likelihood::names)
      .def("__call__", &Likelihood::operator(), py::arg("values"));
  module.def("fit", &Fit, py::arg("records"), py::arg("request"));
}

}  // namespace mindahl::python
