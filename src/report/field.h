#pragma once

#include <functional>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "report/value.h"

namespace mindahl::report {

/// One row of a report: a new field is one of these.
template <typename Item>
struct Field {
  using Get = std::function<Value(const Item&)>;
  using WhyNull = std::function<std::string(const Item&)>;

  Field(std::string row_path, std::string row_unit, std::string row_label, Get getter,
        WhyNull reason = nullptr)
      : path(std::move(row_path)),
        unit(std::move(row_unit)),
        label(std::move(row_label)),
        get(std::move(getter)),
        why_null(std::move(reason)) {}

  std::string path;   ///< from the item: "loop.amplitude", "ci95[0]"
  std::string unit;   ///< "" for a text, "-" for a ratio
  std::string label;  ///< description in words
  Get get;
  WhyNull why_null;  ///< asked where `get` gives a null
};

template <typename Item>
Value::Object Render(const std::vector<Field<Item>>& fields, const Item& item) {
  Value::Object object;
  for (const Field<Item>& field : fields) {
    Value value = field.get(item);
    if (std::holds_alternative<Value::Absent>(value.content)) continue;
    auto* const null = std::get_if<Value::Null>(&value.content);
    if (null != nullptr && null->why.empty()) {
      null->why = field.why_null ? field.why_null(item) : "not a finite number";
    }
    Place(object, field.path, std::move(value));
  }
  return object;
}

/// Returns a list with one entry for each item.
template <typename Item>
Value List(const std::vector<Field<Item>>& fields, const std::vector<Item>& items) {
  Value::Array array;
  for (const Item& item : items) array.push_back({Render(fields, item)});
  return {std::move(array)};
}

}  // namespace mindahl::report
