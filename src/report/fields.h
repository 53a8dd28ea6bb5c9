#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/report/report.h"

// The fields of the JSON, one row each, from which details of the text and of the page and the
// table of docs/contract.md are made too.
namespace mindahl::report {

using Json = nlohmann::ordered_json;

/// Returns a number, or null where it is missing or not finite: JSON has no other way to say so.
inline Json NumberOrNull(const std::optional<double>& number) {
  return number && std::isfinite(*number) ? Json(*number) : Json();
}

/// Returns what a place of a document has, "/model", null where there is no such place.
inline Json At(const Json& document, std::string_view place) {
  const Json::json_pointer pointer{std::string(place)};
  return document.contains(pointer) ? document[pointer] : Json();
}

/// Returns a list of what a function makes of each row.
template <typename Rows, typename Make>
Json ListOf(const Rows& rows, Make make) {
  Json list = Json::array();
  for (const auto& row : rows) list.push_back(make(row));
  return list;
}

/// Returns a document as the program writes it, with the end of line. A file name need not be
/// UTF-8; JSON must.
inline std::string Dump(const Json& json) {
  return json.dump(2, ' ', /*ensure_ascii=*/false, Json::error_handler_t::replace) + "\n";
}

/// Returns the document that a command writes with --json: its schema, "mindahl.plan/1", and the
/// version of the program before its members.
std::string Document(std::string_view schema, const Json& members);

/// One row of the report.
struct Field {
  std::string_view path;     ///< "residuals.rms"
  std::string_view unit;     ///< unit of a force; "" of a text, "-" of a ratio
  std::string_view meaning;  ///< in words
  /// Makes the value, null where there is none; it may be a list or an object of any depth.
  Json (*get)(const Report&);
  std::string_view why_null = {};  ///< why it, or a member of it, is null
};

const std::vector<Field>& Fields();

/// Returns the numbers and words in a section of the JSON, "rms 0.4 N", behind their names and with
/// their units; none of what is null or has members.
std::vector<std::string> ValuesUnder(const Report& report, std::string_view section);

/// Returns the samples of each record that do not count.
std::vector<LeftOut> DescribeLeftOut(const Report& report);

/// Returns the parameters in addition to the law's, offsets apart, that are fitted or held.
std::vector<const identification::ParameterEstimate*> AddedTerms(const Report& report);

}  // namespace mindahl::report
