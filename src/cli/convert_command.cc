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
#include "cli/output_path.h"
#include "cli/text_output.h"
#include "cli/tolerance.h"
#include "cli/whole_number.h"
#include "mindahl/convert/conversion.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"

namespace mindahl::cli {

using convert::AmplitudeRange;
using convert::BoucWenLaw;
using convert::Conversion;
using convert::LoopError;
using convert::ModelLaw;
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
  std::optional<double> normal_load;
  std::optional<double> contact_radius;
  std::string json_path;
  std::string input_lines_path;
};

/// A parameter of the other law, as it calls it.
struct Parameter {
  std::string name;
  double value;
  std::string unit;
  std::string meaning;
};

const TargetRow& FindTarget(std::string_view name) {
  return *std::ranges::find(convert::Targets(), name, &TargetRow::name);
}

/// γ and β of dz/dx = A − |z|ⁿ(γ + β·sgn(z·ẋ)) with A = 1 and z = T/k: over z*ⁿ, z* = Tc/k.
double PerTravel(const BoucWenLaw& law, double share) {
  return share * std::pow(law.stiffness / law.slip_force, law.exponent);
}

std::vector<Parameter> ParametersOf(const ConvertCommandOptions& options, Target target,
                                    const Conversion& conversion) {
  if (const auto* law = std::get_if<BoucWenLaw>(&conversion.law)) {
    return {{"k", law->stiffness, "N/m", "stiffness, of force = k z"},
            {"A", 1.0, "-", "dz/dx at z = 0"},
            {"n", law->exponent, "-", "exponent"},
            {"beta", PerTravel(*law, law->beta), "1/m^n", "of |z|^n sgn(z dx)"},
            {"gamma", PerTravel(*law, 1 - law->beta), "1/m^n", "of |z|^n"},
            {"slip_force", law->slip_force, "N", "k (beta + gamma)^(-1/n)"}};
  }
  if (const auto* elements = std::get_if<IwanElements>(&conversion.law)) {
    double stiffness = 0.0;
    double slip_force = 0.0;
    for (std::size_t j = 0; j < elements->size(); ++j) {
      stiffness += elements->stiffness[j];
      slip_force += elements->slip_force[j];
    }
    return {{"sigma", stiffness, "N/m", "sum of the stiffnesses"},
            {"slip_force", slip_force, "N", "sum of the slip forces"}};
  }
  const models::BranchLaw& law = std::get<ModelLaw>(conversion.law).law;
  if (target == Target::kLuGre) {
    return {{"sigma0", law.tangential_stiffness, "N/m", "bristles' stiffness"},
            {"sigma1", 0.0, "N s/m", "bristles' damping"},
            {"sigma2", 0.0, "N s/m", "viscous friction"},
            {"Fc", law.slip_force, "N", "Coulomb's force"},
            {"Fs", law.slip_force, "N", "static force: no Stribeck effect"}};
  }
  if (target == Target::kLammps) {
    std::vector<Parameter> parameters = {
        {"kt", law.tangential_stiffness, "N/m", "of tangential linear_history"},
        {"slip_force", law.slip_force, "N", "Coulomb's limit"}};
    if (options.contact_radius) {
      parameters.push_back({"kt_mindlin", law.tangential_stiffness / *options.contact_radius, "Pa",
                            "of tangential mindlin, whose stiffness is kt a"});
    }
    if (options.normal_load) {
      parameters.push_back({"mu", law.slip_force / *options.normal_load, "-", "friction, Tc/N"});
    }
    return parameters;
  }
  return {{"sigma", law.tangential_stiffness, "N/m",
           target == Target::kDahl ? "dT/dx at T = 0" : "at the start of a branch"},
          {"alpha", law.shape_exponent, "-", "shape exponent"},
          {"slip_force", law.slip_force, "N", "slip force"}};
}

