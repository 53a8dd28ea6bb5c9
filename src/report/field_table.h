#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <utility>
#include <vector>

#include "mindahl/contact/mindlin_dahl_mapping.h"
#include "mindahl/report/report.h"
#include "report/fields.h"
#include "report/names.h"

namespace mindahl::report {

/// A quantity of the contact: null, or a value with its error and where that comes from.
struct PropagatedQuantity {
  std::optional<contact::PropagatedValue> value;
  std::string_view unit;
};

/// A number that may be null: in an object that may be absent, or for a reason of its own.
struct OrNull {
  std::optional<double> number = {};
  std::string why = {};  ///< empty: that of the row
};

/// Returns the members of a quantity, or a null for which the row has the reason.
Value ToMembers(const PropagatedQuantity& quantity);

/// Returns a value of any of the types that reports have.
template <typename Content>
Value ToValue(const Content& content) {
  if constexpr (std::is_same_v<Content, Value>) {
    return content;
  } else if constexpr (std::is_same_v<Content, PropagatedQuantity>) {
    return ToMembers(content);
  } else if constexpr (std::is_same_v<Content, OrNull>) {
    return content.number ? Number(content.number) : Missing(content.why);
  } else if constexpr (requires { content.has_value(); }) {
    return content ? ToValue(*content) : Missing();
  } else if constexpr (std::is_floating_point_v<Content>) {
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

template <typename Content>
struct WithoutOptional {
  using Type = Content;
  static constexpr bool kIsOptional = false;
};
template <typename Content>
struct WithoutOptional<std::optional<Content>> {
  using Type = Content;
  static constexpr bool kIsOptional = true;
};

/// Tells what a getter returns of an item.
template <typename Getter, typename Item>
struct Result : WithoutOptional<std::remove_cvref_t<std::invoke_result_t<Getter, const Item&>>> {
  static constexpr bool kMayBeAbsent = false;
};

/// Tells what Follow() ends at.
template <typename Item, typename Member, typename... More>
struct End : Result<Member, Item> {};
template <typename Item, typename Member, typename Next, typename... More>
struct End<Item, Member, Next, More...> : End<typename Result<Member, Item>::Type, Next, More...> {
  static constexpr bool kIsOptional =
      Result<Member, Item>::kIsOptional ||
      End<typename Result<Member, Item>::Type, Next, More...>::kIsOptional;
};

/// A getter of a member of a member.
template <bool kIsAbsent, typename... Members>
struct MemberGetter {
  std::tuple<Members...> members;

  template <typename Item>
  Value operator()(const Item& item) const {
    return std::apply(
        [&item](const auto&... member) {
          return Follow(kIsAbsent ? Value{} : Missing(), item, member...);
        },
        members);
  }
};

template <bool kIsAbsent, typename... Members, typename Item>
struct Result<MemberGetter<kIsAbsent, Members...>, Item> : End<Item, Members...> {
  static constexpr bool kMayBeAbsent = kIsAbsent && End<Item, Members...>::kIsOptional;
};

/// Makes a getter of a member of a member: null where one on the way is empty.
template <typename... Members>
MemberGetter<false, Members...> At(Members... members) {
  return {{members...}};
}

/// Makes the same, absent where one on the way is empty.
template <typename... Members>
MemberGetter<true, Members...> IfAny(Members... members) {
  return {{members...}};
}

/// Returns the whole where a condition holds, for At() to go on from.
template <typename Whole>
std::optional<std::reference_wrapper<const Whole>> If(bool holds, const Whole& whole) {
  return holds ? std::optional(std::cref(whole)) : std::nullopt;
}

/// Returns the JSON schema of a type of value, without its null.
template <typename Content>
Json SchemaOf() {
  using Bare = WithoutOptional<Content>::Type;
  if constexpr (std::is_same_v<Content, Value>) {
    return Json::object();
  } else if constexpr (std::is_same_v<Content, PropagatedQuantity>) {
    return {{"type", "quantity"}};
  } else if constexpr (std::is_same_v<Bare, bool>) {
    return {{"type", "boolean"}};
  } else if constexpr (std::is_unsigned_v<Bare>) {
    return {{"type", "integer"}, {"minimum", 0}};
  } else if constexpr (std::is_integral_v<Bare>) {
    return {{"type", "integer"}};
  } else if constexpr (std::is_enum_v<Bare>) {
    return {{"enum", kNamesOf<Bare>}};
  } else if constexpr (std::is_convertible_v<Content, std::string_view>) {
    return {{"type", "string"}};
  } else if constexpr (requires(const Content& content) { content.begin(); }) {
    using Element = Content::value_type;
    Json schema = {{"type", "array"}, {"items", SchemaOf<Element>()}};
    schema["items"]["null"] = WithoutOptional<Element>::kIsOptional;
    if constexpr (requires { std::tuple_size<Content>::value; }) {
      schema["minItems"] = schema["maxItems"] = std::tuple_size_v<Content>;
    }
    return schema;
  } else {
    return {{"type", "number"}};
  }
}

/// Marks a row without a reason: its value is always there, unless the whole is not.
struct NoReason {};

/// One row of a report: a new field is one of these. Its type is that of what the getter returns;
/// it may be null if that is optional or a reason is given, and absent if IfAny() gets it.
template <typename Item>
struct Field : FieldDescription {
  /// @param row_path  from the item: "loop.amplitude", "ci95[0]"
  /// @param getter  a member of the item, or a function of it that returns a value
  /// @param reason  why the value is null: a text, or a function of the item
  template <typename Getter, typename Reason = NoReason>
  Field(std::string row_path, std::string row_unit, std::string row_label, Getter getter,
        Reason reason = {})
      : FieldDescription{.path = std::move(row_path),
                         .unit = std::move(row_unit),
                         .label = std::move(row_label),
                         .type = SchemaOf<typename Result<Getter, Item>::Type>(),
                         .may_be_null =
                             !std::is_same_v<Reason, NoReason> ||
                             std::is_same_v<typename Result<Getter, Item>::Type, OrNull> ||
                             (Result<Getter, Item>::kIsOptional &&
                              !Result<Getter, Item>::kMayBeAbsent),
                         .may_be_absent = Result<Getter, Item>::kMayBeAbsent},
        get([getter](const Item& item) { return ToValue(std::invoke(getter, item)); }) {
    if constexpr (std::is_same_v<Reason, NoReason>) {
      why_null = [](const Item&) { return std::string("not a finite number"); };
    } else if constexpr (std::is_convertible_v<Reason, std::string>) {
      why_null = [why = std::string(reason)](const Item&) { return why; };
    } else {
      why_null = reason;
    }
  }

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
    for (const FieldDescription& field : fields) {
      items.push_back(field);
      items.back().path.insert(0, prefix);
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
void AddLoopFields(FieldTable& table);
void AddContactFields(FieldTable& table);
void AddMappingFields(FieldTable& table);
void AddLoadSeriesFields(FieldTable& table);

/// Why there is no contact behind a torque.
inline constexpr const char* kWhyNoContact =
    "of a torque against an angle: Hertz, Mindlin and the mapping are of a force along the contact";

/// Why a load series has no ρ and no p₀.
inline constexpr const char* kWhyNoSphere =
    "of Hertz's law, σ ∝ N^(1/3), which the load series denies";

std::string WhyFailed(const Report& report);

/// Returns the rows of a quantity whose error comes from the fit and from inputs.
const std::vector<Field<contact::PropagatedValue>>& PropagatedFields();

/// Returns those rows, with the unit of the quantity, which the table does not know.
Value PropagatedMembers(const contact::PropagatedValue& value, std::string_view unit);

}  // namespace mindahl::report
