#include "mindahl/io/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numeric>
#include <utility>

#include "io/source.h"
#include "io/table_reader.h"
#include "mindahl/core/error.h"

namespace mindahl::io {

std::string LeftOutRows::InWords() const {
  return fmt::format("{} row{} left out, the first: {}", count, count == 1 ? " is" : "s are",
                     fault);
}

std::span<const double> CsvTable::Numbers(std::size_t column) const {
  const TableColumn& of = columns.at(column);
  if (of.values.empty()) {
    Refuse("{}:{}:{}: '{}' (column {}) holds no numbers", file,
           lines.empty() ? header_line : lines.front(), column + 1, ForMessage(of.name),
           column + 1);
  }
  if (!of.broken.empty()) throw InputError(of.broken);
  if (!of.missing.empty()) throw InputError(of.missing);
  return of.values;
}

CsvTable ReadCsvTable(const std::filesystem::path& path, const std::string& encoding) {
  const std::string name = NameOfInput(path);
  LinePieces pieces(path, encoding);
  std::string_view text = pieces.Next();
  const Layout layout = FindLayout(text, name);
  TableReader reader(layout);
  for (text.remove_prefix(layout.data_offset); !text.empty(); text = pieces.Next()) {
    reader.Read(text);
  }
  reader.Finish();
  CsvTable table = std::move(reader.table());
  if (!table.blocks.empty()) {
    table.notes.push_back(
        fmt::format("{}:{}: the header is repeated {} times: the blocks are joined", name,
                    table.header_line, table.blocks.size()));
  }
  if (!pieces.note().empty()) table.notes.insert(table.notes.begin(), pieces.note());
  return table;
}

CsvTable TableOfColumns(std::vector<TableColumn> columns, std::string source) {
  if (columns.empty() || columns.front().values.empty()) {
    Refuse("{}: there is no {}", source, columns.empty() ? "column" : "row");
  }
  const std::size_t rows = columns.front().values.size();
  for (std::size_t k = 0; k < columns.size(); ++k) {
    TableColumn& column = columns[k];
    if (column.values.size() != rows) {
      Refuse("{}: '{}' has {} rows and '{}' {}: give as many of both", source, columns.front().name,
             rows, column.name, column.values.size());
    }
    for (std::size_t row = 0; row < rows; ++row) {
      if (std::isfinite(column.values[row])) continue;
      std::string& said = std::isnan(column.values[row]) ? column.missing : column.broken;
      if (said.empty()) said = fmt::format("{}:{}:{}: holds no number", source, row + 1, k + 1);
    }
  }
  CsvTable table{.file = std::move(source), .columns = std::move(columns), .header_line = 1};
  table.lines.resize(rows);
  std::iota(table.lines.begin(), table.lines.end(), std::size_t{1});
  return table;
}

std::string CsvCell(const std::string& text) {
  const bool plain = text.find_first_of(",;\"\r\n\t") == std::string::npos && !text.empty() &&
                     !text.starts_with('#') && text.front() != ' ' && text.back() != ' ';
  if (plain) return text;
  std::string quoted = "\"";
  for (const char character : text) {
    if (character == '"') quoted += '"';
    quoted += character;
  }
  return quoted + '"';
}

std::string CsvText(const std::vector<CsvColumn>& columns) {
  if (columns.empty()) throw InvalidArgument("number of columns = 0 is invalid: must be >= 1");
  const std::size_t rows = columns.front().values.size();
  std::string text;
  for (const CsvColumn& column : columns) {
    RequireSameSize(columns.front().name, rows, column.name, column.values.size());
    if (!text.empty()) text += ',';
    text += CsvCell(column.name);
  }
  text += '\n';
  auto out = std::back_inserter(text);
  for (std::size_t row = 0; row < rows; ++row) {
    for (std::size_t index = 0; index < columns.size(); ++index) {
      const CsvColumn& column = columns[index];
      const double value = column.values[row];
      if (std::isinf(value)) {
        ThrowInvalid(fmt::format("{} of row {}", column.name, row + 1), value, "must be finite");
      }
      if (index > 0) text += ',';
      if (!std::isnan(value)) fmt::format_to(out, "{:.17g}", value);
    }
    text += '\n';
  }
  return text;
}

}  // namespace mindahl::io
