#include <pybind11/stl.h>

#include <cstdint>
#include <optional>
#include <utility>

#include "bindings.h"
#include "mindahl/core/memory.h"
#include "mindahl/io/csv_table.h"
#include "record.h"

namespace mindahl::python {

namespace py = pybind11;
using io::RecordColumns;

std::vector<io::NamedColumn> ColumnsOfArrays(const std::vector<std::string>& names,
                                             const std::vector<Array>& arrays) {
  std::vector<io::NamedColumn> table;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const std::span<const double> values = SpanOf(arrays.at(k), names[k].c_str());
    table.push_back({names[k], {values.begin(), values.end()}});
  }
  return table;
}

namespace {

NamedRecord ReadCsv(const std::string& path, const RecordColumns& columns,
                    std::optional<std::uint64_t> max_memory) {
  const py::gil_scoped_release others_may_run;
  io::ReadLimits limits;
  limits.memory = max_memory.value_or(MemoryOfProcess());
  return {path, io::ReadRecord(path, columns, limits)};
}

NamedRecord RecordOfColumns(const std::string& name, const std::vector<std::string>& names,
                            const std::vector<Array>& arrays, const RecordColumns& columns) {
  return {name, io::RecordOf(io::TableOfColumns(ColumnsOfArrays(names, arrays), name), columns)};
}

py::object ViewUnlessEmpty(const py::object& self, const std::vector<double>& values) {
  if (values.empty()) return py::none();
  return ViewOf(values, self);
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
  return ViewUnlessEmpty(self, self.cast<const NamedRecord&>().file.record.*kColumn);
}

}  // namespace

void AddRecords(py::module_& module) {
  py::class_<RecordColumns>(module, "RecordColumns")
      .def(py::init([](std::string displacement, std::string force, std::string time,
                       std::string normal_load, std::vector<std::string> covariates,
                       std::string encoding) {
             return RecordColumns{.displacement = std::move(displacement),
                                  .force = std::move(force),
                                  .time = std::move(time),
                                  .normal_load = std::move(normal_load),
                                  .covariates = std::move(covariates),
                                  .encoding = std::move(encoding)};
           }),
           py::arg("displacement"), py::arg("force"), py::arg("time"), py::arg("normal_load"),
           py::arg("covariates"), py::arg("encoding") = "")
      .def_readwrite("sample_rate", &RecordColumns::sample_rate)
      .def_readwrite("with_file", &RecordColumns::with)
      .def_readwrite("skip_broken_rows", &RecordColumns::skip_broken_rows);
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
  module.def("read_csv", &ReadCsv, py::arg("path"), py::arg("columns"),
             py::arg("max_memory") = py::none());
  module.def("record_of_columns", &RecordOfColumns, py::arg("name"), py::arg("names"),
             py::arg("arrays"), py::arg("columns"));
}

}  // namespace mindahl::python
