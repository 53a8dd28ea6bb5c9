#include <cctype>
#include <exception>

#include "bindings.h"
#include "mindahl/core/error.h"

namespace mindahl::python {

namespace py = pybind11;

std::string WithKeywords(const std::string& message) {
  const auto is_letter = [&](std::size_t i) {
    return i < message.size() && std::isalpha(static_cast<unsigned char>(message[i])) != 0;
  };
  std::string text;
  for (std::size_t i = 0; i < message.size();) {
    const bool begins_word =
        i == 0 || std::isalnum(static_cast<unsigned char>(message[i - 1])) == 0;
    if (!(begins_word && message.compare(i, 2, "--") == 0 && is_letter(i + 2))) {
      text += message[i++];
      continue;
    }
    for (i += 2; i < message.size(); ++i) {
      const char letter = message[i];
      const bool goes_on = std::isalnum(static_cast<unsigned char>(letter)) != 0 ||
                           (letter == '-' && is_letter(i + 1)) ||
                           (letter == '-' && i + 1 < message.size() &&
                            std::isdigit(static_cast<unsigned char>(message[i + 1])) != 0);
      if (!goes_on) break;
      text += letter == '-' ? '_' : letter;
    }
  }
  return text;
}

void AddErrors(py::module_& module) {
  static const py::exception<InputError> input_error(module, "InputError", PyExc_ValueError);
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const InputError& error) {
      PyErr_SetString(input_error.ptr(), WithKeywords(error.what()).c_str());
    } catch (const InvalidArgument& error) {
      PyErr_SetString(PyExc_ValueError, WithKeywords(error.what()).c_str());
    } catch (const std::logic_error& error) {
      PyErr_SetString(PyExc_RuntimeError, error.what());
    }
  });
  module.def("with_keywords", &WithKeywords, py::arg("message"));
}

}  // namespace mindahl::python
