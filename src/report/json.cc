#include <cmath>
#include <string>
#include <utility>

#include "mindahl/report/report.h"
#include "report/fields.h"

namespace mindahl::report {

namespace {

/// Adds the nulls of a member, by their paths from the whole.
void AddNulls(std::vector<NullPlace>& nulls, std::string_view path, std::vector<NullPlace> more) {
  for (NullPlace& null : more) {
    const bool is_name = !null.path.empty() && !null.path.starts_with('[');
    null.path.insert(0, is_name ? std::string(path) + "." : std::string(path));
    nulls.push_back(std::move(null));
  }
}

}  // namespace

Value Number(std::optional<double> number) {
  if (!number || !std::isfinite(*number)) return Missing();
  return {.json = *number, .is_absent = false};
}

Value Missing(std::string why) { return {.nulls = {{"", std::move(why)}}, .is_absent = false}; }

Json::json_pointer PointerTo(std::string_view path) {
  std::string pointer = "/";
  for (const char character : path) {
    if (character != ']') pointer += character == '.' || character == '[' ? '/' : character;
  }
  return Json::json_pointer(pointer);
}

void Value::Place(std::string_view path, Value value) {
  json[PointerTo(path)] = std::move(value.json);
  AddNulls(nulls, path, std::move(value.nulls));
}

void Value::Set(const std::string& key, Value value) {
  json[key] = std::move(value.json);
  AddNulls(nulls, key, std::move(value.nulls));
}

void Value::Add(const Value& members) {
  json.update(members.json);
  nulls.insert(nulls.end(), members.nulls.begin(), members.nulls.end());
}

void Value::Append(Value value) {
  AddNulls(nulls, "[" + std::to_string(json.size()) + "]", std::move(value.nulls));
  json.push_back(std::move(value.json));
}

std::string ToJson(const Report& report) {
  // A file name need not be UTF-8; JSON must.
  const auto replace = Json::error_handler_t::replace;
  return JsonDocument(report).dump(2, ' ', /*ensure_ascii=*/false, replace) + "\n";
}

}  // namespace mindahl::report
