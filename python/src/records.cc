#include <pybind11/stl.h>

#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.h"
#include "mindahl/core/memory.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/loop/record.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::python {

namespace py = pybind11;

namespace {

/// Returns which columns the options of a fit choose.
io::RecordColumns ColumnsOf(const request::FitRequest& request) {
  io::RecordColumns columns = request.columns;
  columns.covariates = request::MakeFitOptions(request).covariates;
  return columns;
}

NamedRecord ReadCsv(const std::string& path, const request::FitRequest& request) {
  const py::gil_scoped_release others_may_run;
  const std::uintmax_t memory = request.max_memory.value_or(MemoryOfProcess());
  return {path, io::ReadRecord(path, ColumnsOf(request), {.memory = memory})};
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
    columns[role] = py::dict(py::arg("name") = column->name, py::arg("index") = column->index,
                             py::arg("unit") = column->unit);
  };
  add("displacement", record.file.displacement);
  add("force", record.file.force);
  add("time", record.file.time);
  add("normal_load", record.file.normal_load);
  return columns;
}

using Chosen = std::tuple<std::string, std::size_t, std::string>;

std::optional<Chosen> TupleOf(const std::optional<io::ChosenColumn>& column) {
  if (!column) return std::nullopt;
  return Chosen{column->name, column->index, column->unit};
}

std::optional<io::ChosenColumn> ColumnOf(const std::optional<Chosen>& column) {
  if (!column) return std::nullopt;
  const auto& [name, index, unit] = *column;
  return io::ChosenColumn{name, index, unit};
}

Array CopyOf(const std::vector<double>& values) {
  return Array(static_cast<py::ssize_t>(values.size()), values.data());
}

std::vector<double> ValuesOf(const py::handle& array) {
  const auto values = array.cast<Array>();
  return {values.data(), values.data() + values.size()};
}

/// Returns the state of a record, for pickle and copy.
py::tuple PickledRecord(const NamedRecord& record) {
  const io::RecordFile& file = record.file;
  py::list values;
  for (const auto column : loop::kRecordColumns) values.append(CopyOf(file.record.*column));
  py::list others;
  for (const loop::Covariate& other : file.record.covariates) {
    others.append(py::make_tuple(other.name, other.unit, CopyOf(other.values)));
  }
  std::vector<std::optional<Chosen>> columns = {TupleOf(file.displacement), TupleOf(file.force),
                                                TupleOf(file.time), TupleOf(file.normal_load)};
  for (const io::ChosenColumn& column : file.covariates) columns.push_back(TupleOf(column));
  return py::make_tuple(record.name, file.is_torsional, values, others, columns, file.lines,
                        file.notes);
}

NamedRecord UnpickledRecord(const py::tuple& state) {
  NamedRecord made{state[0].cast<std::string>(), {}};
  io::RecordFile& file = made.file;
  file.is_torsional = state[1].cast<bool>();
  for (std::size_t k = 0; k < loop::kRecordColumns.size(); ++k) {
    file.record.*loop::kRecordColumns[k] = ValuesOf(state[2].cast<py::list>()[k]);
  }
  for (const py::handle other : state[3]) {
    const auto [name, unit, values] =
        other.cast<std::tuple<std::string, std::string, py::object>>();
    file.record.covariates.push_back({name, unit, ValuesOf(values)});
  }
  const auto columns = state[4].cast<std::vector<std::optional<Chosen>>>();
  file.displacement = ColumnOf(columns.at(0)).value();
  file.force = ColumnOf(columns.at(1)).value();
  file.time = ColumnOf(columns.at(2));
  file.normal_load = ColumnOf(columns.at(3));
  for (std::size_t k = 4; k < columns.size(); ++k) {
    file.covariates.push_back(ColumnOf(columns[k]).value());
  }
  file.lines = state[5].cast<std::vector<std::size_t>>();
  file.notes = state[6].cast<std::vector<std::string>>();
  return made;
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
      .def("__len__", [](const NamedRecord& record) { return record.file.record.size(); })
      .def(py::pickle(&PickledRecord, &UnpickledRecord));
  module.def("read_csv", &ReadCsv, py::arg("path"), py::arg("request"));
  module.def("record_of_columns", &RecordOfColumns, py::arg("name"), py::arg("names"),
             py::arg("arrays"), py::arg("request"));
}

}  // namespace mindahl::python
