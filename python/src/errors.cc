#include <cctype>
#include <exception>

#include "bindings.h"
#include "mindahl/core/error.h"

namespace mindahl::python {

namespace py = pybind11;

std::string WithKeywords(const std::string& message) {
  const auto is_alphanumeric = [&](std::size_t i) {
    return i < message.size() && std::isalnum(static_cast<unsigned char>(message[i])) != 0;
  };
  std::string text;
  std::size_t i = 0;
  while (i < message.size()) {
    const bool is_option = message.compare(i, 2, "--") == 0 && is_alphanumeric(i + 2) &&
                           (i == 0 || !is_alphanumeric(i - 1));
    if (!is_option) {
      text += message[i++];
      continue;
    }
    std::string word;
    for (i += 2;
         is_alphanumeric(i) || (i < message.size() && message[i] == '-' && is_alphanumeric(i + 1));
         ++i) {
      word += message[i] == '-' ? '_' : message[i];
    }
    text += word;
    if (word == "from" || word == "with" || word == "lambda") text += '_';  // words of Python
    const bool has_number = i + 1 < message.size() && message[i] == ' ' &&
                            std::isdigit(static_cast<unsigned char>(message[i + 1])) != 0;
    if (has_number) {
      text += '=';
      ++i;
    }
  }
  return text;
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
