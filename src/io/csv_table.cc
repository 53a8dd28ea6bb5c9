#include "mindahl/io/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <system_error>
#include <utility>

#include "io/source.h"
#include "io/table_reader.h"
#include "mindahl/core/error.h"
#include "mindahl/core/memory.h"

namespace mindahl::io {
namespace {

/// Refuses a file that is larger than can be held, by as much of it as has been read.
void RequireWithin(const ReadLimits& limits, std::uintmax_t rows, std::uintmax_t bytes,
                   const std::string& name) {
  constexpr std::string_view kRemedy =
      "fit a part of the file, every n-th row, or each cycle with mindahl track; or allow more";
  if (rows > limits.rows) {
    throw InputError(fmt::format("{}: has more than the {} rows that --max-rows leaves for it: {}",
                                 name, limits.rows, kRemedy));
  }
  const std::uintmax_t memory = ReadLimits::MemoryOf(rows, bytes);
  if (memory <= limits.memory) return;
  throw InputError(fmt::format(
      "{}: {} of it need about {} of memory, more than the {} that "
      "--max-memory leaves for it: {}",
      name, BytesInWords(bytes), BytesInWords(memory), BytesInWords(limits.memory), kRemedy));
}

std::vector<std::size_t> ColumnsOfNumbers(const Layout& layout) {
  std::vector<std::size_t> columns;
  for (std::size_t column = 0; column < layout.columns; ++column) {
    if (layout.holds_numbers[column]) columns.push_back(column);
  }
  return columns;
}

}  // namespace

TableReader::TableReader(std::string_view text, const std::string& file, bool skip_broken)
    : layout_(FindLayout(text, file)),
      wanted_(ColumnsOfNumbers(layout_)),
      rows_(layout_, file, wanted_),
      values_(wanted_.size()),
      line_(layout_.data_line - 1),
      skip_broken_(skip_broken) {
  table_.file = file;
  table_.header_line = layout_.header_line;
  table_.interval = layout_.interval;
  table_.columns.resize(layout_.columns);
  for (std::size_t column = 0; column < layout_.columns; ++column) {
    if (!layout_.names.empty()) table_.columns[column].name = layout_.names[column];
    if (!layout_.units.empty()) table_.columns[column].unit = layout_.units[column];
  }
  if (layout_.preamble_rows > 0) {
    table_.notes.push_back(fmt::format("{}:{}: {} row{} above the header skipped", file,
                                       layout_.header_line, layout_.preamble_rows,
                                       layout_.preamble_rows == 1 ? "" : "s"));
  }
}

void TableReader::Read(std::string_view text) {
  while (!text.empty()) {
    const std::size_t line = line_ + 1;
    const std::string_view row = TakeRow(text, line_);
    const RowReader::Row kind = rows_.Read(row, line, values_);
    if (kind == RowReader::Row::kNone) continue;
    const std::string fault = rows_.TakeFault();
    if (!fault.empty() && !skip_broken_) throw InputError(fault);
    if (kind == RowReader::Row::kFault) continue;
    for (const RowReader::Fault& cell : rows_.cell_faults()) {
      TableColumn& column = table_.columns[wanted_[cell.place]];
      std::string& first = cell.is_missing ? column.missing : column.fault;
      if (!first.empty()) continue;
      first = cell.message;
      if (!cell.is_missing) column.fault_row = table_.rows();
    }
    if (rows_.begins_block()) table_.blocks.push_back(table_.rows());
    table_.lines.push_back(line);
    for (std::size_t k = 0; k < wanted_.size(); ++k) {
      table_.columns[wanted_[k]].values.push_back(values_[k]);
    }
  }
}

CsvTable TableReader::Finish() {
  const std::string fault = rows_.TakeFault();
  if (!fault.empty() && !skip_broken_) throw InputError(fault);
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    table_.columns[wanted_[k]].is_clock = rows_.is_clock(k);
  }
  if (!table_.blocks.empty()) {
    table_.notes.push_back(
        fmt::format("{}:{}: the header is repeated {} times: the blocks are joined", table_.file,
                    table_.header_line, table_.blocks.size()));
  }
  return std::move(table_);
}

std::span<const double> CsvTable::Numbers(std::size_t column) const {
  const TableColumn& of = columns.at(column);
  if (of.values.empty()) {
    throw InputError(fmt::format("{}:{}:{}: column {} holds no numbers", file,
                                 lines.empty() ? header_line : lines.front(), column + 1,
                                 column + 1));
  }
  if (!of.fault.empty()) throw InputError(of.fault);
  if (!of.missing.empty()) throw InputError(of.missing);
  return of.values;
}

CsvTable ParseCsvTable(std::string_view text, std::string file) {
  TableReader reader(text, file, /*skip_broken=*/false);
  reader.Read(text.substr(reader.layout().data_offset));
  return reader.Finish();
}

CsvTable ReadCsvTable(const std::filesystem::path& path, const ReadLimits& limits,
                      const std::string& encoding, bool skip_broken) {
  const std::string name = NameOfInput(path);
  LinePieces pieces(path, encoding);
  std::string_view text = pieces.Next();
  std::error_code is_no_file;
  const std::uintmax_t size = std::filesystem::file_size(path, is_no_file);
  if (!is_no_file) RequireWithin(limits, 0, size, name);
  TableReader reader(text, name, skip_broken);
  for (text.remove_prefix(reader.layout().data_offset); !text.empty(); text = pieces.Next()) {
    reader.Read(text);
    RequireWithin(limits, reader.rows(), pieces.bytes(), name);
  }
  CsvTable table = reader.Finish();
  if (!pieces.note().empty()) table.notes.insert(table.notes.begin(), pieces.note());
  return table;
}

CsvTable TableOfColumns(std::vector<NamedColumn> columns, std::string source) {
  CsvTable table;
  table.file = std::move(source);
  table.header_line = 1;
  if (columns.empty() || columns.front().values.empty()) {
    throw InputError(
        fmt::format("{}: there is no {}", table.file, columns.empty() ? "column" : "row"));
  }
  const std::size_t rows = columns.front().values.size();
  for (const NamedColumn& column : columns) {
    if (column.values.size() == rows) continue;
    throw InputError(fmt::format("{}: '{}' has {} rows and '{}' {}: give as many of both",
                                 table.file, columns.front().name, rows, column.name,
                                 column.values.size()));
  }
  for (NamedColumn& column : columns) {
    TableColumn& added = table.columns.emplace_back();
    const auto hole =
        std::ranges::find_if(column.values, [](double value) { return std::isnan(value); });
    if (hole != column.values.end()) {
      added.missing = fmt::format("{}:{}:{}: holds no number", table.file,
                                  hole - column.values.begin() + 1, table.columns.size());
    }
    added.name = std::move(column.name);
    added.values = std::move(column.values);
  }
  table.lines.resize(rows);
  std::iota(table.lines.begin(), table.lines.end(), std::size_t{1});
  return table;
}

}  // namespace mindahl::io
