#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "mindahl/tradeoff/work_precision.h"

namespace mindahl::cli {

/// Head of a table of approximations with their cost and errors.
std::string PrecisionTableHead();

/// One row of it, without an end of line.
/// @param floor  the arithmetic floor [ns/sample] that costs are compared with
std::string PrecisionTableRow(const tradeoff::WorkPrecision& point, double floor);

/// {"model", "method", "steps", "tolerance", "cost_ns_per_sample", "max_force_error", …}
nlohmann::ordered_json PrecisionJson(const tradeoff::WorkPrecision& point);

}  // namespace mindahl::cli
