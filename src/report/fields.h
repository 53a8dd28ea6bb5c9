#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "mindahl/report/report.h"
#include "report/value.h"

namespace mindahl::report {

/// A quantity of the contact that the fit and what is known besides it identify together.
struct ContactField {
  std::string_view key;
  std::string_view unit;
  std::string_view label;
  std::string_view formula;
  std::optional<PropagatedValue> (*get)(const Report&);
  std::string (*why_null)(const Report&);
};

/// In the order of the reports.
const std::vector<ContactField>& ContactFields();

/// The whole report as keys and values.
Value::Object Document(const Report& report);

}  // namespace mindahl::report
