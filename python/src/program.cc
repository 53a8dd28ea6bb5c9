#include <pybind11/stl.h>

#include <algorithm>
#include <iostream>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "bindings.h"
#include "cli/app.h"
#include "mindahl/request/batch.h"
#include "mindahl/request/fit_request.h"

namespace mindahl::python {

namespace py = pybind11;
using request::BatchEntry;
using request::Strictness;

namespace {

int Run(const std::vector<std::string>& words, std::ostream& out, std::ostream& err) {
  std::vector<const char*> arguments;
  arguments.reserve(words.size());
  for (const std::string& word : words) arguments.push_back(word.c_str());
  return cli::Run(static_cast<int>(arguments.size()), arguments.data(), out, err);
}

/// Runs the command line as the program does, and returns its exit status.
int RunProgram(const std::vector<std::string>& words) {
  const py::gil_scoped_release others_may_run;
  return Run(words, std::cout, std::cerr);
}

/// Returns the exit status, and what the program writes to its two streams.
py::tuple RunCommand(const std::vector<std::string>& words) {
  std::ostringstream out;
  std::ostringstream err;
  int status = 0;
  {
    const Running running;
    status = Run(words, out, err);
  }
  return py::make_tuple(status, out.str(), err.str());
}

/// Returns the state of a source of a batch, which other processes give back: name, fault, done,
/// notes and JSON of the fit, and stated errors by parameter.
py::tuple StateOf(const BatchEntry& entry) {
  return py::make_tuple(entry.file, entry.fault, entry.done(), entry.notes, entry.fit,
                        entry.errors);
}

std::vector<BatchEntry> EntriesOf(const std::vector<py::tuple>& states) {
  std::vector<BatchEntry> entries;
  for (const py::tuple& state : states) {
    BatchEntry& entry = entries.emplace_back();
    entry.file = state[0].cast<std::string>();
    entry.fault = state[1].cast<std::string>();
    entry.notes = state[3].cast<std::vector<std::string>>();
    entry.fit = state[4].cast<std::string>();
    entry.errors = state[5].cast<std::map<std::string, double>>();
  }
  return entries;
}

/// @param stops  asked now and then whether the fit is to end; None: never
py::tuple FitOne(const RecordFile& record, const request::FitRequest& request, int strict,
                 const py::object& stops) {
  BatchEntry entry;
  {
    const py::gil_scoped_release others_may_run;
    const Interruptible asked([&stops] {
      const py::gil_scoped_acquire own;
      if (stops.is_none() || !stops().cast<bool>()) return;
      PyErr_SetNone(PyExc_KeyboardInterrupt);
      throw Interrupted();
    });
    entry = request::FitSource(record.name, Strictness{strict},
                               [&] { return request::FitRecords(request, {record}); });
  }
  return StateOf(entry);
}

/// The rows of the table, the table, JSON and text of a batch, and whether all is done.
py::tuple BatchOf(const std::vector<py::tuple>& states) {
  const std::vector<BatchEntry> entries = EntriesOf(states);
  const request::BatchAnswer answer = request::AnswerOf(entries);
  return py::make_tuple(answer.rows, answer.table, answer.json, answer.text,
                        std::ranges::all_of(entries, &BatchEntry::done));
}

}  // namespace

void AddProgram(py::module_& module) {
  module.def("run_program", &RunProgram, py::arg("words"));
  module.def("run_command", &RunCommand, py::arg("words"));
  module.def("fit_one", &FitOne, py::arg("record"), py::arg("request"), py::arg("strict"),
             py::arg("stops"));
  module.def("batch", &BatchOf, py::arg("entries"));
}

}  // namespace mindahl::python
