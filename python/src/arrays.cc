#include <fmt/format.h>

#include "bindings.h"
#include "mindahl/core/error.h"

namespace mindahl::python {

namespace py = pybind11;

std::span<const double> SpanOf(const Array& array, const char* what) {
  if (array.ndim() != 1) {
    throw InvalidArgument(fmt::format("{} has {} dimensions: must have one", what, array.ndim()));
  }
  return {array.data(), static_cast<std::size_t>(array.size())};
}

py::object ViewOf(const std::vector<double>& values, const py::handle& owner) {
  if (values.empty()) return py::none();
  py::array_t<double> view({static_cast<py::ssize_t>(values.size())}, values.data(), owner);
  view.attr("setflags")(py::arg("write") = false);
  return view;
}

}  // namespace mindahl::python
