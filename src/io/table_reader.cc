#include "io/table_reader.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "io/source.h"

namespace mindahl::io {
namespace {

constexpr double kBroken = std::numeric_limits<double>::infinity();

}  // namespace

TableReader::TableReader(const Layout& layout, const std::vector<std::size_t>& wanted)
    : layout_(layout),
      table_(layout.header),
      is_wanted_(wanted.empty() ? layout.holds_numbers : std::vector<bool>(layout.columns())),
      values_(layout.columns()),
      faults_(layout.columns()),
      line_(layout.data_line - 1) {
  for (const std::size_t column : wanted) is_wanted_[column] = true;
}

void TableReader::Clear() {
  table_.lines.clear();
  table_.blocks.clear();
  for (TableColumn& column : table_.columns) {
    column.values.clear();
    column.broken.clear();
    column.missing.clear();
  }
}

std::string TableReader::At(std::size_t column, std::string_view fault) const {
  return fmt::format("{}:{}:{}: {}", table_.file, row_line_, column + 1, fault);
}

void TableReader::Read(std::string_view text) {
  while (!text.empty()) {
    row_line_ = ++line_;
    const std::string_view row = TakeLine(text);
    const bool may_be_none = row.empty() || row.front() <= '#';  // a blank is below '#'
    if (!may_be_none || !IsBlankOrComment(row)) ReadRow(row);
  }
}

void TableReader::ReadRow(std::string_view row) {
  CellCursor cells(row, layout_.delimiter);
  bool has_content = false;
  bool is_whole = true;
  std::size_t count = 0;
  for (; count < values_.size() && cells.has_next(); ++count) {
    if (!is_wanted_[count]) {
      has_content = cells.Skip() || has_content;
      continue;
    }
    const std::string_view number =
        mark_ == ',' ? std::string_view() : cells.TakeNumber(values_[count]);
    if (number.empty()) {
      const std::string_view text = cells.Take();
      has_content = has_content || !text.empty();
      ReadCell(count, text);
      is_whole = is_whole && std::isfinite(values_[count]);
    } else {
      has_content = true;
      if (mark_ == '\0' && number.find('.') != number.npos) {
        mark_ = '.';
        mark_line_ = row_line_;
      }
    }
  }
  std::string fault;  // of the row
  for (std::size_t column = count; cells.has_next(); ++column) {
    const std::string_view text = cells.Take();
    if (text.empty() || !fault.empty()) continue;
    fault = At(column,
               fmt::format("'{}' is one cell too many: the table has {} column{}{}",
                           ForMessage(text), layout_.columns(), layout_.columns() == 1 ? "" : "s",
                           layout_.delimiter == ','
                               ? "; leave out commas that separate thousands, and separate the "
                                 "columns by ';' or tabs where commas are decimal marks"
                               : ""));
  }
  if (cells.is_open()) {
    fault = fmt::format("{}:{}: a quotation mark opened here is never closed in its line",
                        table_.file, row_line_);
  } else if (!has_content && fault.empty()) {
    return;
  }
  for (std::size_t missing = count; missing < values_.size(); ++missing) {
    if (!is_wanted_[missing]) continue;
    is_whole = false;
    values_[missing] = kBroken;
    faults_[missing] =
        At(missing, fmt::format("the row has {} cell{} of {}: complete it or remove it", count,
                                count == 1 ? "" : "s", layout_.columns()));
  }
  if ((!is_whole || !fault.empty()) && !cells.is_open() && BelongsToHeader(row)) return;
  EndGap();
  if (!fault.empty()) return AddFaulty(row_line_, fault);
  table_.lines.push_back(row_line_);
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (!is_wanted_[k]) continue;
    TableColumn& column = table_.columns[k];
    column.values.push_back(values_[k]);
    if (is_whole || std::isfinite(values_[k])) continue;
    std::string& first = std::isnan(values_[k]) ? column.missing : column.broken;
    if (first.empty()) first = faults_[k];
  }
}

void TableReader::AddFaulty(std::size_t line, const std::string& fault) {
  table_.lines.push_back(line);
  for (std::size_t k = 0; k < values_.size(); ++k) {
    if (!is_wanted_[k]) continue;
    table_.columns[k].values.push_back(kBroken);
    if (table_.columns[k].broken.empty()) table_.columns[k].broken = fault;
  }
}

/// Reads a cell that is not plainly a number.
void TableReader::ReadCell(std::size_t column, std::string_view text) {
  const Cell cell = io::ReadCell(text, layout_.delimiter);
  const TableColumn& of = table_.columns[column];
  values_[column] = cell.value;
  if (cell.kind == Cell::Kind::kClock) {
    table_.columns[column].is_clock = true;
  } else if (cell.kind != Cell::Kind::kNumber) {
    const bool is_missing = cell.kind == Cell::Kind::kMissing;
    if (!is_missing) values_[column] = kBroken;
    // A message describes the first cell of a column that is missing or broken.
    if ((is_missing ? of.missing : of.broken).empty()) {
      faults_[column] = At(column, DescribeCellFault(text, cell.kind));
    }
  } else if (cell.decimal_mark != '\0') {
    if (mark_ == '\0') {
      mark_ = cell.decimal_mark;
      mark_line_ = row_line_;
    }
    if (cell.decimal_mark == mark_) return;
    values_[column] = kBroken;
    faults_[column] =
        At(column, fmt::format("'{}' has the decimal mark '{}' and line {} has '{}': use one "
                               "throughout",
                               ForMessage(text), cell.decimal_mark, mark_line_, mark_));
  }
}

/// True for a row of text that repeats the header, or may be above a header that is repeated.
bool TableReader::BelongsToHeader(std::string_view row) {
  const std::string_view text = Trimmed(row);
  if ((!layout_.names_row.empty() && text == Trimmed(layout_.names_row)) ||
      (gap_ && gap_->fault.empty() && text == Trimmed(layout_.units_row))) {
    gap_ = {row_line_, ""};
    return true;
  }
  // Its first column of numbers has a text.
  CellCursor cells(row, layout_.delimiter);
  std::size_t column = 0;
  for (; column < layout_.columns() && !layout_.mostly_numbers[column]; ++column) {
    if (cells.has_next()) cells.Skip();
  }
  const std::string first(cells.has_next() ? cells.Take() : std::string_view());
  if (column == layout_.columns() ||
      io::ReadCell(first, layout_.delimiter).kind != Cell::Kind::kText) {
    return false;
  }
  if (gap_ && !gap_->fault.empty()) return true;
  gap_ = {row_line_, At(column, DescribeCellFault(first, Cell::Kind::kText))};
  if (!layout_.names_row.empty()) {
    gap_->fault += fmt::format(
        "; a further block of rows must have the columns of line {} above "
        "it",
        table_.header_line);
  }
  return true;
}

/// Ends the text above a row of numbers, or the file, which repeated the header or is at fault.
void TableReader::EndGap() {
  if (gap_ && gap_->fault.empty()) table_.blocks.push_back(table_.rows());
  if (gap_ && !gap_->fault.empty()) AddFaulty(gap_->line, gap_->fault);
  gap_.reset();
}

}  // namespace mindahl::io
