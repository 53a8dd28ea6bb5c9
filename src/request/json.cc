#include "request/json.h"

#include <fmt/format.h>

#include "mindahl/methods/method.h"

namespace mindahl::request {

namespace {

std::string InOneDigit(double error) { return fmt::format("{:.1e}", error); }

}  // namespace

std::string PrecisionTableHead(bool is_timed) {
  return fmt::format("{:<50} {:>10}{} {:>8}  {:>8} {:>8} {:>8}", "", "ns/sample",
                     is_timed ? fmt::format(" {:>10}", "measured") : "", "x floor", "max dT",
                     "rms dT", "energy");
}

std::string PrecisionTableRow(const tradeoff::WorkPrecision& point, double floor) {
  return fmt::format("{:<50} {:>10.2f}{} {:>8.1f}  {:>8} {:>8} {:>8}",
                     tradeoff::Describe(point.approximation), point.cost,
                     point.measured_cost ? fmt::format(" {:>10.2f}", *point.measured_cost) : "",
                     point.cost / floor, InOneDigit(point.precision.max_force),
                     InOneDigit(point.precision.rms_force),
                     point.precision.energy ? InOneDigit(*point.precision.energy) : "-");
}

std::string RefittedParameters(const tradeoff::Approximation& approximation) {
  const models::BranchLaw& law = *approximation.law;
  if (approximation.model == "spring") {
    return fmt::format("sigma = {:.5g} N/m", law.tangential_stiffness);
  }
  if (approximation.model == "coulomb") return fmt::format("Tc = {:.5g} N", law.slip_force);
  return fmt::format("sigma = {:.5g} N/m and Tc = {:.5g} N", law.tangential_stiffness,
                     law.slip_force);
}

Json PrecisionJson(const tradeoff::WorkPrecision& point) {
  const tradeoff::Approximation& approximation = point.approximation;
  Json json;
  json["model"] = approximation.model;
  json["method"] = nullptr;
  json["steps"] = nullptr;
  json["tolerance"] = nullptr;
  if (const methods::Method* method = methods::FindMethod(approximation.method)) {
    json["method"] = approximation.method;
    if (!method->steps.empty()) json["steps"] = approximation.resolution.steps;
    if (method->adaptive) json["tolerance"] = approximation.resolution.tolerance;
  }
  json["refitted"] = nullptr;
  if (approximation.law) {
    const models::BranchLaw& law = *approximation.law;
    json["refitted"] =
        LawJson({.tangential_stiffness = law.tangential_stiffness,
                 .shape_exponent = tradeoff::LawOf(approximation, law).shape_exponent,
                 .slip_force = law.slip_force});
    if (approximation.model == "spring") {
      json["refitted"] = {{"sigma", law.tangential_stiffness}};
    } else if (approximation.model == "coulomb") {
      json["refitted"] = {{"slip_force", law.slip_force}};
    }
  }
  json["cost_ns_per_sample"] = point.cost;
  json["measured_ns_per_sample"] = NumberOrNull(point.measured_cost);
  json["operations_per_sample"] = Json::object();
  const double samples = point.operations[methods::Operation::kSample];
  for (std::size_t i = 0; i < methods::kOperations; ++i) {
    const auto operation = static_cast<methods::Operation>(i);
    const double count = point.operations[operation];
    if (count > 0) {
      json["operations_per_sample"][std::string(methods::NameOf(operation))] = count / samples;
    }
  }
  json["max_force_error"] = point.precision.max_force;
  json["rms_force_error"] = point.precision.rms_force;
  json["energy_error"] = NumberOrNull(point.precision.energy);
  return json;
}

Json LawJson(const models::BranchLaw& law) {
  return {{"sigma", law.tangential_stiffness},
          {"alpha", law.shape_exponent},
          {"slip_force", law.slip_force}};
}

Json FloorJson(const tradeoff::CostFloor& floor) {
  return {{"memory_ns_per_sample", floor.memory}, {"arithmetic_ns_per_sample", floor.arithmetic}};
}

}  // namespace mindahl::request
