#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "cli/app.h"
#include "cli/options.h"
#include "cli/output.h"
#include "core/text.h"
#include "mindahl/convert/conversion.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/steady_loop.h"
#include "report/table.h"

namespace mindahl::cli {

using convert::LoopError;
using convert::Parameter;
using convert::TargetRow;
using report::Json;
using report::NumberOrNull;

namespace {

constexpr std::size_t kMostElements = 10'000;

struct ConvertOptions {
  std::string fit;              // file of `mindahl fit --json`: law and amplitude, unless given
  std::optional<double> sigma;  // [N/m]
  std::optional<double> alpha;  // default 1/3
  std::optional<double> slip_force;  // [N]
  std::optional<double> amplitude;   // X [m] of the contact's steady loop
  std::string from;                  // "masing", "dahl" or "": that of the fit, else masing
  std::string to;
  convert::ConversionOptions options = {};
  convert::NormalContact normal = {};
  std::string json_path;
  std::string input_lines_path;
};

/// A contact written for a target.
struct ConvertedContact {
  ConvertOptions asked;  // with what a fit says
  models::BranchLaw law;
  TargetRow target;
  convert::Conversion conversion = {};
  std::vector<Parameter> parameters = {};
};

/// Returns what a place of a document has, null where there is no such place.
Json At(const Json& document, const std::string& place) {
  const Json::json_pointer pointer(place);
  return document.contains(pointer) ? document[pointer] : Json();
}

/// Reads what `mindahl fit --json` wrote.
Json ReadFit(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw InputError(fmt::format("{}: cannot be read", file));
  Json fit = Json::parse(stream, nullptr, /*allow_exceptions=*/false);
  const Json schema = At(fit, "/schema");
  if (schema.is_string() && schema.get<std::string>().starts_with("mindahl.fit/")) return fit;
  throw InputError(fmt::format(
      "{}: is not the result of a fit: give what `mindahl fit --json {}` writes", file, file));
}

const models::FrictionModel& ModelOf(const ConvertOptions& request) {
  return *models::FindFrictionModel(request.from == "dahl" ? "dahl" : "mindlin-dahl");
}

/// Takes law and amplitude from a fit where they are not given.
void TakeFit(const Json& fit, ConvertOptions& request) {
  if (request.from.empty()) request.from = At(fit, "/model") == "dahl" ? "dahl" : "masing";
  const auto take = [&](std::optional<double>& value, const std::string& place) {
    const Json found = At(fit, place);
    if (!value && found.is_number()) value = found.get<double>();
  };
  for (const auto& [value, name] : {std::pair(&request.sigma, "sigma"),
                                    {&request.alpha, "alpha"},
                                    {&request.slip_force, "slip_force"}}) {
    const std::string place = fmt::format("/parameters/{}", name);
    const Json known = At(fit, place + "/identifiability");
    const bool is_open = known == "not_identifiable" || known == "bounded_below";
    if (!is_open || At(fit, place + "/status") == "fixed") take(*value, place + "/value");
  }
  if (request.amplitude || !request.sigma || !request.slip_force) return;
  take(request.amplitude, "/measured/amplitude");
  std::optional<double> rig;
  take(rig, "/parameters/rig_stiffness/value");
  if (!rig || !request.amplitude) return;
  // The rest of the amplitude is the rig's.
  request.amplitude = models::ContactAmplitude(
      ModelOf(request), {*request.sigma, request.alpha.value_or(1.0 / 3), *request.slip_force},
      {.stiffness = *rig}, *request.amplitude);
}

double Require(const std::optional<double>& value, std::string_view option,
               const ConvertOptions& request) {
  if (value) return *value;
  throw InputError(
      request.fit.empty()
          ? fmt::format("{} missing: give it, or the JSON file of a fit", option)
          : fmt::format("{} missing: {} does not determine it: give it", option, request.fit));
}

/// Returns an error in percent; what rounding leaves of two curves that are one is 0.
std::string Percent(double error) {
  constexpr double kRounding = 1e-9;
  return std::abs(error) < kRounding ? "0 %" : fmt::format("{:.3g} %", 100 * error);
}

/// States the errors at the amplitude; an energy has none where the contact loses nothing.
std::string ErrorAtAmplitude(const ConvertedContact& made) {
  const LoopError& error = made.conversion.at_amplitude;
  return fmt::format("at {:.6g} m the force is within {} of T*, the energy {}",
                     made.asked.options.amplitude, Percent(error.force),
                     std::isfinite(error.energy) ? "off by " + Percent(error.energy)
                                                 : "lost where the contact loses none");
}

ConvertedContact MakeConversion(const ConvertOptions& asked) {
  ConvertOptions request = asked;
  if (!request.fit.empty()) {
    TakeFit(ReadFit(request.fit), request);
    Require(request.alpha, "--alpha", request);
  }
  if (request.from.empty()) request.from = "masing";
  const models::BranchLaw law = {Require(request.sigma, "--sigma", request),
                                 request.alpha.value_or(1.0 / 3),
                                 Require(request.slip_force, "--slip-force", request)};
  request.options.amplitude = Require(request.amplitude, "--amplitude", request);
  const TargetRow target = *std::ranges::find(convert::Targets(), request.to, &TargetRow::name);
  Validate(request.normal, target);
  convert::Conversion made = convert::Convert({&ModelOf(request), law}, target, request.options);
  std::vector<Parameter> parameters = ParametersOf(made, target, request.normal);
  return {std::move(request), law, target, std::move(made), std::move(parameters)};
}

Json ParametersJson(const ConvertedContact& made) {
  Json parameters = Json::object();
  for (const Parameter& parameter : made.parameters) {
    parameters[parameter.name] = {
        {"value", parameter.value}, {"unit", parameter.unit}, {"meaning", parameter.meaning}};
  }
  return parameters;
}

Json ElementsJson(const ConvertedContact& made) {
  Json rows = Json::array();
  if (const auto* elements = std::get_if<methods::IwanElements>(&made.conversion.law)) {
    for (std::size_t j = 0; j < elements->size(); ++j) {
      rows.push_back(
          {{"stiffness", elements->stiffness[j]}, {"slip_force", elements->slip_force[j]}});
    }
  }
  return rows;
}

std::string ToJson(const ConvertedContact& made) {
  const convert::Conversion& conversion = made.conversion;
  const auto& within = conversion.within;
  return report::Dump({{"schema", "mindahl.convert/1"},
                       {"version", Version()},
                       {"from",
                        {{"law", made.asked.from},
                         {"sigma", made.law.tangential_stiffness},
                         {"alpha", made.law.shape_exponent},
                         {"slip_force", made.law.slip_force}}},
                       {"to", made.target.name},
                       {"amplitude", made.asked.options.amplitude},
                       {"tolerance", made.asked.options.tolerance},
                       {"parameters", ParametersJson(made)},
                       {"elements", ElementsJson(made)},
                       {"error_at_amplitude",
                        {{"force", NumberOrNull(conversion.at_amplitude.force)},
                         {"energy", NumberOrNull(conversion.at_amplitude.energy)}}},
                       {"within", within ? Json({within->lower, within->upper}) : Json()}});
}

std::string ToText(const ConvertedContact& made) {
  constexpr int kDigits = 8;
  const auto& within = made.conversion.within;
  return fmt::format(
      "{}; {}\n\n{}{}\n{}\n", made.target.title, ErrorAtAmplitude(made),
      report::TableText(ParametersJson(made), kDigits),
      report::TableText(ElementsJson(made), kDigits),
      within
          ? fmt::format("force and energy within {} from {:.4g} to {:.4g} m",
                        Percent(made.asked.options.tolerance), within->lower, within->upper)
          : fmt::format("not within {} at the amplitude", Percent(made.asked.options.tolerance)));
}

void RunConvert(const ConvertOptions& options, Console& console) {
  const ConvertedContact converted = MakeConversion(options);
  if (!options.input_lines_path.empty()) {
    const std::vector<std::string> lines =
        convert::InputLines(converted.conversion, converted.target, converted.asked.normal,
                            ErrorAtAmplitude(converted));
    WriteText(fmt::format("{}\n", fmt::join(lines, "\n")), options.input_lines_path, console);
  }
  if (!options.json_path.empty()) WriteText(ToJson(converted), options.json_path, console);
  if (options.json_path != "-" && options.input_lines_path != "-") {
    console.out << ToText(converted);
  }
}

}  // namespace

void AddConvertCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<ConvertOptions>();
  CLI::App& command = AddCommand(
      app, "convert",
      "Converts a contact's steady loop to another law or program: the\n"
      "parameters, the remaining error, and the amplitudes at which it is\n"
      "small.",
      {"mindahl convert fit.json --to dahl",
       "mindahl convert --sigma 4e7 --slip-force 40 --amplitude 1.2e-6 --to iwan --elements 5 \\",
       "    --input-lines contact.tcl"});
  const OptionGroup contact(command, "The contact");
  contact.Add("fit", options->fit,
              "what mindahl fit --json wrote: law and amplitude, unless given below", "FILE");
  contact.Add("--sigma", options->sigma, "tangential stiffness [N/m]", "N/M");
  contact.Add("--alpha", options->alpha, "shape exponent [-], default 1/3", "ALPHA");
  contact.Add("--slip-force", options->slip_force, "slip force Tc [N]", "N");
  contact
      .Add("--from", options->from,
           "law of these parameters: of fit --model mindlin-dahl or --model dahl;\ndefault the "
           "fit's, "
           "else masing")
      ->check(OneOf({"masing", "dahl"}));
  contact.Add("--amplitude", options->amplitude,
              "amplitude X of the contact's steady loop [m], without the rig's travel", "M");
  const OptionGroup result(command, "What it becomes");
  result.Add("--to", options->to, "law or program")
      ->required()
      ->check(OneOf(NamesOf(convert::Targets(), &convert::TargetRow::name)));
  AddTolerance(result, options->options.tolerance,
               "largest error of force and energy at the amplitudes given as good:\n0.01 or 1%");
  result.AddShown("--elements", options->options.elements, "number of elements of --to iwan")
      ->check(WholeNumber(1, kMostElements));
  result.AddShown("--beta", options->options.beta,
                  "beta of --to bouc-wen for T/Tc, in (0, 1]; gamma is 1 - beta", "BETA");
  result.Add("--normal-load", options->normal.normal_load,
             "normal load [N] for --to lammps, liggghts and yade: friction\ncoefficient Tc/N", "N");
  result.Add("--contact-radius", options->normal.contact_radius,
             "contact radius [m] for --to lammps: the stiffness follows it", "M");
  result.Add("--viscous", options->normal.viscous,
             "force per speed [N s/m]: lugre, mujoco, mujoco-joint, urdf, sdf", "C");
  const OptionGroup outputs(command, "Output");
  outputs.Add("--input-lines", options->input_lines_path,
              "lines as the other program reads them; - for standard output", "PATH");
  outputs.Add("--json", options->json_path, "result as JSON; - for standard output", "PATH");
  OnRun(command, [options, &console] { RunConvert(*options, console); });
}

}  // namespace mindahl::cli
