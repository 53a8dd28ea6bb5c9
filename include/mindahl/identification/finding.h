#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mindahl::identification {

/// How much a finding matters to whoever uses the numbers.
enum class Severity {
  kNote,     ///< worth knowing: the answer stands
  kWarning,  ///< something should be done, or part of the answer not be believed
  kFailure,  ///< the answer is not one
};

/// Something that a fit found out about a record, a model or a parameter, as data: `report` has the
/// sentence for it. Codes are stable, for scripts; docs/contract.md lists them.
struct Finding {
  std::string_view code;
  Severity severity = Severity::kWarning;
  std::vector<std::string> parameters = {};  ///< those that it is about; may be empty
  /// What was found, by name, in SI.
  std::vector<std::pair<std::string_view, double>> numbers = {};
  std::string_view kind = {};  ///< which of several forms it takes; empty where there is one only

  /// Empty when the finding has no such number.
  [[nodiscard]] std::optional<double> Number(std::string_view name) const {
    for (const auto& [key, value] : numbers) {
      if (key == name) return value;
    }
    return std::nullopt;
  }
};

}  // namespace mindahl::identification
