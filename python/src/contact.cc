#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "bindings.h"
#include "mindahl/contact/plausibility.h"
#include "mindahl/convert/conversion.h"
#include "mindahl/convert/parameters.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/request/contact_parameters.h"
#include "mindahl/request/one_of.h"

namespace mindahl::python {

namespace py = pybind11;
using convert::Conversion;
using convert::ConversionOptions;
using convert::LoopError;

namespace {

/// JSON has no number for what is not finite.
py::object NumberOrNone(double value) {
  if (!std::isfinite(value)) return py::none();
  return py::float_(value);
}

py::dict Contact(const request::ContactOptions& options) {
  Validate(options);
  py::dict result;
  result["schema"] = "mindahl.contact/1";
  result["version"] = std::string(Version());
  result["compliance_definition"] = request::kComplianceDefinition;
  result["compliance_unit"] = request::kComplianceUnit;
  for (const request::ContactQuantity& quantity : ResolveContact(options).quantities) {
    const py::str section(quantity.section);
    if (!result.contains(section)) result[section] = py::dict();
    py::dict value;
    value["value"] = NumberOrNone(quantity.value.value);
    value["standard_error"] = NumberOrNone(quantity.value.standard_error);
    value["unit"] = quantity.unit;
    result[section][py::str(quantity.name)] = value;
  }
  return result;
}

std::vector<std::string> DoubtsAbout(const request::ContactOptions& options) {
  std::optional<double> friction;
  if (options.friction_coefficient) friction = options.friction_coefficient->value;
  return contact::DoubtsAbout(options.known, friction);
}

py::dict DictOf(const LoopError& error) {
  py::dict result;
  result["force"] = NumberOrNone(error.force);
  result["energy"] = NumberOrNone(error.energy);
  return result;
}

py::object PairOrNone(const std::optional<convert::AmplitudeRange>& range) {
  if (!range) return py::none();
  py::list pair;
  pair.append(range->lower);
  pair.append(range->upper);
  return pair;
}

/// @returns what `mindahl convert --json` writes, and the lines that the target reads
std::pair<py::dict, py::object> Convert(const models::BranchLaw& law, const std::string& from,
                                        const std::string& to, const ConversionOptions& options,
                                        const convert::NormalContact& normal) {
  std::vector<std::string_view> names;
  for (const convert::TargetRow& target : convert::Targets()) names.push_back(target.name);
  request::RequireOneOf("--to", to, names);
  request::RequireOneOf("--from", from, std::array<std::string_view, 2>{"masing", "dahl"});
  const auto row = std::ranges::find(convert::Targets(), to, &convert::TargetRow::name);
  Validate(normal, row->target);
  const Conversion conversion =
      convert::Convert({models::FindFrictionModel(from == "dahl" ? "dahl" : "mindlin-dahl"), law},
                       row->target, options);
  py::dict result;
  result["schema"] = "mindahl.convert/1";
  result["version"] = std::string(Version());
  py::dict contact;
  contact["law"] = from;
  contact["sigma"] = law.tangential_stiffness;
  contact["alpha"] = law.shape_exponent;
  contact["slip_force"] = law.slip_force;
  result["from"] = contact;
  result["to"] = to;
  result["amplitude"] = options.amplitude;
  result["range"] = PairOrNone(options.range);
  result["tolerance"] = options.tolerance;
  py::dict parameters;
  for (const convert::Parameter& parameter :
       convert::ParametersOf(conversion, row->target, normal)) {
    py::dict value;
    value["value"] = NumberOrNone(parameter.value);
    value["unit"] = parameter.unit;
    parameters[py::str(parameter.name)] = value;
  }
  result["parameters"] = parameters;
  py::list elements;
  if (const auto* iwan = std::get_if<methods::IwanElements>(&conversion.law)) {
    for (std::size_t j = 0; j < iwan->size(); ++j) {
      py::dict element;
      element["stiffness"] = iwan->stiffness[j];
      element["slip_force"] = iwan->slip_force[j];
      elements.append(element);
    }
  }
  result["elements"] = elements;
  result["error_at_amplitude"] = DictOf(conversion.at_amplitude);
  result["largest_error"] = DictOf(conversion.largest);
  result["within"] = PairOrNone(conversion.within);
  py::object lines = py::none();
  if (!IsDiscreteElementCode(row->target) || normal.normal_load) {
    lines = py::cast(convert::InputLines(conversion, row->target, normal));
  }
  return {result, lines};
}

}  // namespace

void AddContact(py::module_& module) {
  module.def("contact", &Contact, py::arg("options"));
  module.def("doubts_about", &DoubtsAbout, py::arg("options"));
  module.def(
      "convert",
      [](double sigma, double alpha, double slip_force, double amplitude, const std::string& from,
         const std::string& to, const std::optional<std::pair<double, double>>& range,
         double tolerance, std::size_t elements, double beta, std::optional<double> normal_load,
         std::optional<double> contact_radius, double viscous) {
        ConversionOptions options{
            .amplitude = amplitude, .tolerance = tolerance, .elements = elements, .beta = beta};
        if (range) options.range = convert::AmplitudeRange{range->first, range->second};
        return Convert(
            {.tangential_stiffness = sigma, .shape_exponent = alpha, .slip_force = slip_force},
            from, to, options,
            {.normal_load = normal_load, .contact_radius = contact_radius, .viscous = viscous});
      },
      py::kw_only(), py::arg("sigma"), py::arg("alpha"), py::arg("slip_force"),
      py::arg("amplitude"), py::arg("from_law"), py::arg("to"), py::arg("range"),
      py::arg("tolerance"), py::arg("elements"), py::arg("beta"), py::arg("normal_load"),
      py::arg("contact_radius"), py::arg("viscous"));
}

}  // namespace mindahl::python
