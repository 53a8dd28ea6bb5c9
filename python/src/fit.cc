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
using identification::LogLikelihood;
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
  kept["force_sign"] = report.fit.force_sense;
  kept["reversal_gate"] = report.fit.records.front().gate.gate;
  return kept;
}

/// The log-likelihood of a fit, which reads its records.
LogLikelihood LikelihoodOf(const Report& report) {
  if (report.failed()) throw InputError("a fit that failed has no likelihood");
  std::vector<loop::RecordView> views;
  views.reserve(report.records.size());
  for (const io::RecordFile& input : report.records) views.emplace_back(input.record);
  return {views, report.options, report.fit};
}

/// Returns the request that the options of `mindahl fit` make, without files.
FitRequest RequestOf(const std::vector<std::string>& words) {
  FitRequest request;
  cli::ReadOptions(words, [&request](CLI::App& app) {
    cli::AddJoin(app, request);
    cli::AddFitOptions(app, request, cli::NormalLoads::kOneAFile);
  });
  return request;
}

}  // namespace

void AddFit(py::module_& module) {
  py::class_<FitRequest>(module, "FitRequest")
      .def(py::init(&RequestOf), py::arg("words"))
      .def("covariate_columns",
           [](const FitRequest& request) { return request::MakeFitOptions(request).covariates; })
      .def("check", [](const FitRequest& request) { request::MakeFitOptions(request); });
  py::class_<LogLikelihood>(module, "LogLikelihood",
                            R"(ln L of the free parameters of a fit but for a constant.

-(n_eff/n) sum((r/s)^2)/2, with the noise s and the effective samples n_eff that the fit states; priors
are not in it. Called with a value of each of names [unit of each]: -inf outside the bounds of the fit.)")
      .def_property_readonly("names",
                             [](const LogLikelihood& likelihood) {
                               return std::vector(likelihood.names().begin(),
                                                  likelihood.names().end());
                             })
      .def(
          "__call__",
          [](LogLikelihood& likelihood, const Array& values) { return likelihood(SpanOf(values)); },
          py::arg("values"));
  py::class_<Report, std::shared_ptr<Report>>(module, "Fitted")
      .def("page",
           [](const Report& report) {
             const py::gil_scoped_release others_may_run;
             return report::ToPage(report);
           })
      .def("log_likelihood", &LikelihoodOf, py::keep_alive<0, 1>())
      .def_property_readonly("kept", &KeptOf, "what a result is without its C++ part");
  module.def("fit", &Fit, py::arg("records"), py::arg("request"));
}

}  // namespace mindahl::python
