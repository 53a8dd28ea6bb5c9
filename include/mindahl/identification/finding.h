#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mindahl/identification/finding_code.h"

namespace mindahl::identification {

/// Something that a fit found out about a record, a model or a parameter, as data: `report` has the
/// sentence for it.
struct Finding {
  FindingCode code;
  Severity severity = code.row().severity;
  std::vector<std::string> parameters = {};  ///< those that it is about; may be empty
  /// Holds the measured numbers by name, in SI.
  std::vector<std::pair<std::string_view, double>> numbers = {};
  std::string_view kind = {};  ///< which of several forms it takes; empty where there is one only

  /// Returns a number of the finding; empty when it has none of that name.
  [[nodiscard]] std::optional<double> Number(std::string_view name) const {
    for (const auto& [key, value] : numbers) {
      if (key == name) return value;
    }
    return std::nullopt;
  }
};

}  // namespace mindahl::identification
