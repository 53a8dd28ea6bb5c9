#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "cli/app.h"

namespace mindahl::cli {

/// A number, or null where it is missing or not finite: JSON has no other way to say so.
nlohmann::ordered_json NumberOrNull(std::optional<double> value);

/// Writes to a file, whole or not at all, or to standard output for "-".
/// @throws InputError when the file cannot be written
void WriteJson(const nlohmann::ordered_json& json, const std::string& path, Console& console);

}  // namespace mindahl::cli
