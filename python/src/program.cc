#include <pybind11/stl.h>

#include <iostream>
#include <string>
#include <vector>

#include "bindings.h"
#include "cli/app.h"
#include "mindahl/io/output_file.h"

namespace mindahl::python {

namespace py = pybind11;

namespace {

/// Runs the command line as the program does, and returns its exit status.
int RunProgram(const std::vector<std::string>& words) {
  const py::gil_scoped_release others_may_run;
  std::vector<const char*> arguments;
  arguments.reserve(words.size());
  for (const std::string& word : words) arguments.push_back(word.c_str());
  io::RemoveTemporaryFilesOnSignals();
  const int status =
      cli::Run(static_cast<int>(arguments.size()), arguments.data(), std::cout, std::cerr);
  io::RaiseNotedSignal();
  return status;
}

}  // namespace

void AddProgram(py::module_& module) {
  module.def("run_program", &RunProgram, py::arg("words"));
}

}  // namespace mindahl::python
