#include "mindahl/request/sweep.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/core/version.h"
#include "report/names.h"
#include "report/statements.h"
#include "request/json.h"

namespace mindahl::request {

using identification::ParameterEstimate;
using identification::SweepFit;
using identification::SweepOptions;

namespace {

/// Chance of correlated residuals below which a sweep is doubtful.
constexpr double kDoubtfulCorrelation = 0.01;

std::string_view KindOf(const SweepOptions& options) {
  return options.stiffness == identification::SweepStiffness::kTangent ? "tangent" : "secant";
}

bool IsHeld(const ParameterEstimate& parameter) {
  return parameter.status == identification::ParameterStatus::kFixed;
}

}  // namespace

bool FittedSweep::is_doubtful() const { return fit.correlation_p_value < kDoubtfulCorrelation; }

bool FittedSweep::established(Strictness strictness) const {
  if (!fit.converged || strictness == Strictness::kNone) return fit.converged;
  return std::ranges::all_of(fit.parameters, &ParameterEstimate::is_known) &&
         (!is_doubtful() || strictness != Strictness::kAdequate);
}

FittedSweep FitSweep(const FitRequest& request, const std::string& file, io::SweepFile sweep,
                     const std::string& kind, const Tell& note) {
  constexpr std::array<std::string_view, 2> kKinds = {"secant", "tangent"};
  RequireOneOf("--sweep", kind, kKinds);
  const std::string_view model =
      request.fit.model == nullptr ? "mindlin-dahl" : std::string_view(request.fit.model->name);
  if (model != "mindlin-dahl" && model != "mindlin" && model != "jenkins") {
    throw InputError(fmt::format(
        "--model {}: a sweep needs a Masing law: mindlin-dahl, mindlin or jenkins", model));
  }
  FittedSweep fitted{.file = file, .sweep = std::move(sweep)};
  for (const std::string& text : fitted.sweep.notes) note(text);
  SweepOptions& asked = fitted.asked;
  asked.stiffness = kind == "tangent" ? identification::SweepStiffness::kTangent
                                      : identification::SweepStiffness::kSecant;
  asked.over_force = fitted.sweep.over_force;
  asked.is_compliance = fitted.sweep.is_compliance;
  asked.confidence = request.fit.confidence;
  if (model == "mindlin") asked.fixed["alpha"] = 1.0 / 3.0;
  if (model == "jenkins") asked.fixed["alpha"] = 0.0;
  for (const auto& [name, value] : MakeFitOptions(request).fixed) asked.fixed[name] = value;
  fitted.fit = identification::FitSweep(fitted.sweep.amplitude, fitted.sweep.response, asked);
  return fitted;
}

FittedSweep FitSweepFile(const FitRequest& request, const std::string& kind,
                         const std::string& response, const Tell& note) {
  if (request.files.size() != 1) {
    throw InputError("--sweep: takes one file: fit each by itself");
  }
  const std::string& file = request.files.front();
  return FitSweep(request, file, io::ReadSweep(file, request.columns, response), kind, note);
}

std::string ToJson(const FittedSweep& fitted) {
  const io::SweepFile& sweep = fitted.sweep;
  const SweepFit& fit = fitted.fit;
  Json json = {{"schema", "mindahl.sweep/1"},
               {"version", Version()},
               {"input",
                {{"files", {fitted.file}},
                 {"points", sweep.amplitude.size()},
                 {"amplitude", sweep.over_force ? "force" : "displacement"},
                 {"response", sweep.is_compliance ? "compliance" : "stiffness"}}},
               {"sweep", KindOf(fitted.asked)},
               {"confidence", fitted.asked.confidence}};
  for (const ParameterEstimate& parameter : fit.parameters) {
    json["parameters"][parameter.name] = {
        {"value", NumberOrNull(parameter.value)},
        {"unit", parameter.unit},
        {"standard_error", NumberOrNull(parameter.standard_error)},
        {"ci95", {NumberOrNull(parameter.lower95), NumberOrNull(parameter.upper95)}},
        {"status", report::Name(parameter.status)},
        {"identifiability",
         IsHeld(parameter) ? Json() : Json(report::Name(parameter.identifiability))}};
  }
  json["residuals"] = {{"rms", NumberOrNull(fit.rms)},
                       {"r_squared", NumberOrNull(fit.r_squared)},
                       {"degrees_of_freedom", fit.degrees_of_freedom},
                       {"correlation_p_value", NumberOrNull(fit.correlation_p_value)}};
  json["adequacy"] = {{"verdict", fitted.is_doubtful() ? "doubtful" : "adequate"}};
  json["solver"] = {
      {"solver", "ceres::Solve"}, {"converged", fit.converged}, {"message", fit.message}};
  return Dump(json);
}

std::string ToText(const FittedSweep& fitted) {
  const io::SweepFile& sweep = fitted.sweep;
  const SweepFit& fit = fitted.fit;
  std::string text =
      fmt::format("{} of {} points over the {} amplitude, {}\n\n",
                  sweep.is_compliance ? "compliance" : "stiffness", sweep.amplitude.size(),
                  sweep.over_force ? "force" : "displacement", KindOf(fitted.asked));
  for (const ParameterEstimate& parameter : fit.parameters) {
    text += fmt::format("  {:<12}{}\n", parameter.name, report::ValueText(parameter));
  }
  text += fmt::format("\n  residuals {:.4g} {} rms, R² {:.6g}\n", fit.rms,
                      sweep.is_compliance ? "m/N" : "N/m", fit.r_squared);
  if (fitted.is_doubtful()) {
    text += fmt::format(
        "  doubtful: neighbouring residuals are correlated (p = {:.2g}), so the law misses the "
        "shape of the sweep and the intervals are too narrow\n",
        fit.correlation_p_value);
  }
  if (!fit.converged) text += fmt::format("  not converged: {}\n", fit.message);
  return text;
}

}  // namespace mindahl::request
