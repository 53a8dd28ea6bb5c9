#include "bindings.h"
#include "mindahl/core/version.h"

PYBIND11_MODULE(_mindahl, module) {
  module.doc() = "mindahl's library; import mindahl is the interface to it";
  module.attr("__version__") = std::string(mindahl::Version());
  mindahl::python::AddErrors(module);
  mindahl::python::AddRecords(module);
  mindahl::python::AddFit(module);
  mindahl::python::AddModels(module);
  mindahl::python::AddProgram(module);
}
