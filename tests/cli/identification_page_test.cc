#include <fmt/format.h>

#include "identification/inference/departures.h"
#include "identification/inference/irregularities.h"
#include "mindahl/identification/terms.h"
#include "mindahl/identification/thresholds.h"
#include "support/contract.h"
#include "support/prelude.h"

// docs/identification.md against the library: its tables are those of the parameters, of the
// departures and of the thresholds, row by row.
namespace mindahl::identification::identification_page_test {
namespace {

using Rows = std::vector<std::string>;

/// Rows of the table in a section, without its head.
Rows RowsOf(const std::string& section) {
  const std::string page = PageSections("docs/identification.md").at(section);
  Rows rows;
  for (std::size_t begin = page.find("\n| `"); begin != std::string::npos;) {
    const std::size_t end = page.find('\n', begin + 1);
    rows.push_back(page.substr(begin + 1, end - begin - 1));
    begin = page.find("\n| `", end);
  }
  return rows;
}

std::string_view Words(Scope scope) { return scope == Scope::kContact ? "contact" : "record"; }

std::string_view Words(Entry entry) { return entry == Entry::kLaw ? "law" : "linear"; }

std::string Words(const Term& term) {
  switch (term.presence) {
    case Presence::kAlways:
      return "always";
    case Presence::kOffsets:
      return "with offsets, else 0";
    case Presence::kReported:
      return fmt::format("`{}`, else 0", term.option);
    case Presence::kOnDemand:
      if (term.name.starts_with("drag_")) return "`--terms drag`";
      return term.option.empty() ? "with the row above" : fmt::format("`{}`", term.option);
    case Presence::kLoadSeries:
      return "loads that differ";
    case Presence::kNever:
      return "`--drift` beside `--noise-in displacement`";
  }
  return "";
}

TEST(IdentificationPage, HasARowForEveryParameterAndNoOther) {
  Rows expected;
  for (const Term& term : Terms()) {
    expected.push_back(fmt::format("| `{}` | {} | {} | {} | {} | {} |", term.name, term.unit,
                                   Words(term.scope), Words(term.entry), Words(term),
                                   term.meaning));
  }
  EXPECT_EQ(RowsOf("Parameters"), expected);
}

TEST(IdentificationPage, HasARowForEveryThresholdAndNoOther) {
  Rows expected;
  for (const ThresholdRow& row : ThresholdTable()) {
    expected.push_back(fmt::format("| `{}` | {:g} | {} | {} | {} |", row.name,
                                   Thresholds().*row.value, row.unit, row.meaning, row.reason));
  }
  EXPECT_EQ(RowsOf("Thresholds"), expected);
}

TEST(IdentificationPage, HasOneRowForEachOmittedTerm) {
  Rows expected;
  for (const Departure& departure : Departures()) {
    const std::string option =
        departure.option.empty() ? "" : fmt::format("`{}`", departure.option);
    const std::string_view by_sample =
        departure.unit_by_sample.empty() ? departure.unit : departure.unit_by_sample;
    expected.push_back(fmt::format("| `{}` | {} | {} | {} | {} |", departure.code, departure.unit,
                                   by_sample, departure.meaning, option));
  }
  EXPECT_EQ(RowsOf("Departures"), expected);
}

TEST(IdentificationPage, HasOneRowForEachResidualStructure) {
  Rows expected;
  for (const Irregularity& row : Irregularities()) {
    const std::string option = row.option.empty() ? "" : fmt::format("`{}`", row.option);
    expected.push_back(
        fmt::format("| `{}` | {} | {} | {} |", row.code, row.unit, row.meaning, option));
  }
  EXPECT_EQ(RowsOf("Irregularities"), expected);
}

}  // namespace
}  // namespace mindahl::identification::identification_page_test
