#include "io/table_reader.h"

#include <fmt/format.h>

#include <utility>

#include "io/source.h"

namespace mindahl::io {

TableReader::TableReader(const Layout& layout, LeftOutRows* skipped,
                         const std::vector<std::size_t>& wanted)
    : layout_(layout),
      table_(layout.header),
      skipped_(skipped),
      is_wanted_(wanted.empty() ? layout.holds_numbers : std::vector<bool>(layout.columns())),
      values_(layout.columns()),
      last_clock_(layout.columns()),
      line_(layout.data_line - 1) {
  for (const std::size_t column : wanted) is_wanted_[column] = true;
}

void TableReader::Clear() {
  table_.lines.clear();
  table_.blocks.clear();
  for (TableColumn& column : table_.columns) {
    column.values.clear();
    column.fault.clear();
    column.missing.clear();
  }
}

std::string TableReader::At(std::size_t column, std::string_view fault) const {
  return fmt::format("{}:{}:{}: {}", table_.file, row_line_, column + 1, fault);
}

void TableReader::RefuseRow(const std::string& fault) {
  if (skipped_ != nullptr) {
    skipped_->Add(row_line_, fault);
  } else {
    fault_ = fault;
  }
}

void TableReader::Read(std::string_view text) {
  const bool has_quotes = text.find('"') != std::string_view::npos;
  while (!text.empty() && fault_.empty()) {
    row_line_ = line_ + 1;
    const std::string_view row = TakeRow(text, line_, has_quotes);
    const bool may_be_none = row.empty() || row.front() <= '#';  // a blank is below '#'
    if (!may_be_none || !IsBlankOrComment(row)) ReadRow(row);
  }
}

void TableReader::ReadRow(std::string_view row) {
  cell_faults_.clear();
  if (!ReadCells(row)) return;
  EndGap();
  if (!fault_.empty()) return;
  for (CellFault& cell : cell_faults_) {
    TableColumn& column = table_.columns[cell.column];
    std::string& first = cell.is_missing ? column.missing : column.fault;
    if (!first.empty()) continue;
    first = std::move(cell.message);
    if (!cell.is_missing) column.fault_row = table_.rows();
  }
  table_.lines.push_back(row_line_);
  for (std::size_t column = 0; column < values_.size(); ++column) {
    if (is_wanted_[column]) table_.columns[column].values.push_back(values_[column]);
  }
}

/// Reads the values of a row.
/// @returns false where it is none: it is at fault, or part of a header
bool TableReader::ReadCells(std::string_view row) {
  CellCursor cells(row, layout_.delimiter);
  bool has_content = false;
  std::size_t column = 0;
  for (; column < values_.size() && cells.has_next(); ++column) {
    if (!is_wanted_[column]) {
      has_content = cells.Skip() || has_content;
      continue;
    }
    double& value = values_[column];
    const std::string_view number = mark_ == ',' ? std::string_view() : cells.TakeNumber(value);
    if (number.empty()) {
      const std::string_view text = cells.Take();
      has_content = has_content || !text.empty();
      value = ValueOf(column, text);
    } else {
      has_content = true;
      if (mark_ == '\0' && layout_.has_decimal_comma() && number.find('.') != number.npos) {
        mark_ = '.';
        mark_line_ = row_line_;
      }
    }
  }
  if (has_content && cell_faults_.empty() && column == values_.size() && !cells.has_next()) {
    return true;
  }
  const std::size_t count = column;
  std::string too_many;
  for (; cells.has_next(); ++column) {
    const std::string_view text = cells.Take();
    if (text.empty() || !too_many.empty()) continue;
    too_many = At(
        column, fmt::format("'{}' is one cell too many: the table has {} column{}{}",
                            ForMessage(text), layout_.columns(), layout_.columns() == 1 ? "" : "s",
                            layout_.delimiter == ','
                                ? "; leave out commas that separate thousands, and separate the "
                                  "columns by ';' or tabs where commas are decimal marks"
                                : ""));
  }
  if (cells.is_open()) {
    RefuseRow(
        fmt::format("{}:{}: a quotation mark opened here is never closed", table_.file, row_line_));
    return false;
  }
  if (!has_content && too_many.empty()) return false;
  for (std::size_t missing = count; missing < values_.size(); ++missing) {
    if (!is_wanted_[missing]) continue;
    values_[missing] = Cell().value;
    cell_faults_.push_back(
        {missing, false,
         At(missing, fmt::format("the row has {} cell{} of {}: complete it or remove it", count,
                                 count == 1 ? "" : "s", layout_.columns()))});
  }
  if ((!cell_faults_.empty() || !too_many.empty()) && BelongsToHeader(row)) return false;
  if (!too_many.empty()) RefuseRow(too_many);
  return too_many.empty();
}

/// Reads a cell that is not plainly a number.
double TableReader::ValueOf(std::size_t column, std::string_view text) {
  Cell cell = ReadCell(text, layout_.has_decimal_comma());
  const bool has_mark = cell.kind == Cell::Kind::kNumber && cell.decimal_mark != '\0';
  if (has_mark && layout_.has_decimal_comma() && cell.decimal_mark != mark_) {
    if (mark_ != '\0') {
      cell_faults_.push_back(
          {column, false,
           At(column, fmt::format("'{}' has the decimal mark '{}' and line {} has '{}': use one "
                                  "throughout",
                                  ForMessage(text), cell.decimal_mark, mark_line_, mark_))});
      return Cell().value;
    }
    mark_ = cell.decimal_mark;
    mark_line_ = row_line_;
  }
  if (cell.kind == Cell::Kind::kClock) {
    // A time of day without a date that is 12 h or more before the last is of the next day.
    double& last = last_clock_[column];
    while (cell.value < kDay && cell.value + kDay / 2 < last) {
      cell.value += kDay;
    }
    last = cell.value;
    table_.columns[column].is_clock = true;
  } else if (cell.kind != Cell::Kind::kNumber) {
    const bool is_missing = cell.kind == Cell::Kind::kMissing;
    const TableColumn& of = table_.columns[column];
    const bool is_first = (is_missing ? of.missing : of.fault).empty();
    cell_faults_.push_back(
        {column, is_missing, is_first ? At(column, DescribeCellFault(text, cell.kind)) : ""});
  }
  return cell.value;
}

/// True for a row of text that repeats the header, or may be above a header that is repeated.
bool TableReader::BelongsToHeader(std::string_view row) {
  const std::string_view text = Trimmed(row);
  if ((!layout_.names_row.empty() && text == Trimmed(layout_.names_row)) ||
      (gap_ && gap_->empty() && text == Trimmed(layout_.units_row))) {
    gap_.emplace();
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
      ReadCell(first, layout_.has_decimal_comma()).kind != Cell::Kind::kText) {
    return false;
  }
  if (gap_ && !gap_->empty()) return true;
  gap_ = At(column, DescribeCellFault(first, Cell::Kind::kText));
  if (!layout_.names_row.empty()) {
    *gap_ += fmt::format("; a further block of rows must have the columns of line {} above it",
                         table_.header_line);
  }
  return true;
}

/// Ends the text above a row of numbers, or the file, which repeated the header or is at fault.
void TableReader::EndGap() {
  if (gap_ && gap_->empty()) table_.blocks.push_back(table_.rows());
  if (gap_ && !gap_->empty()) RefuseRow(*gap_);
  gap_.reset();
}

}  // namespace mindahl::io
