#include "mindahl/request/conversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <variant>

#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/models/friction_model.h"
#include "request/json.h"

namespace mindahl::request {

using convert::AmplitudeRange;
using convert::ConversionOptions;
using convert::LoopError;
using convert::Parameter;
using convert::TargetRow;
using methods::IwanElements;

namespace {

Json LoopErrorJson(const LoopError& error) {
  return {{"force", NumberOrNull(error.force)}, {"energy", NumberOrNull(error.energy)}};
}

/// Returns an error in percent; what rounding leaves of two curves that are one is 0.
std::string Percent(double error) {
  constexpr double kRounding = 1e-12;
  return std::abs(error) < kRounding ? "0 %" : fmt::format("{:.3g} %", 100 * error);
}

/// Writes the errors of a loop; an energy has none where the contact loses nothing.
std::string ErrorsInWords(const LoopError& error) {
  return fmt::format(
      "force {} of T*, energy {}", Percent(error.force),
      std::isfinite(error.energy) ? Percent(error.energy) : "lost where the contact loses none");
}

}  // namespace

ConvertedContact MakeConversion(const ConversionRequest& request) {
  RequireOneOf("--to", request.to, NamesOf(convert::Targets(), &TargetRow::name));
  RequireOneOf("--from", request.from, kLawsToConvert);
  const TargetRow& target = *std::ranges::find(convert::Targets(), request.to, &TargetRow::name);
  Validate(request.normal, target.target);
  ConvertedContact made{.request = request, .target = target};
  ConversionOptions& options = made.request.options;
  if (request.least_amplitude || request.largest_amplitude) {
    options.range = AmplitudeRange{request.least_amplitude.value_or(options.amplitude),
                                   request.largest_amplitude.value_or(options.amplitude)};
  }
  const char* const model = request.from == "dahl" ? "dahl" : "mindlin-dahl";
  made.conversion =
      convert::Convert({models::FindFrictionModel(model), request.law}, target.target, options);
  made.parameters = ParametersOf(made.conversion, target.target, request.normal);
  return made;
}

std::string ToJson(const ConvertedContact& converted) {
  const models::BranchLaw& law = converted.request.law;
  const ConversionOptions& options = converted.request.options;
  const convert::Conversion& conversion = converted.conversion;
  Json json = {{"schema", "mindahl.convert/1"},
               {"version", Version()},
               {"from",
                {{"law", converted.request.from},
                 {"sigma", law.tangential_stiffness},
                 {"alpha", law.shape_exponent},
                 {"slip_force", law.slip_force}}},
               {"to", converted.target.name},
               {"amplitude", options.amplitude},
               {"range", nullptr},
               {"tolerance", options.tolerance}};
  if (options.range) {
    json["range"] = {options.range->lower, options.range->upper};
  }
  json["parameters"] = Json::object();
  for (const Parameter& parameter : converted.parameters) {
    json["parameters"][parameter.name] = {{"value", parameter.value}, {"unit", parameter.unit}};
  }
  json["elements"] = Json::array();
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
  return Dump(json);
}

std::string ToText(const ConvertedContact& converted) {
  const ConversionOptions& options = converted.request.options;
  const convert::Conversion& conversion = converted.conversion;
  std::string text = fmt::format("{}, on the steady loop between ±{:.6g} m\n\n",
                                 converted.target.title, options.amplitude);
  for (const Parameter& parameter : converted.parameters) {
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
  text += fmt::format("\nerror at the amplitude: {}\n", ErrorsInWords(conversion.at_amplitude));
  if (options.range) {
    text += fmt::format("largest from {:.4g} to {:.4g} m: {}\n", options.range->lower,
                        options.range->upper, ErrorsInWords(conversion.largest));
  }
  if (!conversion.within) {
    return text + fmt::format("not within {} at the amplitude\n", Percent(options.tolerance));
  }
  return text + fmt::format("force and energy within {} from {:.4g} to {:.4g} m\n",
                            Percent(options.tolerance), conversion.within->lower,
                            conversion.within->upper);
}

std::vector<std::string> InputLines(const ConvertedContact& converted) {
  return convert::InputLines(converted.conversion, converted.target.target,
                             converted.request.normal);
}

}  // namespace mindahl::request
