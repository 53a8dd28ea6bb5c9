#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/report/report.h"
#include "report/fields.h"
#include "report/names.h"

namespace mindahl::report {

/// Returns a value of any of the types that reports have.
template <typename Content>
Value ToValue(const Content& content) {
  if constexpr (std::is_same_v<Content, Value>) {
    return content;
  } else if constexpr (std::is_convertible_v<Content, std::optional<double>> &&
                       !std::is_integral_v<Content>) {
    return Number(content);
  } else if constexpr (std::is_enum_v<Content>) {
    return {.json = Name(content), .is_absent = false};
  } else if constexpr (requires { content.begin(); } &&
                       !std::is_convertible_v<Content, std::string_view>) {
    Value list{.json = Json::array(), .is_absent = false};
    for (const auto& element : content) list.Append(ToValue(element));
    return list;
  } else {
    return {.json = content, .is_absent = false};
  }
}

/// Returns a member of a member, `empty` where an optional one is empty on the way.
template <typename Item, typename Member, typename... More>
Value Follow(const Value& empty, const Item& item, Member member, More... more) {
  const auto& found = std::invoke(member, item);
  if constexpr (requires { found.has_value(); }) {
    if (!found) return empty;
    if constexpr (sizeof...(more) > 0) {
      return Follow(empty, *found, more...);
    } else {
      return ToValue(*found);
    }
  } else if constexpr (sizeof...(more) > 0) {
    return Follow(empty, found, more...);
  } else {
    return ToValue(found);
  }
}

/// Makes a getter of a member of a member: null where one on the way is empty.
template <typename... Members>
auto At(Members... members) {
  return [members...](const auto& item) { return Follow(Missing(), item, members...); };
}

/// Makes the same, absent where one on the way is empty.
template <typename... Members>
auto IfAny(Members... members) {
  return [members...](const auto& item) { return Follow(Value{}, item, members...); };
}

/// One row of a report: a new field is one of these.
template <typename Item>
struct Field {
  /// @param getter  a member of the item, or a function of it that returns a value
  /// @param reason  why the value is null: a text, or a function of the item
  template <typename Getter, typename Reason = const char*>
  Field(std::string row_path, std::string row_unit, std::string row_label, Getter getter,
        Reason reason = "not a finite number")
      : path(std::move(row_path)),
        unit(std::move(row_unit)),
        label(std::move(row_label)),
        get([getter](const Item& item) { return ToValue(std::invoke(getter, item)); }) {
    if constexpr (std::is_convertible_v<Reason, std::string>) {
      why_null = [why = std::string(reason)](const Item&) { return why; };
    } else {
      why_null = reason;
    }
  }

  std::string path;   ///< from the item: "loop.amplitude", "ci95[0]"
  std::string unit;   ///< "" for a text, "-" for a ratio
  std::string label;  ///< description in words
  std::function<Value(const Item&)> get;
  std::function<std::string(const Item&)> why_null;  ///< asked where `get` gives a null
};

template <typename Item>
Value Render(const std::vector<Field<Item>>& fields, const Item& item) {
  Value object{.json = Json::object(), .is_absent = false};
  for (const Field<Item>& field : fields) {
    Value value = field.get(item);
    if (value.is_absent) continue;
    if (value.json.is_null() && value.nulls.front().why.empty()) {
      value.nulls.front().why = field.why_null(item);
    }
    object.Place(field.path, std::move(value));
  }
  return object;
}

/// Returns a list with one entry for each item.
template <typename Item>
Value List(const std::vector<Field<Item>>& fields, const std::vector<Item>& items) {
  Value list{.json = Json::array(), .is_absent = false};
  for (const Item& item : items) list.Append(Render(fields, item));
  return list;
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
Value PropagatedMembers(const contact::PropagatedValue& value, std::string_view unit);

/// Returns the same, or a null for which the row has the reason.
Value Propagated(const std::optional<contact::PropagatedValue>& value, std::string_view unit);

}  // namespace mindahl::report
