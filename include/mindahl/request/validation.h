#pragma once

#include <string>

#include "mindahl/identification/mapping_validation.h"

namespace mindahl::request {

/// A sweep of identification::ValidateMapping() and what it was asked.
struct Validation {
  identification::ValidationOptions options;
  identification::ValidationReport report;
};

/// Returns the JSON of schema mindahl.validate/1, as `mindahl validate --json` writes it.
std::string ToJson(const Validation& validation);

/// Returns the tables and the verdict as `mindahl validate` prints them.
std::string ToText(const Validation& validation);

}  // namespace mindahl::request