/// What the other program reads.
std::vector<std::string> InputLines(const ConvertCommandOptions& options, Target target,
                                    const Conversion& conversion) {
  if (const auto* law = std::get_if<BoucWenLaw>(&conversion.law)) {
    return {
        "# OpenSees, force in N and displacement in m: tag alpha ko n gamma beta Ao deltaA "
        "deltaNu deltaEta",
        fmt::format("uniaxialMaterial BoucWen 1 0.0 {} {} {} {} 1.0 0.0 0.0 0.0", law->stiffness,
                    law->exponent, PerTravel(*law, 1 - law->beta), PerTravel(*law, law->beta))};
  }
  if (const auto* elements = std::get_if<IwanElements>(&conversion.law)) {
    std::vector<std::string> lines = {
        "# OpenSees, force in N and displacement in m: tag, stiffness, displacement at slip"};
    std::string tags;
    for (std::size_t j = 0; j < elements->size(); ++j) {
      lines.push_back(fmt::format("uniaxialMaterial ElasticPP {} {} {}", j + 1,
                                  elements->stiffness[j],
                                  elements->slip_force[j] / elements->stiffness[j]));
      tags += fmt::format(" {}", j + 1);
    }
    lines.push_back(fmt::format("uniaxialMaterial Parallel {}{}", elements->size() + 1, tags));
    return lines;
  }
  const models::BranchLaw& law = std::get<ModelLaw>(conversion.law).law;
  if (target == Target::kLammps) {
    if (!options.normal_load) {
      throw InputError(
          "--input-lines of lammps needs --normal-load: its friction coefficient is Tc/N");
    }
    const double friction = law.slip_force / *options.normal_load;
    std::vector<std::string> lines = {
        "# LAMMPS, pair_style granular in SI units, behind the normal model of pair_coeff",
        fmt::format("tangential linear_history {} 0.0 {}", law.tangential_stiffness, friction)};
    if (options.contact_radius) {
      lines.emplace_back("# or, where the contact's radius changes with the load");
      lines.push_back(fmt::format("tangential mindlin {} 0.0 {}",
                                  law.tangential_stiffness / *options.contact_radius, friction));
    }
    return lines;
  }
  if (target == Target::kLuGre) {
    return {fmt::format("sigma0 = {}", law.tangential_stiffness), "sigma1 = 0", "sigma2 = 0",
            fmt::format("Fc = {}", law.slip_force), fmt::format("Fs = {}", law.slip_force)};
  }
  return {fmt::format("--model {} --sigma {} --alpha {} --slip-force {}",
                      std::get<ModelLaw>(conversion.law).model->name, law.tangential_stiffness,
                      law.shape_exponent, law.slip_force)};
}

nlohmann::ordered_json ToJson(const LoopError& error) {
  return {{"force", NumberOrNull(error.force)}, {"energy", NumberOrNull(error.energy)}};
}

nlohmann::ordered_json ToJson(const ConvertCommandOptions& options, const TargetRow& target,
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
  json["error_at_amplitude"] = ToJson(conversion.at_amplitude);
  json["largest_error"] = ToJson(conversion.largest);
  json["within"] = nullptr;
  if (conversion.within) json["within"] = {conversion.within->lower, conversion.within->upper};
  return json;
}

/// In percent; what rounding leaves of two curves that are one is 0.
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
void RequireOptions(const ConvertCommandOptions& options, Target target) {
  if (options.normal_load) RequirePositive("--normal-load [N]", *options.normal_load);
  if (options.contact_radius) RequirePositive("--contact-radius [m]", *options.contact_radius);
  if ((options.normal_load || options.contact_radius) && target != Target::kLammps) {
    throw InputError("--normal-load and --contact-radius are of --to lammps alone");
  }
  if (options.json_path == "-" && options.input_lines_path == "-") {
    throw InputError("--json - and --input-lines - both write to standard output: give a file");
  }
}

void RunConvert(ConvertCommandOptions options, Console& console) {
  const TargetRow& target = FindTarget(options.to);
  RequireOptions(options, target.target);
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
  const std::vector<Parameter> parameters = ParametersOf(options, target.target, conversion);
  if (!options.input_lines_path.empty()) {
    std::string lines;
    for (const std::string& line : InputLines(options, target.target, conversion)) {
      lines += line + '\n';
    }
    WriteText(lines, options.input_lines_path, console);
  }
  if (!options.json_path.empty()) {
    WriteJson(ToJson(options, target, conversion, parameters), options.json_path, console);
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
      ->check(CLI::IsMember({"masing", "dahl"}))
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
      ->check(CLI::IsMember(names))
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
  AddOptional(*command, "--normal-load", options->normal_load,
              "of --to lammps [N]: friction coefficient is Tc/N", "N")
      ->group(result);
  AddOptional(*command, "--contact-radius", options->contact_radius,
              "of --to lammps [m]: for a stiffness that follows the radius", "M")
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
