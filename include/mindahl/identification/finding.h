#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mindahl::identification {

/// Names how much a finding matters to the user of the numbers.
enum class Severity {
  kNote,     ///< worth knowing: the answer is valid
  kAdvice,   ///< the answer is valid; a further measurement would make it sharper
  kWarning,  ///< something should be done, or a part of the answer is not valid
  kFailure,  ///< there is no valid answer
};

/// Names the verdicts on a parameter in the order of precedence: the last of several applies.
enum class Identifiability {
  kIdentifiable,
  kEffective,        ///< the interval is closed and includes what the model, which is not adequate,
                     ///< misses
  kBoundedBelow,     ///< the data give only a lower limit
  kNotIdentifiable,  ///< the data determine it not at all, or only in combination with others
};

/// Describes every finding of one code.
struct FindingRow {
  std::string_view code;  ///< stable, for scripts; docs/contract.md lists them
  /// Verdict that it calls for on the parameters that it names.
  Identifiability verdict = Identifiability::kIdentifiable;
  Severity severity = Severity::kWarning;  ///< unless the finding says otherwise
  bool holds_without_model = false;        ///< it stays where the model is inadequate
};

/// Every finding. A code without a row, or a row without a sentence in `report`, does not compile.
inline constexpr auto kFindings = [] {
  using enum Identifiability;
  using enum Severity;
  return std::to_array<FindingRow>({
      // about the record
      {.code = "reversals_uncertain"},
      {.code = "no_closed_cycle", .severity = kNote},
      {.code = "rows_missing"},
      {.code = "load_varies"},
      // about the identifiability of the parameters
      {"not_identifiable", kNotIdentifiable},
      {"bounded_below", kBoundedBelow},
      {"unknown_past", kNotIdentifiable},
      {"search_limit", kNotIdentifiable},
      {"force_at_limit", kNotIdentifiable, kWarning, true},
      {.code = "shape_or_rig", .severity = kAdvice},
      {.code = "prior_contradicted"},
      // about the law: under its own law a parameter is as well known as before
      {.code = "other_law", .holds_without_model = true},
      // about the model discrepancy
      {"model_inadequate", kNotIdentifiable, kWarning, true},
      // about the search
      {.code = "not_converged"},
  });
}();

/// The code of a finding: one of kFindings, which the compiler sees to.
class FindingCode {
 public:
  consteval FindingCode(const char* code) : row_(&Find(code)) {}
  constexpr explicit FindingCode(const FindingRow& row) : row_(&row) {}

  [[nodiscard]] constexpr const FindingRow& row() const { return *row_; }
  constexpr operator std::string_view() const { return row_->code; }
  friend constexpr bool operator==(FindingCode one, std::string_view other) {
    return one.row_->code == other;
  }

 private:
  static constexpr const FindingRow& Find(std::string_view code) {
    const auto* const row = std::ranges::find(kFindings, code, &FindingRow::code);
    return row != kFindings.end() ? *row : throw "kFindings has no row for this code";
  }

  const FindingRow* row_;
};

/// A finding of a fit about a record, a model or a parameter, as data; `report` has its sentence.
struct Finding {
  FindingCode code;
  Severity severity = code.row().severity;
  std::vector<std::string> parameters = {};  ///< those that it is about; may be empty
  /// Holds the measured numbers by name, in SI.
  std::vector<std::pair<std::string_view, double>> numbers = {};
  std::string_view kind = {};  ///< which of several forms it takes; empty where there is one only

  /// Returns a number of the finding; empty when it has none of that name.
  [[nodiscard]] std::optional<double> Number(std::string_view name) const {
    const auto found =
        std::ranges::find(numbers, name, &std::pair<std::string_view, double>::first);
    return found == numbers.end() ? std::nullopt : std::optional(found->second);
  }
};

}  // namespace mindahl::identification
