#include <fmt/format.h>
#include <pybind11/stl.h>

#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bindings.h"
#include "core/refuse.h"
#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/loop/reversals.h"
#include "mindahl/models/contact_state.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/joint_friction.h"
#include "mindahl/models/loading_path.h"
#include "mindahl/models/response.h"
#include "mindahl/models/simplified_law.h"
#include "mindahl/request/contact_request.h"

namespace mindahl::python {

namespace py = pybind11;
using models::BranchLaw;
using models::ContactState;
using models::FrictionModel;

namespace {

const FrictionModel& RequireModel(const std::string& name) {
  if (const FrictionModel* model = models::FindFrictionModel(name)) return *model;
  Refuse("--model: {}",
         UnknownAmong(name, NamesOf(models::FrictionModels(), &FrictionModel::name)));
}

/// The law as the model uses it, whose own α, or 1/3, it has where there is none.
BranchLaw LawOf(const FrictionModel& model, double sigma, std::optional<double> alpha,
                double slip_force) {
  return request::ResolveLaw({.sigma = sigma, .alpha = alpha, .slip_force = slip_force}, model.name,
                             model.shape_exponent);
}

models::SeriesSpring RigOf(std::optional<double> stiffness) {
  if (!stiffness) return {};
  return {.stiffness = *stiffness};
}

py::array_t<double> Simulate(const Array& displacement, double sigma, double slip_force,
                             std::optional<double> alpha, const std::string& model_name,
                             std::optional<double> rig_stiffness, double asymmetry, double gate,
                             bool is_steady) {
  const bool is_simplified = model_name == models::kSimplifiedDahl;
  const FrictionModel& model = RequireModel(is_simplified ? "dahl" : model_name);
  const BranchLaw law = LawOf(model, sigma, alpha, slip_force);
  const std::span<const double> samples = SpanOf(displacement);
  py::array_t<double> force(displacement.size());
  const std::span<double> written(force.mutable_data(), samples.size());
  if (is_simplified) {
    if (rig_stiffness || asymmetry != 0) {
      throw InputError(fmt::format(
          "--model {} takes no rig and no asymmetry: leave these out, or use another model",
          model_name));
    }
    models::EvaluateSimplifiedDahl(law, samples, {}, written);
    return force;
  }
  const bool is_joint = model.memory == models::Memory::kNone && asymmetry != 0;
  if (is_joint && rig_stiffness) throw InputError("--rig-stiffness is refused beside an asymmetry");
  if (!(std::abs(asymmetry) < 1)) ThrowInvalid("asymmetry [-]", asymmetry, "must be in (-1, 1)");
  const py::gil_scoped_release others_may_run;
  const models::LoadingPath path = models::MakeLoadingPath(
      samples, loop::FindReversals(samples, gate), model.memory,
      {.state = is_steady ? models::InitialState::kSteady : models::InitialState::kVirgin,
       .asymmetry = is_joint ? 0.0 : asymmetry});
  models::EvaluateForce(model, law, path, samples, written, RigOf(rig_stiffness));
  if (!is_joint) return force;
  for (double& each : written) {
    each = law.slip_force * models::JointForce(each / law.slip_force, 1.0, asymmetry);
  }
  return force;
}

ContactState MakeState(double sigma, double slip_force, std::optional<double> alpha,
                       const std::string& model_name, double unloaded_displacement,
                       std::optional<double> rig_stiffness) {
  const FrictionModel& model = RequireModel(model_name);
  return {model,
          LawOf(model, sigma, alpha, slip_force),
          {.unloaded_displacement = unloaded_displacement, .rig = RigOf(rig_stiffness)}};
}

ContactState CopyOf(const ContactState& state, const py::args& /*memo*/) { return state; }

}  // namespace

void AddModels(py::module_& module) {
  module.def("simulate", &Simulate, py::arg("displacement"), py::kw_only(), py::arg("sigma"),
             py::arg("slip_force"), py::arg("alpha") = py::none(), py::arg("model"),
             py::arg("rig_stiffness") = py::none(), py::arg("asymmetry") = 0.0,
             py::arg("gate") = 0.0, py::arg("steady") = false);
  py::class_<ContactState>(module, "ContactState",
                           R"(A contact that is moved step by step.

Exact for a motion that does not turn within a step, however long the step; no time enters.

sigma: tangential stiffness [N/m] at the start of a branch, > 0.
slip_force: Tc [N], > 0.
alpha: shape exponent [-]; by default the model's own, or 1/3.
model: "mindlin-dahl", "mindlin", "dahl" or "jenkins".
unloaded_displacement: [m], where the force is 0 before any motion.
rig_stiffness: of a spring [N/m] in series, by default rigid.
Raises ValueError naming the quantity, its value and the rule.)")
      .def(py::init(&MakeState), py::kw_only(), py::arg("sigma"), py::arg("slip_force"),
           py::arg("alpha") = py::none(), py::arg("model") = "mindlin-dahl",
           py::arg("unloaded_displacement") = 0.0, py::arg("rig_stiffness") = py::none())
      .def("move", &ContactState::Move, py::arg("displacement"),
           "Moves on to a displacement [m] and returns the force [N] there.")
      .def("peek", &ContactState::Peek, py::arg("displacement"),
           "The force [N] that move() would return, without moving.")
      .def("reset", &ContactState::Reset, "Back to the virgin contact.")
      .def_property_readonly("force", py::overload_cast<>(&ContactState::Force, py::const_),
                             "[N] at the present displacement")
      .def_property_readonly("displacement", &ContactState::Displacement, "[m]")
      .def_property_readonly("tangent_stiffness", &ContactState::TangentStiffness,
                             "dT/dδ [N/m] onward in the direction of the last motion")
      .def("__copy__", &CopyOf)
      .def("__deepcopy__", &CopyOf);
}

}  // namespace mindahl::python
