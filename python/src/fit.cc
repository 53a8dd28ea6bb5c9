#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "cli/app.h"
#include "cli/fit_request.h"
#include "mindahl/core/error.h"
#include "mindahl/report/page.h"
#include "mindahl/report/report.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::python {

namespace py = pybind11;
using report::Report;
using request::FitRequest;

namespace {

/// A report, held where Python finds its arrays.
struct Fitted {
  Report report;
};

std::shared_ptr<Fitted> Fit(const std::vector<NamedRecord>& records, FitRequest request) {
  const Running running;
  request.files.clear();
  std::vector<io::RecordFile> files;
  for (const NamedRecord& record : records) request.files.push_back(record.name);
  request::Validate(request);
  for (const NamedRecord& record : records) {
    request::KeepTimeWindow(request, record.name, files.emplace_back(record.file));
  }
  return std::make_shared<Fitted>(Fitted{request::FitRecords(request, std::move(files))});
}

std::string TextOf(const Fitted& fitted) {
  if (fitted.report.failed()) return "the fit failed: " + fitted.report.fit.solver.message + '\n';
  return report::ToText(fitted.report);
}

/// One dict a record: its arrays, and those of the fit where it did not fail.
py::list RecordsOf(const Report& report, const py::handle& owner) {
  static const identification::RecordFit kNone;
  py::list records;
  for (std::size_t r = 0; r < report.records.size(); ++r) {
    const loop::Record& record = report.records[r].record;
    const identification::RecordFit& fit = report.failed() ? kNone : report.fit.records[r];
    py::dict arrays;
    arrays["name"] = report.files[r];
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
  const auto& fitted = self.cast<const Fitted&>();
  std::string document;
  std::string text;
  {
    const py::gil_scoped_release others_may_run;
    document = report::ToJson(fitted.report);
    text = TextOf(fitted);
  }
  py::dict kept;
  kept["document"] = document;
  kept["text"] = text;
  kept["notes"] = fitted.report.notes;
  kept["units"] = std::pair(std::string(fitted.report.units.displacement),
                            std::string(fitted.report.units.force));
  kept["records"] = RecordsOf(fitted.report, self);
  return kept;
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
      .def("covariate_columns", &request::CovariateColumns)
      .def("check", [](const FitRequest& request) { request::MakeFitOptions(request); });
  py::class_<Fitted, std::shared_ptr<Fitted>>(module, "Fitted")
      .def("page",
           [](const Fitted& fitted) {
             const py::gil_scoped_release others_may_run;
             return report::ToPage(fitted.report);
           })
      .def("residuals_csv",
           [](const Fitted& fitted) { return report::ResidualsCsv(fitted.report); })
      .def_property_readonly("kept", &KeptOf, "what a result is without its C++ part");
  py::class_<Likelihood>(module, "Likelihood")
      .def(py::init([](const std::shared_ptr<Fitted>& fitted) { return Likelihood(fitted); }),
           py::arg("fitted"))
      .def_property_readonly("names", &Likelihood::names)
      .def("__call__", &Likelihood::operator(), py::arg("values"));
  module.def("fit", &Fit, py::arg("records"), py::arg("request"));
}

}  // namespace mindahl::python
