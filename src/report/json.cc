#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <variant>

#include "mindahl/report/report.h"
#include "report/fields.h"
#include "report/json_document.h"
#include "report/value.h"

namespace mindahl::report {

namespace {

Value& MemberOf(Value::Object& object, std::string_view key) {
  const auto found = std::ranges::find(object, key, &Value::Member::key);
  if (found != object.end()) return found->value;
  return object.emplace_back(Value::Member{std::string(key), {}}).value;
}

void Collect(const Value& value, const std::string& path, std::vector<NullPlace>& nulls) {
  if (const auto* null = std::get_if<Value::Null>(&value.content)) {
    nulls.push_back({path, null->why});
  } else if (const auto* array = std::get_if<Value::Array>(&value.content)) {
    for (std::size_t i = 0; i < array->size(); ++i) {
      Collect((*array)[i], fmt::format("{}[{}]", path, i), nulls);
    }
  } else if (const auto* object = std::get_if<Value::Object>(&value.content)) {
    for (const auto& [key, member] : *object)
      Collect(member, fmt::format("{}.{}", path, key), nulls);
  }
}

}  // namespace

Value Number(std::optional<double> number) {
  if (!number || !std::isfinite(*number)) return Missing();
  return {*number};
}

Value Count(std::size_t count) { return {static_cast<std::uint64_t>(count)}; }

Value Integer(int number) { return {static_cast<std::int64_t>(number)}; }

Value Flag(bool flag) { return {flag}; }

Value Text(std::string_view text) { return {std::string(text)}; }

Value Missing(std::string why) { return {Value::Null{std::move(why)}}; }

void Place(Value::Object& object, std::string_view path, Value value) {
  const std::size_t end = path.find_first_of(".[");
  Value& member = MemberOf(object, path.substr(0, end));
  if (end == std::string_view::npos) {
    member = std::move(value);
  } else if (path[end] == '.') {
    if (!std::holds_alternative<Value::Object>(member.content)) member.content = Value::Object{};
    Place(std::get<Value::Object>(member.content), path.substr(end + 1), std::move(value));
  } else {
    if (!std::holds_alternative<Value::Array>(member.content)) member.content = Value::Array{};
    auto& array = std::get<Value::Array>(member.content);
    if (path.substr(end) != fmt::format("[{}]", array.size())) {
      throw std::logic_error(fmt::format("'{}' is not the next place of its list", path));
    }
    array.push_back(std::move(value));
  }
}

std::vector<NullPlace> CollectNulls(const Value::Object& object) {
  std::vector<NullPlace> nulls;
  for (const auto& [key, member] : object) Collect(member, key, nulls);
  return nulls;
}

namespace {

using Json = nlohmann::ordered_json;

Json Convert(const Value& value);

struct Converter {
  Json operator()(const Value::Absent&) const { return nullptr; }
  Json operator()(const Value::Null&) const { return nullptr; }
  Json operator()(const Value::Array& array) const {
    Json json = Json::array();
    for (const Value& element : array) json.push_back(Convert(element));
    return json;
  }
  Json operator()(const Value::Object& object) const {
    Json json = Json::object();
    for (const auto& [key, member] : object) json[key] = Convert(member);
    return json;
  }
  template <typename Scalar>
  Json operator()(const Scalar& scalar) const {
    return scalar;
  }
};

Json Convert(const Value& value) { return std::visit(Converter{}, value.content); }

void AppendWarnings(const std::vector<Warning>& warnings, Json& list) {
  for (const Warning& warning : warnings) {
    list.push_back({{"code", warning.code}, {"message", warning.message}});
  }
}

}  // namespace

nlohmann::ordered_json JsonDocument(const Report& report) {
  const Value::Object document = Document(report);
  Json json = Converter{}(document);
  json["nulls"] = Json::array();
  for (const NullPlace& null : CollectNulls(document)) {
    json["nulls"].push_back({{"path", null.path}, {"why", null.why}});
  }
  json["warnings"] = Json::array();
  AppendWarnings(report.fit_warnings, json["warnings"]);
  AppendWarnings(report.contact_warnings, json["warnings"]);
  json["notes"] = Json::array();
  AppendWarnings(report.notes, json["notes"]);
  return json;
}

std::string ToJson(const Report& report) {
  // A file name need not be UTF-8; JSON must.
  const auto replace = Json::error_handler_t::replace;
  return JsonDocument(report).dump(2, ' ', /*ensure_ascii=*/false, replace) + "\n";
}

}  // namespace mindahl::report
