#include "report/value.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

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

}  // namespace mindahl::report
