#include <pybind11/stl.h>

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "bindings.h"
#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/request/batch.h"
#include "mindahl/request/contact_request.h"
#include "mindahl/request/conversion.h"
#include "mindahl/request/plan.h"
#include "mindahl/request/sweep.h"
#include "mindahl/request/tradeoff.h"
#include "mindahl/request/validation.h"
#include "record.h"

namespace mindahl::python {

namespace py = pybind11;
using request::BatchEntry;
using request::ConversionRequest;
using request::LawRequest;
using request::PlanRequest;
using request::Strictness;
using request::ToJson;
using request::ToText;

namespace {

/// The answer of a command: what it writes as JSON and what it prints.
struct Answer {
  std::string json;
  std::string text;
  bool established = true;  // its exit status is 0
  std::vector<std::string> warnings;
};

/// Calls a function of the library, which other threads need not wait for.
/// @param ask  is given what takes warnings
template <typename Ask>
Answer AnswerOf(Ask ask) {
  const Running running;
  Answer answer;
  const auto made = ask([&](std::string_view warning) { answer.warnings.emplace_back(warning); });
  answer.json = ToJson(made);
  answer.text = ToText(made);
  if constexpr (requires { made.established(); }) answer.established = made.established();
  return answer;
}

std::vector<double> VectorOf(const Array& array) {
  const std::span<const double> samples = SpanOf(array, "displacement");
  return {samples.begin(), samples.end()};
}

Answer Contact(const request::ContactOptions& options) {
  Validate(options);
  return AnswerOf([&](const request::Tell& warn) {
    const request::ContactParameters contact = ResolveContact(options);
    for (const std::string& doubt : DoubtsAbout(options)) warn(doubt);
    return contact;
  });
}

/// Returns the answer, and the lines that the target reads, if it can have any.
std::pair<Answer, std::optional<std::vector<std::string>>> Convert(
    const ConversionRequest& request) {
  std::optional<std::vector<std::string>> lines;
  Answer answer = AnswerOf([&](const request::Tell&) {
    request::ConvertedContact converted = MakeConversion(request);
    if (!converted.target.Uses("mu") || request.normal.normal_load) {
      lines = InputLines(converted);
    }
    return converted;
  });
  return {std::move(answer), std::move(lines)};
}

Answer Plan(PlanRequest request, const std::string& initial_state,
            const std::optional<NamedRecord>& record) {
  RequireOneOf("--initial-state", initial_state,
               std::array<std::string_view, 3>{"virgin", "steady", "both"});
  if (initial_state == "virgin") request.initial_state = models::InitialState::kVirgin;
  if (initial_state == "steady") request.initial_state = models::InitialState::kSteady;
  if (record) {
    request.record = [&] { return record->file; };
    request.record_name = record->name;
  }
  return AnswerOf([&](const request::Tell& warn) { return MakePlan(request, warn); });
}

void SetWanted(PlanRequest& request, const std::string& name, double value, bool is_relative) {
  request.wanted[name] = {.value = value, .is_relative = is_relative};
}

Answer Tradeoff(const LawRequest& law, const std::vector<std::string>& excitations,
                const Array& array, const std::string& path_name, double tolerance) {
  const std::vector<double> displacement = VectorOf(array);
  for (const std::string& name : excitations) {
    RequireOneOf("--excitation", name, request::ExcitationNames());
  }
  return AnswerOf([&](const request::Tell& warn) {
    return request::MakeTradeoff({.law = law,
                                  .excitations = excitations,
                                  .displacement = displacement,
                                  .path_name = path_name,
                                  .tolerance = tolerance},
                                 warn);
  });
}

Answer Validate(std::size_t cases, std::uint64_t seed) {
  return AnswerOf([&](const request::Tell&) {
    request::Validation validation;
    validation.options.cases = cases;
    validation.options.seed = seed;
    validation.report = identification::ValidateMapping(validation.options);
    return validation;
  });
}

/// @param table  names and values of the columns; empty: the request's file is read
Answer Sweep(const request::FitRequest& request, const std::string& kind, const std::string& name,
             const std::vector<std::string>& names, const std::vector<Array>& arrays,
             const std::string& response, std::optional<double> response_noise) {
  std::vector<io::NamedColumn> table = ColumnsOfArrays(names, arrays);
  bool converged = false;
  Answer answer = AnswerOf([&](const request::Tell& note) {
    io::SweepFile sweep = table.empty() ? io::ReadSweep(name, request.columns, response)
                                        : io::SweepOf(io::TableOfColumns(std::move(table), name),
                                                      request.columns, response);
    request::FittedSweep fitted =
        request::FitSweep(request, name, std::move(sweep), kind, response_noise, note);
    converged = fitted.fit.converged;
    return fitted;
  });
  answer.established = converged;
  return answer;
}

BatchEntry FitOne(const NamedRecord& record, const request::FitRequest& request,
                  const std::string& strict) {
  const py::gil_scoped_release others_may_run;
  const Strictness strictness = strict == "adequate"   ? Strictness::kAdequate
                                : strict == "doubtful" ? Strictness::kDoubtful
                                                       : Strictness::kNone;
  return request::FitSource(request, record.name, strictness,
                            [&](const request::FitRequest& own, const request::Tell& note) {
                              std::vector<io::RecordFile> files = {record.file};
                              request::KeepTimeWindow(own, record.name, files.front());
                              for (const std::string& text : files.front().notes) note(text);
                              return files;
                            });
}

BatchEntry FaultyEntry(const std::string& name, const std::string& fault) {
  BatchEntry entry;
  entry.file = name;
  entry.fault = fault;
  return entry;
}

/// Returns what another process needs of an entry: name, fault, done, notes, JSON and digest.
py::tuple StateOf(const BatchEntry& entry) {
  return py::make_tuple(entry.file, entry.fault, entry.done, entry.notes, request::FitJson(entry),
                        entry.sha256);
}

BatchEntry EntryOf(const py::tuple& state) {
  BatchEntry entry = FaultyEntry(state[0].cast<std::string>(), state[1].cast<std::string>());
  entry.done = state[2].cast<bool>();
  entry.notes = state[3].cast<std::vector<std::string>>();
  request::SetFitJson(entry, state[4].cast<std::string>());
  entry.sha256 = state[5].cast<std::string>();
  return entry;
}

py::dict ColumnsOf(const std::vector<BatchEntry>& entries) {
  py::dict columns;
  for (const request::BatchColumn& column : request::TableOf(entries)) {
    columns[py::str(std::string(column.name))] = column.cells;
  }
  return columns;
}

void AddRequests(py::module_& module) {
  py::class_<LawRequest>(module, "LawRequest")
      .def(py::init<>())
      .def_readwrite("sigma", &LawRequest::sigma)
      .def_readwrite("alpha", &LawRequest::alpha)
      .def_readwrite("slip_force", &LawRequest::slip_force)
      .def_readwrite("contact", &LawRequest::contact);
  py::class_<PlanRequest>(module, "PlanRequest")
      .def(py::init<>())
      .def_readwrite("law", &PlanRequest::law)
      .def_readwrite("rig_stiffness", &PlanRequest::rig_stiffness)
      .def_readwrite("force_noise", &PlanRequest::force_noise)
      .def_readwrite("displacement_noise", &PlanRequest::displacement_noise)
      .def_readwrite("autocorrelation", &PlanRequest::autocorrelation)
      .def_readwrite("amplitudes", &PlanRequest::amplitudes)
      .def_readwrite("load_ratios", &PlanRequest::load_ratios)
      .def_readwrite("load_exponent", &PlanRequest::load_exponent)
      .def_readwrite("samples_per_cycle", &PlanRequest::samples_per_cycle)
      .def_readwrite("cycles", &PlanRequest::cycles)
      .def_readwrite("with_terms", &PlanRequest::with)
      .def("set_wanted", &SetWanted, py::arg("name"), py::arg("value"), py::arg("is_relative"));
}

}  // namespace

void AddAnswers(py::module_& module) {
  AddRequests(module);
  py::class_<Answer>(module, "Answer")
      .def_readonly("json", &Answer::json)
      .def_readonly("text", &Answer::text)
      .def_readonly("established", &Answer::established)
      .def_readonly("warnings", &Answer::warnings);
  module.def("contact", &Contact, py::arg("options"));
  module.def("sweep", &Sweep, py::arg("request"), py::arg("kind"), py::arg("name"),
             py::arg("names"), py::arg("arrays"), py::arg("response"), py::arg("response_noise"));
  module.def(
      "convert",
      [](const std::string& fit, std::optional<double> sigma, std::optional<double> alpha,
         std::optional<double> slip_force, std::optional<double> amplitude, const std::string& from,
         const std::string& to, double tolerance, std::size_t elements, double beta,
         std::optional<double> normal_load, std::optional<double> contact_radius, double viscous) {
        return Convert({.fit = fit,
                        .sigma = sigma,
                        .alpha = alpha,
                        .slip_force = slip_force,
                        .amplitude = amplitude,
                        .from = from,
                        .to = to,
                        .options = {.tolerance = tolerance, .elements = elements, .beta = beta},
                        .normal = {.normal_load = normal_load,
                                   .contact_radius = contact_radius,
                                   .viscous = viscous}});
      },
      py::kw_only(), py::arg("fit"), py::arg("sigma"), py::arg("alpha"), py::arg("slip_force"),
      py::arg("amplitude"), py::arg("from_law"), py::arg("to"), py::arg("tolerance"),
      py::arg("elements"), py::arg("beta"), py::arg("normal_load"), py::arg("contact_radius"),
      py::arg("viscous"));
  module.def("plan", &Plan, py::arg("request"), py::arg("initial_state"), py::arg("record"));
  module.def("tradeoff", &Tradeoff, py::arg("law"), py::arg("excitations"), py::arg("displacement"),
             py::arg("path_name"), py::arg("tolerance"));
  module.def("validate", &Validate, py::arg("cases"), py::arg("seed"));
  module.def(
      "read_displacement_path",
      [](const std::string& path, const std::string& unit) {
        const std::vector<double> samples =
            io::ReadDisplacementPath(path, unit.empty() ? "" : "[" + unit + "]");
        return Array(static_cast<py::ssize_t>(samples.size()), samples.data());
      },
      py::arg("path"), py::arg("unit"));

  py::class_<BatchEntry>(module, "BatchEntry")
      .def_readonly("done", &BatchEntry::done)
      .def_readonly("notes", &BatchEntry::notes)
      .def_readonly("name", &BatchEntry::file)
      .def_readonly("fault", &BatchEntry::fault)
      .def(py::pickle(&StateOf, &EntryOf));
  module.def("check_request",
             [](const request::FitRequest& request) { request::MakeFitOptions(request); });
  module.def("fit_one", &FitOne, py::arg("record"), py::arg("request"), py::arg("strict"));
  module.def("faulty_entry", &FaultyEntry, py::arg("name"), py::arg("fault"));
  module.def("batch_columns", &ColumnsOf, py::arg("entries"));
  module.def("batch_csv",
             [](const std::vector<BatchEntry>& entries) { return request::TableCsv(entries); });
  module.def("batch_answer", [](const std::vector<BatchEntry>& entries) {
    return Answer{.json = request::ToJson(entries, ""),
                  .text = request::ToText(entries, ""),
                  .established = request::AllDone(entries),
                  .warnings = {}};
  });
}

}  // namespace mindahl::python
