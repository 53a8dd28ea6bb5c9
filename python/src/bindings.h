#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <span>
#include <string>
#include <vector>

#include "mindahl/core/interruption.h"
#include "mindahl/io/record_reader.h"

/// The extension module _mindahl: the library's own functions with NumPy arrays for spans. What is
/// Pythonic - keywords, frames, results with attributes - is python/mindahl/*.py.
namespace mindahl::python {

using io::RecordFile;

/// float64, contiguous; what is not is converted before it comes here.
using Array = pybind11::array_t<double, pybind11::array::c_style>;

/// The numbers of an array where they are.
/// @throws std::domain_error, a ValueError, unless it has one dimension
inline std::span<const double> SpanOf(const Array& array) {
  static_cast<void>(array.unchecked<1>());
  return {array.data(), static_cast<std::size_t>(array.size())};
}

/// A read-only array of numbers where they are, which keeps their owner alive; None where there are
/// none.
pybind11::object ViewOf(const std::vector<double>& values, const pybind11::handle& owner);

/// Thrown where Ctrl-C ended a fit: Python's error is set already.
struct Interrupted {};

/// While it lives, other threads of Python run, and Ctrl-C ends the fits of this one.
class Running {
 public:
  Running() : ask_(&Ask) {}

 private:
  static void Ask() {
    const pybind11::gil_scoped_acquire own;
    if (PyErr_CheckSignals() != 0) throw Interrupted();
  }

  pybind11::gil_scoped_release others_may_run_;
  Interruptible ask_;
};

/// The command line's option names as Python has them: "--rig-stiffness" is "rig_stiffness".
std::string WithKeywords(const std::string& message);

void AddErrors(pybind11::module_& module);
void AddRecords(pybind11::module_& module);
void AddFit(pybind11::module_& module);
void AddModels(pybind11::module_& module);
void AddProgram(pybind11::module_& module);

}  // namespace mindahl::python
