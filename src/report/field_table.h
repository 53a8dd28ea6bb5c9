#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/report/report.h"
#include "report/fields.h"
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

/// Every row of the report, and of the items that it lists.
struct FieldTable {
  std::vector<Field<Report>> rows;
  std::vector<FieldDescription> items;  ///< fields of the items that the rows list

  void Add(std::vector<Field<Report>> more) {
    for (Field<Report>& row : more) rows.push_back(std::move(row));
  }
  template <typename Item>
  void Describe(const std::string& prefix, const std::vector<Field<Item>>& fields) {
    for (const Field<Item>& field : fields) {
      items.push_back({prefix + field.path, field.unit, field.label});
    }
  }
};

// Each adds the rows of its subject, in the order of the JSON.
void AddAdequacyFields(FieldTable& table);
void AddMeasuredFields(FieldTable& table);
void AddParameterFields(FieldTable& table);
void AddSlipForceFields(FieldTable& table);
void AddResidualFields(FieldTable& table);
void AddSelectionFields(FieldTable& table);
void AddSolverFields(FieldTable& table);
void AddLawFields(FieldTable& table);
void AddMemoryFields(FieldTable& table);
void AddLoopFields(FieldTable& table);
void AddContactFields(FieldTable& table);
void AddMappingFields(FieldTable& table);
void AddLoadSeriesFields(FieldTable& table);
void AddBackboneFields(FieldTable& table);

/// Why there is no contact behind a torque.
inline constexpr const char* kWhyNoContact =
    "of a torque against an angle: Hertz, Mindlin and the mapping are of a force along the contact";

/// Why a load series has no ρ and no p₀.
inline constexpr const char* kWhyNoSphere =
    "of Hertz's law, σ ∝ N^(1/3), which the load series denies";

/// Returns why nothing of a fit that failed is there.
std::string WhyFailed(const Report& report);

/// Returns the rows of a quantity whose error comes from the fit and from inputs.
const std::vector<Field<contact::PropagatedValue>>& PropagatedFields();

/// Returns those rows, with the unit of the quantity, which the table does not know.
Value::Object PropagatedMembers(const contact::PropagatedValue& value, std::string_view unit);

/// Returns the same, or a null for which the row has the reason.
Value Propagated(const std::optional<contact::PropagatedValue>& value, std::string_view unit);

}  // namespace mindahl::report
