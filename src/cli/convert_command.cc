#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "cli/commands.h"
#include "cli/contact_options.h"
#include "cli/examples.h"
#include "cli/json_output.h"
#include "cli/one_of.h"
#include "cli/output_path.h"
#include "cli/text_output.h"
#include "cli/tolerance.h"
#include "cli/whole_number.h"
#include "mindahl/convert/conversion.h"
#include "mindahl/convert/parameters.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"

namespace mindahl::cli {

using convert::AmplitudeRange;
using convert::Conversion;
using convert::LoopError;
using convert::ModelLaw;
using convert::Parameter;
using convert::Target;
using convert::TargetRow;
using methods::IwanElements;

namespace {

constexpr std::size_t kMostElements = 10'000;

struct ConvertCommandOptions {
  models::BranchLaw law;
  std::string from;
  std::string to;
  std::string tolerance = "1%";
  convert::ConversionOptions conversion;
  std::optional<double> least_amplitude;
  std::optional<double> largest_amplitude;
  convert::NormalContact normal;
  std::string json_path;
  std::string input_lines_path;
};

const TargetRow& FindTarget(std::string_view name) {
  return *std::ranges::find(convert::Targets(), name, &TargetRow::name);
}

nlohmann::ordered_json LoopErrorJson(const LoopError& error) {
  return {{"force", NumberOrNull(error.force)}, {"energy", NumberOrNull(error.energy)}};
}

nlohmann::ordered_json ConversionJson(const ConvertCommandOptions& options, const TargetRow& target,
                                      const Conversion& conversion,
                                      const std::vector<Parameter>& parameters) {
  nlohmann::ordered_json json = {{"schema", "mindahl.convert/1"},
                                 {"version", Version()},
                                 {"from",
                                  {{"law", options.from},
                                   {"sigma", options.law.tangential_stiffness},
                                   {"alpha", options.law.shape_exponent},
                                   {"slip_force", options.law.slip_force}}},
                                 {"to", target.name},
                                 {"amplitude", options.conversion.amplitude},
                                 {"range", nullptr},
                                 {"tolerance", options.conversion.tolerance}};
  if (options.conversion.range) {
    json["range"] = {options.conversion.range->lower, options.conversion.range->upper};
  }
  json["parameters"] = nlohmann::ordered_json::object();
  for (const Parameter& parameter : parameters) {
    json["parameters"][parameter.name] = {{"value", parameter.value}, {"unit", parameter.unit}};
  }
  json["elements"] = nlohmann::ordered_json::array();
  if (const auto* elements = std::get_if<IwanElements>(&conversion.law)) {
    for (std::size_t j = 0; j < elements->size(); ++j) {
      json["elements"].push_back(
          {{"stiffness", elements->stiffness[j]}, {"slip_force", elements->slip_force[j]}});
    }
  }
  json["error_at_amplitude"] = LoopErrorJson(conversion.at_amplitude);
  json["largest_error"] = LoopErrorJson(conversion.largest);
  json["within"] = nullptr;
  if (conversion.within) json["within"] = {conversion.within->lower, conversion.within->upper};
  return json;
}

/// Returns an error in percent; what rounding leaves of two curves that are one is 0.
std::string Percent(double error) {
  constexpr double kRounding = 1e-12;
  return std::abs(error) < kRounding ? "0 %" : fmt::format("{:.3g} %", 100 * error);
}

std::string ToText(const ConvertCommandOptions& options, const TargetRow& target,
                   const Conversion& conversion, const std::vector<Parameter>& parameters) {
  std::string text = fmt::format("{}, on the steady loop between ±{:.6g} m\n\n", target.title,
                                 options.conversion.amplitude);
  for (const Parameter& parameter : parameters) {
    text += fmt::format("{:<12} {:>14.8g} {:<6} {}\n", parameter.name, parameter.value,
                        parameter.unit, parameter.meaning);
  }
  if (const auto* elements = std::get_if<IwanElements>(&conversion.law)) {
    text += fmt::format("\n{:>7} {:>16} {:>16}\n", "element", "stiffness [N/m]", "slip force [N]");
    for (std::size_t j = 0; j < elements->size(); ++j) {
      text += fmt::format("{:>7} {:>16.8g} {:>16.8g}\n", j + 1, elements->stiffness[j],
                          elements->slip_force[j]);
    }
  }
  text +=
      fmt::format("\nerror at the amplitude: force {} of T*, energy {}\n",
                  Percent(conversion.at_amplitude.force), Percent(conversion.at_amplitude.energy));
  if (options.conversion.range) {
    text += fmt::format("largest from {:.4g} to {:.4g} m: force {} of T*, energy {}\n",
                        options.conversion.range->lower, options.conversion.range->upper,
                        Percent(conversion.largest.force), Percent(conversion.largest.energy));
  }
  if (!conversion.within) {
    return text +
           fmt::format("not within {} at the amplitude\n", Percent(options.conversion.tolerance));
  }
  return text + fmt::format("force and energy within {} from {:.4g} to {:.4g} m\n",
                            Percent(options.conversion.tolerance), conversion.within->lower,
                            conversion.within->upper);
}

/// @throws InputError for options that belong to another target or contradict
void RequireConvertOptions(const ConvertCommandOptions& options, Target target) {
  Validate(options.normal, target);
  if (options.json_path == "-" && options.input_lines_path == "-") {
    throw InputError("--json - and --input-lines - both write to standard output: give a file");
  }
}

void RunConvert(ConvertCommandOptions options, Console& console) {
  const TargetRow& target = FindTarget(options.to);
  RequireConvertOptions(options, target.target);
  RequireOutputPaths({{"--json", options.json_path, /*dash_is_stdout=*/true},
                      {"--input-lines", options.input_lines_path, /*dash_is_stdout=*/true}},
                     console.inputs);
  convert::ConversionOptions& asked = options.conversion;
  asked.tolerance = ParseTolerance(options.tolerance);
  if (options.least_amplitude || options.largest_amplitude) {
    asked.range = AmplitudeRange{options.least_amplitude.value_or(asked.amplitude),
                                 options.largest_amplitude.value_or(asked.amplitude)};
  }
  const ModelLaw contact{
      models::FindFrictionModel(options.from == "dahl" ? "dahl" : "mindlin-dahl"), options.law};
  const Conversion conversion = convert::Convert(contact, target.target, asked);
  const std::vector<Parameter> parameters = ParametersOf(conversion, target.target, options.normal);
  if (!options.input_lines_path.empty()) {
    std::string lines;
    for (const std::string& line : InputLines(conversion, target.target, options.normal)) {
      lines += line + '\n';
    }
    WriteText(lines, options.input_lines_path, console);
  }
  if (!options.json_path.empty()) {
    WriteJson(ConversionJson(options, target, conversion, parameters), options.json_path, console);
  }
  if (options.json_path != "-" && options.input_lines_path != "-") {
    console.out << ToText(options, target, conversion, parameters);
  }
}

}  // namespace

void AddConvertCommand(CLI::App& app, Console& console) {
  const auto options = std::make_shared<ConvertCommandOptions>();
  CLI::App* command =
      app.add_subcommand("convert",
                         "A contact's steady loop by another law or another program: parameters,\n"
                         "the error that is left, and the amplitudes at which it is small.");
  AddExamples(
      *command, app,
      {"mindahl convert --sigma 4e7 --slip-force 40 --amplitude 1.2e-6 --to dahl",
       "mindahl convert --sigma 4e7 --slip-force 40 --amplitude 1.2e-6 --to iwan --elements 5 \\",
       "    --input-lines contact.tcl"});
  const std::string contact = "The contact";
  command->add_option("--sigma", options->law.tangential_stiffness, "tangential stiffness [N/m]")
      ->required()
      ->type_name("N/M")
      ->group(contact);
  command->add_option("--alpha", options->law.shape_exponent, "shape exponent [-], default 1/3")
      ->type_name("ALPHA")
      ->group(contact);
  command->add_option("--slip-force", options->law.slip_force, "slip force Tc [N]")
      ->required()
      ->type_name("N")
      ->group(contact);
  options->from = "masing";
  command
      ->add_option("--from", options->from,
                   "law that they are of: of fit --model mindlin-dahl, or --model dahl")
      ->capture_default_str()
      ->check(OneOf({"masing", "dahl"}))
      ->group(contact);
  command
      ->add_option("--amplitude", options->conversion.amplitude,
                   "X of the steady loop [m], the contact's, without a rig's share")
      ->required()
      ->type_name("M")
      ->group(contact);
  const std::string result = "What it becomes";
  std::vector<std::string> names;
  for (const TargetRow& row : convert::Targets()) names.emplace_back(row.name);
  command->add_option("--to", options->to, "law or program")
      ->required()
      ->check(OneOf(names))
      ->group(result);
  AddOptional(*command, "--least-amplitude", options->least_amplitude,
              "from here [m] what cannot be exact is fitted; default the amplitude", "M")
      ->group(result);
  AddOptional(*command, "--largest-amplitude", options->largest_amplitude, "to here [m]; likewise",
              "M")
      ->group(result);
  command
      ->add_option("--tolerance", options->tolerance,
                   "of force and energy, which are within it where said: 0.01 or 1%")
      ->capture_default_str()
      ->type_name("E")
      ->group(result);
  command->add_option("--elements", options->conversion.elements, "of --to iwan")
      ->capture_default_str()
      ->check(WholeNumber(1, kMostElements))
      ->group(result);
  command
      ->add_option("--beta", options->conversion.beta,
                   "of --to bouc-wen in T/Tc, where beta + gamma = 1; in (0, 1]")
      ->capture_default_str()
      ->type_name("BETA")
      ->group(result);
  AddOptional(*command, "--normal-load", options->normal.normal_load,
              "of --to lammps, liggghts and yade [N]: friction coefficient is Tc/N", "N")
      ->group(result);
  AddOptional(*command, "--contact-radius", options->normal.contact_radius,
              "of --to lammps [m]: for a stiffness that follows the radius", "M")
      ->group(result);
  command
      ->add_option("--viscous", options->normal.viscous,
                   "force per speed [N s/m] of --to lugre, mujoco, mujoco-joint, urdf and sdf")
      ->type_name("C")
      ->group(result);
  const std::string outputs = "Output";
  command
      ->add_option("--input-lines", options->input_lines_path,
                   "lines as the other program reads them; - for standard output")
      ->type_name("PATH")
      ->group(outputs);
  command->add_option("--json", options->json_path, "result as JSON; - for standard output")
      ->type_name("PATH")
      ->group(outputs);
  command->callback([options, &console] { RunConvert(*options, console); });
}

}  // namespace mindahl::cli
