#include "cli/json_output.h"

#include <cmath>

#include "cli/text_output.h"

namespace mindahl::cli {

nlohmann::ordered_json NumberOrNull(std::optional<double> value) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return *value;
}

void WriteJson(const nlohmann::ordered_json& json, const std::string& path, Console& console) {
  // A file name need not be UTF-8; JSON must.
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  WriteText(json.dump(2, ' ', /*ensure_ascii=*/false, replace) + "\n", path, console);
}

}  // namespace mindahl::cli
