#include <pybind11/stl.h>

#include <array>
#include <boost/algorithm/string/replace.hpp>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "bindings.h"
#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/loop/record.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::python {

namespace py = pybind11;
using namespace py::literals;  // NOLINT(google-build-using-namespace)

py::object ViewOf(const std::vector<double>& values, const py::handle& owner) {
  if (values.empty()) return py::none();
  py::array_t<double> view({static_cast<py::ssize_t>(values.size())}, values.data(), owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

namespace {

/// Returns which columns the options of a fit choose.
io::RecordColumns ColumnsOf(const request::FitRequest& request) {
  io::RecordColumns columns = request.columns;
  columns.covariates = request::MakeFitOptions(request).covariates;
  return columns;
}

/// @param name  what the record, its notes and messages call the file
RecordFile ReadCsv(const std::string& path, const request::FitRequest& request,
                   const std::string& name) {
  const py::gil_scoped_release others_may_run;
  const auto named = [&](const std::string& text) {
    return boost::replace_all_copy(text, path, name);
  };
  try {
    RecordFile record = io::ReadRecord(path, ColumnsOf(request));
    record.name = name;
    for (std::string& note : record.notes) note = named(note);
    return record;
  } catch (const InputError& error) {
    throw InputError(named(error.what()));
  }
}

RecordFile RecordOfColumns(const std::string& name, const std::vector<std::string>& names,
                           const std::vector<Array>& arrays, const request::FitRequest& request) {
  std::vector<io::CsvColumn> columns;
  for (std::size_t k = 0; k < names.size(); ++k) {
    columns.push_back({names[k], SpanOf(arrays.at(k))});
  }
  return io::RecordOf(columns, name, ColumnsOf(request));
}

py::dict CovariatesOf(const py::object& self) {
  py::dict columns;
  for (const loop::Covariate& covariate : self.cast<const RecordFile&>().record.covariates) {
    columns[py::str(covariate.name)] = ViewOf(covariate.values, self);
  }
  return columns;
}

constexpr std::array kRoles = {
    std::pair("displacement", &RecordFile::displacement), std::pair("force", &RecordFile::force),
    std::pair("time", &RecordFile::time), std::pair("normal_load", &RecordFile::normal_load)};

py::dict ColumnsUsed(const RecordFile& file) {
  py::dict columns;
  for (const auto& [role, member] : kRoles) {
    const io::ChosenColumn& column = file.*member;
    if (!column) continue;
    columns[role] =
        py::dict("name"_a = column.name, "index"_a = column.index, "unit"_a = column.unit);
  }
  return columns;
}

Array CopyOf(const std::vector<double>& values) {
  return Array(static_cast<py::ssize_t>(values.size()), values.data());
}

std::vector<double> ValuesOf(const py::handle& array) {
  const auto values = array.cast<Array>();
  return {values.data(), values.data() + values.size()};
}

/// Returns the state of a record, for pickle and copy.
py::tuple PickledRecord(const RecordFile& file) {
  py::list values;
  for (const auto column : loop::kRecordColumns) values.append(CopyOf(file.record.*column));
  py::list others;
  for (const loop::Covariate& other : file.record.covariates) {
    others.append(py::make_tuple(other.name, other.unit, CopyOf(other.values)));
  }
  py::list columns;
  for (const auto& [role, member] : kRoles) {
    const io::ChosenColumn& column = file.*member;
    columns.append(py::make_tuple(column.name, column.index, column.unit, column.has_no_unit));
  }
  return py::make_tuple(file.name, file.is_torsional, values, others, columns, file.lines,
                        file.notes);
}

RecordFile UnpickledRecord(const py::tuple& state) {
  RecordFile file;
  file.name = state[0].cast<std::string>();
  file.is_torsional = state[1].cast<bool>();
  for (std::size_t k = 0; k < loop::kRecordColumns.size(); ++k) {
    file.record.*loop::kRecordColumns[k] = ValuesOf(state[2].cast<py::list>()[k]);
  }
  for (const py::handle other : state[3]) {
    const auto [name, unit, values] =
        other.cast<std::tuple<std::string, std::string, py::object>>();
    file.record.covariates.push_back({name, unit, ValuesOf(values)});
  }
  for (std::size_t k = 0; k < kRoles.size(); ++k) {
    const auto [name, index, unit, has_no_unit] =
        state[4]
            .cast<py::list>()[k]
            .cast<std::tuple<std::string, std::size_t, std::string, bool>>();
    file.*kRoles[k].second = {name, index, unit, has_no_unit};
  }
  file.lines = state[5].cast<std::vector<std::size_t>>();
  file.notes = state[6].cast<std::vector<std::string>>();
  return file;
}

template <auto kColumn>
py::object RecordColumn(const py::object& self) {
  return ViewOf(self.cast<const RecordFile&>().record.*kColumn, self);
}

}  // namespace

void AddRecords(py::module_& module) {
  py::class_<RecordFile>(module, "Record",
                         "A hysteresis record in SI units, as it was read; arrays are read-only.")
      .def_readonly("name", &RecordFile::name, "what messages and reports call it")
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
          "is_torsional", [](const RecordFile& file) { return file.is_torsional; },
          "a torque against an angle?")
      .def_property_readonly(
          "notes", [](const RecordFile& file) { return file.notes; },
          "what was assumed, one sentence each")
      .def("__len__", [](const RecordFile& file) { return file.record.size(); })
      .def(py::pickle(&PickledRecord, &UnpickledRecord));
  module.def("read_csv", &ReadCsv, py::arg("path"), py::arg("request"), py::arg("name"));
  module.def("record_of_columns", &RecordOfColumns, py::arg("name"), py::arg("names"),
             py::arg("arrays"), py::arg("request"));
}

}  // namespace mindahl::python
