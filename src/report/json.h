#pragma once

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "mindahl/report/report.h"

// The JSON of what the commands answer, and the texts and tables that are made of it.
namespace mindahl::report {

using Json = nlohmann::ordered_json;

/// Returns a number, or null where it is missing or not finite: JSON has no other way to say so.
inline Json NumberOrNull(const std::optional<double>& number) {
  return number && std::isfinite(*number) ? Json(*number) : Json();
}

/// Names the parameters of a law in every JSON.
inline constexpr std::array kLawParameters = {"sigma", "alpha", "slip_force"};
/// Returns the parameters of a law by these names.
inline Json LawJson(const models::BranchLaw& law) {
  return {{"sigma", NumberOrNull(law.tangential_stiffness)},
          {"alpha", NumberOrNull(law.shape_exponent)},
          {"slip_force", NumberOrNull(law.slip_force)}};
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

/// Returns a document as the program writes it, with an end of line; replaces what is not UTF-8.
inline std::string Dump(const Json& json) {
  return json.dump(2, ' ', /*ensure_ascii=*/false, Json::error_handler_t::replace) + "\n";
}

/// Returns the document of --json: schema, "mindahl.plan/1", and version before its members.
std::string Document(std::string_view schema, const Json& members);

// --- tables. A row is an object of the JSON, whose members are its cells; rows are a list of such
// or an object of them, whose keys are then the first column. Of a member that is an object the
// members are cells; lists are none. So one maker of rows serves JSON, text, CSV and page.

/// Returns a cell for people: a number, "yes" or "no", "-" of null.
std::string CellText(const Json& value, int digits = 5);

/// Returns the rows as aligned columns below their names; "" of none.
std::string TableText(const Json& rows, int digits = 5);

/// Returns the rows as CSV with every digit, nothing where a member is null.
std::string TableCsv(const Json& rows);

/// Returns the rows as a table of a page; "" of none.
std::string TableHtml(std::string_view caption, const Json& rows);

// --- the JSON of a fit, from which details of the text and of the page are made too

/// Returns the members of the document that ToJson() writes.
Json DocumentOf(const Report& report);

/// Returns a row for each model that was compared and converged, the best first.
Json ComparedModels(const Report& report);

/// Returns the parameters in addition to the law's, offsets apart, that are fitted or held.
std::vector<const identification::ParameterEstimate*> AddedTerms(const Report& report);

}  // namespace mindahl::report
