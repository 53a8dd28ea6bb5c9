#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/report/report.h"

namespace mindahl::report {

using Json = nlohmann::ordered_json;

struct NullPlace {
  std::string path;
  std::string why;
};

/// A value of a report, which may be a list or have members.
struct Value {
  Json json = nullptr;
  std::vector<NullPlace> nulls = {};  ///< in `json`, in their order; path "" is the value itself
  bool is_absent = true;              ///< has no key

  /// Puts a value where a path leads, making the members and lists on the way: "alpha.ci95[1]".
  void Place(std::string_view path, Value value);
  /// Adds or replaces a member whose name is any text.
  void Set(const std::string& key, Value value);
  /// Adds the members of another value.
  void Add(const Value& members);
  void Append(Value value);
};

/// Returns the place in a document that a path leads to: "/alpha/ci95/1" of "alpha.ci95[1]".
[[nodiscard]] Json::json_pointer PointerTo(std::string_view path);

/// Returns a number; of one that is missing or not finite a null, whose reason the row has.
[[nodiscard]] Value Number(std::optional<double> number);
[[nodiscard]] Value Missing(std::string why = {});

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

/// Describes a field for the documentation and for the schema.
struct FieldDescription {
  std::string path;   ///< NAME and QUANTITY stand for what they are, [] for every place of a list
  std::string unit;   ///< "" for a text, "-" for a ratio
  std::string label;  ///< description in words
  Json type = {{"type", "string"}};  ///< JSON schema; empty where its members are fields
  bool may_be_null = false;
  bool may_be_absent = false;
};

/// Returns every field that a report may have.
std::vector<FieldDescription> DescribeFields();

/// A number, word or flag of a report, with what the documentation says of it.
struct DescribedValue {
  FieldDescription field;
  Json value;
};

/// Returns the document that ToJson() writes.
Json JsonDocument(const Report& report);

/// Returns the fields of one subject, without its lists: those whose path begins with `prefix`,
/// such as "measured.", with their units in the report.
/// @param document  JsonDocument() of the report
std::vector<DescribedValue> ValuesUnder(const Report& report, const Json& document,
                                        std::string_view prefix);

}  // namespace mindahl::report
