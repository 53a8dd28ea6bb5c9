#include "mindahl/report/json.h"

#include <utility>
#include <variant>

#include "report/fields.h"
#include "report/json_document.h"

namespace mindahl::report {
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
