#include "cli/precision_table.h"

#include <fmt/format.h>

#include "cli/json_output.h"
#include "mindahl/methods/method.h"

namespace mindahl::cli {
namespace {

std::string Error(double error) { return fmt::format("{:.1e}", error); }

}  // namespace

std::string PrecisionTableHead() {
  return fmt::format("{:<50} {:>10} {:>8}  {:>8} {:>8} {:>8}", "", "ns/sample", "x floor", "max dT",
                     "rms dT", "energy");
}

std::string PrecisionTableRow(const tradeoff::WorkPrecision& point, double floor) {
  return fmt::format("{:<50} {:>10.2f} {:>8.1f}  {:>8} {:>8} {:>8}",
                     tradeoff::Describe(point.approximation), point.cost, point.cost / floor,
                     Error(point.precision.max_force), Error(point.precision.rms_force),
                     point.precision.energy ? Error(*point.precision.energy) : "-");
}

nlohmann::ordered_json PrecisionJson(const tradeoff::WorkPrecision& point) {
  const tradeoff::Approximation& approximation = point.approximation;
  nlohmann::ordered_json json;
  json["model"] = approximation.model;
  json["method"] = nullptr;
  json["steps"] = nullptr;
  json["tolerance"] = nullptr;
  if (const methods::Method* method = methods::FindMethod(approximation.method)) {
    json["method"] = approximation.method;
    if (!method->steps.empty()) json["steps"] = approximation.resolution.steps;
    if (method->adaptive) json["tolerance"] = approximation.resolution.tolerance;
  }
  json["cost_ns_per_sample"] = point.cost;
  json["max_force_error"] = point.precision.max_force;
  json["rms_force_error"] = point.precision.rms_force;
  json["energy_error"] = NumberOrNull(point.precision.energy);
  return json;
}

}  // namespace mindahl::cli
