#include <array>
#include <cstddef>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "identification/inference/departures.h"
#include "mindahl/campaign/cycle_fit.h"
#include "mindahl/identification/finding.h"
#include "mindahl/identification/terms.h"
#include "mindahl/request/batch.h"
#include "report/json.h"
#include "report/statements.h"

// Prints the library's tables as JSON, from which library_tables.py makes those of the pages.
namespace mindahl {
namespace {

using report::Json;

/// Returns the first name by which `--terms` adds a term; empty where there is none.
std::string_view OptionOf(const identification::Term& term) {
  for (const identification::TermGroup& group : identification::TermGroups()) {
    if (std::ranges::find(group.terms, term.name) != group.terms.end()) return group.name;
  }
  return "";
}

Json TermsTable() {
  Json rows = Json::array();
  const std::array presences = {"always",    "offsets",     "reported",
                                "on_demand", "load_series", "never"};
  for (const identification::Term& term : identification::Terms()) {
    rows.push_back({{"name", term.name},
                    {"unit", term.unit},
                    {"meaning", term.meaning},
                    {"is_of_record", term.is_of_record},
                    {"is_linear", term.is_linear || term.id == identification::TermId::kSlipForce},
                    {"presence", presences.at(static_cast<std::size_t>(term.presence))},
                    {"option", OptionOf(term)},
                    {"needs_time", term.needs_time}});
  }
  return rows;
}

Json FindingsTable() {
  Json rows = Json::array();
  for (const identification::FindingRow& row : identification::kFindings) {
    rows.push_back({{"code", row.code},
                    {"verdict", report::Name(row.verdict)},
                    {"is_note", row.severity == identification::Severity::kNote}});
  }
  return rows;
}

/// Causes, omitted terms in the order of the library.
Json CausesTable() {
  Json rows = Json::array();
  for (const identification::Departure& row : identification::Departures()) {
    rows.push_back({{"code", row.code}, {"option", row.group}});
  }
  return rows;
}

Json FlagsTable() {
  Json rows = Json::array();
  for (const campaign::CycleFlag& flag : campaign::kCycleFlags) {
    rows.push_back({{"name", flag.name}, {"meaning", flag.meaning}});
  }
  return rows;
}

/// Columns of the tables that commands write, by command.
Json Columns() {
  Json columns = {{"track", Json::array()}, {"batch", Json::array()}};
  std::istringstream header(campaign::CycleTableHeader(/*is_torsional=*/false));
  for (std::string name; header >> std::ws && std::getline(header, name, ',');) {
    columns["track"].push_back(name.substr(0, name.find('\n')));
  }
  const request::BatchEntry entry;
  const Json batch = Json::parse(request::AnswerOf({&entry, 1}).rows);
  for (const auto& [name, cell] : batch[0].items()) columns["batch"].push_back(name);
  return columns;
}

}  // namespace
}  // namespace mindahl

int main() {
  const mindahl::report::Json tables = {{"terms", mindahl::TermsTable()},
                                        {"findings", mindahl::FindingsTable()},
                                        {"causes", mindahl::CausesTable()},
                                        {"flags", mindahl::FlagsTable()},
                                        {"columns", mindahl::Columns()}};
  std::cout << tables.dump(1) << '\n';
}
