#pragma once

#include <optional>
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
  std::optional<contact::PropagatedValue> (*get)(const Report&);
  std::string (*why_null)(const Report&);
};

/// Returns them in the order of the reports.
const std::vector<ContactField>& ContactFields();

/// Describes a field for the documentation.
struct FieldDescription {
  std::string path;  ///< NAME and QUANTITY stand for what they are, [] for every place of a list
  std::string unit;
  std::string label;
};

/// Returns every field that a report may have.
std::vector<FieldDescription> DescribeFields();

/// A number, word or flag of a report, with what the documentation says of it.
struct DescribedValue {
  FieldDescription field;
  Value value;
};

/// Returns the fields of one subject, without its lists: those whose path begins with `prefix`,
/// such as "measured.", with their units in the report.
std::vector<DescribedValue> ValuesUnder(const Report& report, std::string_view prefix);

/// Returns the whole report as keys and values.
Value::Object Document(const Report& report);

}  // namespace mindahl::report
