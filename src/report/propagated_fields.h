#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "report/field.h"

namespace mindahl::report {

/// Returns the rows of a quantity whose error comes from the fit and from inputs.
const std::vector<Field<contact::PropagatedValue>>& PropagatedFields();

/// Returns those rows, with the unit of the quantity, which the table does not know.
Value::Object PropagatedMembers(const contact::PropagatedValue& value, std::string_view unit);

/// Returns the same, or a null for which the row has the reason.
Value Propagated(const std::optional<contact::PropagatedValue>& value, std::string_view unit);

}  // namespace mindahl::report
