#pragma once

#include <pybind11/pybind11.h>

#include "mindahl/request/fit_request.h"

namespace mindahl::python {

/// FitRequest with the contact that it holds.
pybind11::class_<request::FitRequest> AddRequest(pybind11::module_& module);

}  // namespace mindahl::python
