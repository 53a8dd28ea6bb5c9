#include "request.h"

#include <pybind11/stl.h>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/request/contact_request.h"

namespace mindahl::python {

namespace py = pybind11;
using contact::KnownBody;
using contact::KnownContact;
using contact::UncertainValue;
using request::ContactOptions;
using request::FitRequest;

py::class_<FitRequest> AddRequest(py::module_& module) {
  py::class_<UncertainValue>(module, "UncertainValue")
      .def(py::init<double, double>(), py::arg("value"), py::arg("standard_error") = 0.0)
      .def_readonly("value", &UncertainValue::value)
      .def_readonly("standard_error", &UncertainValue::standard_error);
  py::class_<KnownBody>(module, "KnownBody")
      .def_readwrite("youngs_modulus", &KnownBody::youngs_modulus)
      .def_readwrite("poisson", &KnownBody::poisson_ratio)
      .def_readwrite("radius", &KnownBody::radius);
  py::class_<KnownContact>(module, "KnownContact")
      .def_readwrite("normal_load", &KnownContact::normal_load)
      .def_readwrite("contact_radius", &KnownContact::contact_radius)
      .def_readwrite("compliance", &KnownContact::tangential_compliance)
      .def_readwrite("body_1", &KnownContact::body_1)
      .def_readwrite("body_2", &KnownContact::body_2);
  py::class_<ContactOptions>(module, "ContactOptions")
      .def(py::init<>())
      .def_readwrite("known", &ContactOptions::known)
      .def_readwrite("friction", &ContactOptions::friction_coefficient);
  return py::class_<FitRequest>(module, "FitRequest").def(py::init<>());
}

}  // namespace mindahl::python
