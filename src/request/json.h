#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::request {

using Json = nlohmann::ordered_json;

/// Returns a number, or null where it is missing or not finite: JSON has no other way to say so.
inline Json NumberOrNull(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json();
}

/// Returns a document as the program writes it, with the end of line. A file name need not be
/// UTF-8; JSON must.
inline std::string Dump(const Json& json) {
  return json.dump(2, ' ', /*ensure_ascii=*/false, Json::error_handler_t::replace) + "\n";
}

/// Head of a table of approximations with their cost and errors.
/// @param is_timed  there is a column of what was measured
std::string PrecisionTableHead(bool is_timed);

/// One row of it, without an end of line.
/// @param floor  the arithmetic floor [ns/sample] that modelled costs are compared with
std::string PrecisionTableRow(const tradeoff::WorkPrecision& point, double floor);

/// Names the parameters of a refitted model that are its own: "sigma 3.6e+08, Tc 32.7".
std::string RefittedParameters(const tradeoff::Approximation& approximation);

/// {"model", "method", "steps", "tolerance", "cost_ns_per_sample", "max_force_error", …}
Json PrecisionJson(const tradeoff::WorkPrecision& point);

/// {"sigma", "alpha", "slip_force"}
Json LawJson(const models::BranchLaw& law);

/// {"memory_ns_per_sample", "arithmetic_ns_per_sample"}
Json FloorJson(const tradeoff::CostFloor& floor);

}  // namespace mindahl::request
