#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "cli/app.h"
#include "cli/command.h"
#include "mindahl/core/error.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::python {

namespace py = pybind11;
using report::Report;
using request::FitRequest;

namespace {

std::shared_ptr<Report> Fit(std::vector<RecordFile> records, const FitRequest& request) {
  const Running running;
  return std::make_shared<Report>(request::FitRecords(request, std::move(records)));
}

std::string TextOf(const Report& report) {
  if (report.failed()) return "the fit failed: " + report.fit.solver.message + '\n';
  return report::ToText(report);
}

/// One dict a record: its arrays, and those of the fit where it did not fail.
py::list RecordsOf(const Report& report, const py::handle& owner) {
  static const identification::RecordFit kNone;
  py::list records;
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const loop::Record& record = report.records[r].record;
    const identification::RecordFit& fit = report.failed() ? kNone : report.fit.records[r];
    py::dict arrays;
    arrays["name"] = report.records[r].name;
    arrays["displacement"] = ViewOf(record.displacement, owner);
    arrays["force"] = ViewOf(record.force, owner);
    arrays["time"] = ViewOf(record.time, owner);
    arrays["fitted_force"] = ViewOf(fit.fitted_force, owner);
    arrays["fitted_displacement"] = ViewOf(fit.fitted_displacement, owner);
    arrays["residual"] = ViewOf(fit.residual, owner);
    records.append(arrays);
  }
  return records;
}

py::dict KeptOf(const py::object& self) {
  const auto& report = self.cast<const Report&>();
  std::string document;
  std::string text;
  {
    const py::gil_scoped_release others_may_run;
    document = report::ToJson(report);
    text = TextOf(report);
  }
  py::dict kept;
  kept["document"] = document;
  kept["text"] = text;
  kept["notes"] = report.notes;
  kept["units"] =
      std::pair(std::string(report.units.displacement), std::string(report.units.force));
  kept["records"] = RecordsOf(report, self);
  if (report.failed()) return kept;
  py::dict values;
  for (const identification::ParameterEstimate& estimate : report.fit.parameters) {
    values[py::str(estimate.name)] = estimate.value;
  }
  kept["values"] = values;  // the report has none of a parameter at a bound
  kept["force_sign"] = report.fit.force_sense;
  kept["reversal_gate"] = report.fit.records.front().gate.gate;
  return kept;
}

/// Returns the request that the options of `mindahl fit` make, without files.
FitRequest RequestOf(const std::vector<std::string>& words) {
  FitRequest request;
  cli::ReadOptions(words, [&request](CLI::App& app) { cli::AddFitOptions(app, request); });
  return request;
}

}  // namespace

void AddFit(py::module_& module) {
  py::class_<FitRequest>(module, "FitRequest")
      .def(py::init(&RequestOf), py::arg("words"))
      .def("covariate_columns",
           [](const FitRequest& request) { return request::MakeFitOptions(request).covariates; })
      .def("explained",
           [](const FitRequest& request, const std::string& fault) {
             return WithKeywords(request::ExplainColumnFault(request, fault));
           })
      .def("check", [](const FitRequest& request) { request::MakeFitOptions(request); });
  py::class_<Report, std::shared_ptr<Report>>(module, "Fitted")
      .def("page",
           [](const Report& report) {
             const py::gil_scoped_release others_may_run;
             return report::ToPage(report);
           })
      .def_property_readonly("kept", &KeptOf, "what a result is without its C++ part");
  module.def("fit", &Fit, py::arg("records"), py::arg("request"));
}

}  // namespace mindahl::python
