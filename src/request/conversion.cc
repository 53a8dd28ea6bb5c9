#include "mindahl/request/conversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <variant>

#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "mindahl/models/friction_model.h"
#include "mindahl/models/steady_loop.h"
#include "request/json.h"

namespace mindahl::request {

using convert::LoopError;
using convert::Parameter;
using convert::TargetRow;
using methods::IwanElements;

namespace {

/// A fit as `mindahl fit --json` wrote it.
class WrittenFit {
 public:
  explicit WrittenFit(const std::string& file) : file_(file) {
    std::ifstream stream(file);
    if (!stream) throw InputError(fmt::format("{}: cannot be read", file));
    json_ = Json::parse(stream, nullptr, /*allow_exceptions=*/false);
    const std::string schema = TextAt("/schema");
    if (!schema.starts_with("mindahl.fit/")) {
      throw InputError(fmt::format(
          "{}: is not the result of a fit: give what `mindahl fit --json {}` writes", file, file));
    }
  }

  [[nodiscard]] std::string TextAt(const char* path) const {
    const Json::json_pointer pointer(path);
    return json_.contains(pointer) && json_[pointer].is_string() ? json_[pointer].get<std::string>()
                                                                 : "";
  }

  [[nodiscard]] std::optional<double> NumberAt(const char* path) const {
    const Json::json_pointer pointer(path);
    if (!json_.contains(pointer) || !json_[pointer].is_number()) return std::nullopt;
    return json_[pointer].get<double>();
  }

 private:
  std::string file_;
  Json json_;
};

/// Takes law and amplitude from a fit where they are not given.
void TakeFit(const WrittenFit& fit, ConversionRequest& request) {
  const std::string model = fit.TextAt("/model");
  if (request.from.empty()) request.from = model == "dahl" ? "dahl" : "masing";
  const auto take = [&](std::optional<double>& value, const char* path) {
    if (!value) value = fit.NumberAt(path);
  };
  take(request.sigma, "/parameters/sigma/value");
  take(request.alpha, "/parameters/alpha/value");
  take(request.slip_force, "/parameters/slip_force/value");
  if (request.amplitude || !request.sigma || !request.slip_force) return;
  take(request.amplitude, "/measured/amplitude");
  const std::optional<double> rig = fit.NumberAt("/parameters/rig_stiffness/value");
  if (!rig || !request.amplitude) return;
  // The rest of the amplitude is the rig's.
  request.amplitude = models::ContactAmplitude(
      *models::FindFrictionModel(request.from == "dahl" ? "dahl" : "mindlin-dahl"),
      {*request.sigma, request.alpha.value_or(1.0 / 3), *request.slip_force}, {.stiffness = *rig},
      *request.amplitude);
}

double Require(const std::optional<double>& value, std::string_view option,
               const ConversionRequest& request) {
  if (value) return *value;
  throw InputError(request.fit.empty()
                       ? fmt::format("{} missing: give it, or the JSON file of a fit", option)
                       : fmt::format("{} missing: {} does not determine it", option, request.fit));
}

Json LoopErrorJson(const LoopError& error) {
  return {{"force", NumberOrNull(error.force)}, {"energy", NumberOrNull(error.energy)}};
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
                     made.options.amplitude, Percent(error.force),
                     std::isfinite(error.energy) ? "off by " + Percent(error.energy)
                                                 : "lost where the contact loses none");
}

}  // namespace

ConvertedContact MakeConversion(const ConversionRequest& asked) {
  ConversionRequest request = asked;
  RequireOneOf("--to", request.to, NamesOf(convert::Targets(), &TargetRow::name));
  if (!request.fit.empty()) TakeFit(WrittenFit(request.fit), request);
  if (request.from.empty()) request.from = "masing";
  RequireOneOf("--from", request.from, std::array<std::string_view, 2>{"masing", "dahl"});
  ConvertedContact made{
      .law = {Require(request.sigma, "--sigma", request), request.alpha.value_or(1.0 / 3),
              Require(request.slip_force, "--slip-force", request)},
      .from = request.from,
      .target = *std::ranges::find(convert::Targets(), request.to, &TargetRow::name),
      .options = request.options,
      .normal = request.normal};
  made.options.amplitude = Require(request.amplitude, "--amplitude", request);
  Validate(made.normal, made.target);
  const char* const model = made.from == "dahl" ? "dahl" : "mindlin-dahl";
  made.conversion =
      convert::Convert({models::FindFrictionModel(model), made.law}, made.target, made.options);
  made.parameters = ParametersOf(made.conversion, made.target, made.normal);
  return made;
}

std::string ToJson(const ConvertedContact& made) {
  const convert::Conversion& conversion = made.conversion;
  Json json = {{"schema", "mindahl.convert/1"},
               {"version", Version()},
               {"from",
                {{"law", made.from},
                 {"sigma", made.law.tangential_stiffness},
                 {"alpha", made.law.shape_exponent},
                 {"slip_force", made.law.slip_force}}},
               {"to", made.target.name},
               {"amplitude", made.options.amplitude},
               {"tolerance", made.options.tolerance}};
  json["parameters"] = Json::object();
  for (const Parameter& parameter : made.parameters) {
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
  json["within"] = nullptr;
  if (conversion.within) json["within"] = {conversion.within->lower, conversion.within->upper};
  return Dump(json);
}

std::string ToText(const ConvertedContact& made) {
  const convert::Conversion& conversion = made.conversion;
  std::string text = fmt::format("{}; {}\n\n", made.target.title, ErrorAtAmplitude(made));
  for (const Parameter& parameter : made.parameters) {
    text += fmt::format("{:<14} {:>14.8g} {:<6} {}\n", parameter.name, parameter.value,
                        parameter.unit, parameter.meaning);
  }
  if (const auto* elements = std::get_if<IwanElements>(&conversion.law)) {
    text += fmt::format("\n{:>7} {:>16} {:>16}\n", "element", "stiffness [N/m]", "slip force [N]");
    for (std::size_t j = 0; j < elements->size(); ++j) {
      text += fmt::format("{:>7} {:>16.8g} {:>16.8g}\n", j + 1, elements->stiffness[j],
                          elements->slip_force[j]);
    }
  }
  if (!conversion.within) {
    return text +
           fmt::format("\nnot within {} at the amplitude\n", Percent(made.options.tolerance));
  }
  return text + fmt::format("\nforce and energy within {} from {:.4g} to {:.4g} m\n",
                            Percent(made.options.tolerance), conversion.within->lower,
                            conversion.within->upper);
}

std::vector<std::string> InputLines(const ConvertedContact& made) {
  return convert::InputLines(made.conversion, made.target, made.normal, ErrorAtAmplitude(made));
}

}  // namespace mindahl::request
