#include <pybind11/stl.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bindings.h"
#include "mindahl/core/memory.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::python {

namespace py = pybind11;

namespace {

/// Returns which columns the options of a fit choose.
io::RecordColumns ColumnsOf(const request::FitRequest& request) {
  io::RecordColumns columns = request.columns;
  columns.covariates = request::CovariateColumns(request);
  return columns;
}

NamedRecord ReadCsv(const std::string& path, const request::FitRequest& request) {
  const py::gil_scoped_release others_may_run;
  io::ReadLimits limits;
  limits.memory = request.max_memory.value_or(MemoryOfProcess());
  return {path, io::ReadRecord(path, ColumnsOf(request), limits)};
}

NamedRecord RecordOfColumns(const std::string& name, const std::vector<std::string>& names,
                            const std::vector<Array>& arrays, const request::FitRequest& request) {
  std::vector<io::NamedColumn> table;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::span<const double> values = SpanOf(arrays.at(k), names[k].c_str());
    table.push_back({names[k], {values.begin(), values.end()}});
  }
  return {name, io::RecordOf(io::TableOfColumns(std::move(table), name), ColumnsOf(request))};
}

py::dict CovariatesOf(const py::object& self) {
  py::dict columns;
  for (const loop::Covariate& covariate : self.cast<const NamedRecord&>().file.record.covariates) {
    columns[py::str(covariate.name)] = ViewOf(covariate.values, self);
  }
  return columns;
}

py::dict ColumnsUsed(const NamedRecord& record) {
  py::dict columns;
  const auto add = [&](const char* role, const std::optional<io::ChosenColumn>& column) {
    if (!column) return;
    py::dict described;
    described["name"] = column->name;
    described["index"] = column->index;
    described["unit"] = column->unit;
    columns[role] = described;
  };
  add("displacement", record.file.displacement);
  add("force", record.file.force);
  add("time", record.file.time);
  add("normal_load", record.file.normal_load);
  return columns;
}

template <auto kColumn>
py::object RecordColumn(const py::object& self) {
  return ViewOf(self.cast<const NamedRecord&>().file.record.*kColumn, self);
}

}  // namespace

void AddRecords(py::module_& module) {
  py::class_<NamedRecord>(module, "Record",
                          "A hysteresis record in SI units, as it was read; arrays are read-only.")
      .def_readonly("name", &NamedRecord::name, "what messages and reports call it")
      .def_property_readonly("displacement", &RecordColumn<&loop::Record::displacement>,
                             "[m]; of a torsional record the angle [rad]")
      .def_property_readonly("force", &RecordColumn<&loop::Record::force>,
                             "[N]; of a torsional record the torque [N m]")
      .def_property_readonly("time", &RecordColumn<&loop::Record::time>, "[s], or None")
      .def_property_readonly("normal_load", &RecordColumn<&loop::Record::normal_load>,
                             "[N], or None")
      .def_property_readonly("covariates", &CovariatesOf,
                             "other columns by name, in units of their own")
      .def_property_readonly("columns", &ColumnsUsed,
                             "which column each quantity was read from: name, index, unit")
      .def_property_readonly(
          "is_torsional", [](const NamedRecord& record) { return record.file.is_torsional; },
          "a torque against an angle?")
      .def_property_readonly(
          "notes", [](const NamedRecord& record) { return record.file.notes; },
          "what was assumed, one sentence each")
      .def("__len__", [](const NamedRecord& record) { return record.file.record.size(); });
  module.def("read_csv", &ReadCsv, py::arg("path"), py::arg("request"));
  module.def("record_of_columns", &RecordOfColumns, py::arg("name"), py::arg("names"),
             py::arg("arrays"), py::arg("request"));
}

}  // namespace mindahl::python
