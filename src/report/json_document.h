#pragma once

#include <nlohmann/json.hpp>

#include "mindahl/report/report.h"

namespace mindahl::report {

/// Returns the document that ToJson() writes.
nlohmann::ordered_json JsonDocument(const Report& report);

}  // namespace mindahl::report
