#include "io/table_reader.h"

#include <fmt/format.h>

#include <utility>

#include "io/source.h"

namespace mindahl::io {

TableReader::TableReader(const Layout& layout, std::string file, bool skip_broken,
                         std::vector<std::size_t> wanted)
    : layout_(layout),
      wanted_(std::move(wanted)),
      places_(layout.columns, -1),
      line_(layout.data_line - 1),
      skip_broken_(skip_broken) {
  const bool reads_all = wanted_.empty();
  for (std::size_t column = 0; column < layout.columns && reads_all; ++column) {
    if (layout.holds_numbers[column]) wanted_.push_back(column);
  }
  values_.resize(wanted_.size());
  last_clock_.resize(wanted_.size());
  for (std::size_t k = 0; k < wanted_.size(); ++k) places_[wanted_[k]] = static_cast<int>(k);
  table_.file = std::move(file);
  table_.header_line = layout.header_line;
  table_.interval = layout.interval;
  table_.columns.resize(layout.columns);
  for (std::size_t column = 0; column < layout.columns; ++column) {
    if (!layout.names.empty()) table_.columns[column].name = layout.names[column];
    if (!layout.units.empty()) table_.columns[column].unit = layout.units[column];
    // "Disp;mm;Force;N": a column of no numbers, named as a unit, has that of the one before.
    if (column == 0 || !layout.mostly_numbers[column - 1] || layout.mostly_numbers[column])
      continue;
    const std::string& name = table_.columns[column].name;
    std::string& unit = table_.columns[column - 1].unit;
    if (unit.empty() && LooksLikeUnit(name)) unit = name;
  }
  if (layout.preamble_rows > 0) {
    table_.notes.push_back(fmt::format("{}:{}: {} row{} above the header skipped", table_.file,
                                       layout.header_line, layout.preamble_rows,
                                       layout.preamble_rows == 1 ? "" : "s"));
  }
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
  if (skip_broken_) {
    skipped_.Add(row_line_, fault);
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
    TableColumn& column = table_.columns[wanted_[cell.place]];
    std::string& first = cell.is_missing ? column.missing : column.fault;
    if (!first.empty()) continue;
    first = std::move(cell.message);
    if (!cell.is_missing) column.fault_row = table_.rows();
  }
  table_.lines.push_back(row_line_);
  auto value = values_.begin();
  for (const std::size_t column : wanted_) table_.columns[column].values.push_back(*value++);
}

/// Reads the values of a row.
/// @returns false where it is none: it is at fault, or part of a header
bool TableReader::ReadCells(std::string_view row) {
  CellCursor cells(row, layout_.delimiter);
  bool has_content = false;
  std::size_t column = 0;
  for (; column < places_.size() && cells.has_next(); ++column) {
    if (places_[column] < 0) {
      has_content = cells.Skip() || has_content;
      continue;
    }
    const auto place = static_cast<std::size_t>(places_[column]);
    double& value = values_[place];
    const std::string_view number = mark_ == ',' ? std::string_view() : cells.TakeNumber(value);
    if (number.empty()) {
      const std::string_view text = cells.Take();
      has_content = has_content || !text.empty();
      value = ValueOf(place, text);
    } else {
      has_content = true;
      if (mark_ == '\0' && layout_.has_decimal_comma() && number.find('.') != number.npos) {
        mark_ = '.';
        mark_line_ = row_line_;
      }
    }
  }
  if (has_content && cell_faults_.empty() && column == places_.size() && !cells.has_next()) {
    return true;
  }
  const std::size_t count = column;
  std::string too_many;
  for (; cells.has_next(); ++column) {
    const std::string_view text = cells.Take();
    if (text.empty() || !too_many.empty()) continue;
    too_many =
        At(column, fmt::format("'{}' is one cell too many: the table has {} column{}{}",
                               ForMessage(text), layout_.columns, layout_.columns == 1 ? "" : "s",
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
  for (std::size_t missing = count; missing < places_.size(); ++missing) {
    if (places_[missing] < 0) continue;
    const auto place = static_cast<std::size_t>(places_[missing]);
    values_[place] = Cell().value;
    cell_faults_.push_back(
        {place, false,
         At(missing, fmt::format("the row has {} cell{} of {}: complete it or remove it", count,
                                 count == 1 ? "" : "s", layout_.columns))});
  }
  if ((!cell_faults_.empty() || !too_many.empty()) && BelongsToHeader(row)) return false;
  if (!too_many.empty()) RefuseRow(too_many);
  return too_many.empty();
}

/// Reads a cell that is not plainly a number.
double TableReader::ValueOf(std::size_t place, std::string_view text) {
  const std::size_t column = wanted_[place];
  Cell cell = ReadCell(text, layout_.has_decimal_comma());
  const bool has_mark = cell.kind == Cell::Kind::kNumber && cell.decimal_mark != '\0';
  if (has_mark && layout_.has_decimal_comma() && cell.decimal_mark != mark_) {
    if (mark_ != '\0') {
      cell_faults_.push_back(
          {place, false,
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
    double& last = last_clock_[place];
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
        {place, is_missing, is_first ? At(column, DescribeCellFault(text, cell.kind)) : ""});
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
  for (; column < layout_.columns && !layout_.mostly_numbers[column]; ++column) {
    if (cells.has_next()) cells.Skip();
  }
  const std::string first(cells.has_next() ? cells.Take() : std::string_view());
  if (column == layout_.columns ||
      ReadCell(first, layout_.has_decimal_comma()).kind != Cell::Kind::kText) {
    return false;
  }
  if (gap_ && !gap_->empty()) return true;
  gap_ = At(column, DescribeCellFault(first, Cell::Kind::kText));
  if (!layout_.names_row.empty()) {
    *gap_ += fmt::format("; a further block of rows must have the columns of line {} above it",
                         layout_.header_line);
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
