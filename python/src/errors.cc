#include <algorithm>
#include <exception>
#include <regex>
#include <string>

#include "bindings.h"
#include "mindahl/core/error.h"

namespace mindahl::python {

namespace py = pybind11;

std::string WithKeywords(const std::string& message) {
  // "--rig-stiffness 3" is "rig_stiffness=3".
  static const std::regex option("(^|[^A-Za-z0-9])--([A-Za-z0-9]+(-[A-Za-z0-9]+)*)( (?=[0-9]))?");
  std::string text;
  auto rest = message.begin();
  for (std::sregex_iterator found(message.begin(), message.end(), option);
       found != std::sregex_iterator(); ++found) {
    std::string word = found->str(2);
    std::ranges::replace(word, '-', '_');
    if (word == "from" || word == "with" || word == "lambda") word += '_';  // words of Python
    text.append(rest, (*found)[0].first);
    text += found->str(1) + word + ((*found)[4].matched ? "=" : "");
    rest = (*found)[0].second;
  }
  return text.append(rest, message.end());
}

void AddErrors(py::module_& module) {
  // Never given back: it is used until the interpreter is gone.
  static PyObject* const input_error =
      py::exception<InputError>(module, "InputError", PyExc_ValueError).release().ptr();
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      PyErr_SetString(input_error, WithKeywords(error.what()).c_str());
    } catch (const InvalidArgument& error) {
      PyErr_SetString(PyExc_ValueError, WithKeywords(error.what()).c_str());
    } catch (const Interrupted&) {  // NOLINT(bugprone-empty-catch): KeyboardInterrupt is set
    } catch (const std::logic_error& error) {
      PyErr_SetString(PyExc_RuntimeError, error.what());
    }
  });
  module.def("with_keywords", &WithKeywords, py::arg("message"));
}

}  // namespace mindahl::python
