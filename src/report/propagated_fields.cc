#include "report/propagated_fields.h"

namespace mindahl::report {

using contact::PropagatedValue;

const std::vector<Field<PropagatedValue>>& PropagatedFields() {
  using Item = PropagatedValue;
  static const std::vector<Field<Item>> fields = {
      {"value", "of the quantity", "estimate", [](const Item& item) { return Number(item.value); }},
      {"standard_error", "of the quantity",
       "standard error of the fit and of what is known besides it",
       [](const Item& item) { return Number(item.standard_error); },
       [](const Item&) {
         return std::string("the record leaves open the parameter that it rests on");
       }},
      {"unit", "", "unit of value and error", [](const Item&) { return Text("-"); }},
      {"from_fit", "-", "fraction of the variance from the fit",
       [](const Item& item) { return Number(item.FitShare()); }},
      {"from_inputs", "-", "fraction of the variance from the inputs",
       [](const Item& item) { return Number(item.InputShare()); }},
      {"largest_input", "", "the input that contributes most; absent where all are exact",
       [](const Item& item) {
         return item.largest_input.empty() ? Value{} : Text(item.largest_input);
       }},
  };
  return fields;
}

/// Returns members with the unit of the quantity, which the table does not know.
Value::Object PropagatedMembers(const PropagatedValue& value, std::string_view unit) {
  Value::Object object = Render(PropagatedFields(), value);
  Place(object, "unit", Text(unit));
  return object;
}

Value Propagated(const std::optional<PropagatedValue>& value, std::string_view unit) {
  return value ? Value{PropagatedMembers(*value, unit)} : Missing();
}

}  // namespace mindahl::report
