#pragma once

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

namespace mindahl::request {

using Json = nlohmann::ordered_json;

/// Returns a number, or null where it is missing or not finite: JSON has no other way to say so.
inline Json NumberOrNull(std::optional<double> value) {
  return value && std::isfinite(*value) ? Json(*value) : Json();
}

/// Returns a document as the program writes it, with the end of line. A file name need not be
/// UTF-8; JSON must.
inline std::string Dump(const Json& json) {
  return json.dump(2, ' ', /*ensure_ascii=*/false, Json::error_handler_t::replace) + "\n";
}

}  // namespace mindahl::request
