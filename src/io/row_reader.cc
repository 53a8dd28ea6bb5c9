#include "io/row_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <system_error>
#include <utility>

#include "core/from_chars.h"
#include "io/source.h"

namespace mindahl::io {

RowReader::RowReader(const Layout& layout, std::string file, std::vector<std::size_t> wanted)
    : layout_(layout),
      file_(std::move(file)),
      wanted_(std::move(wanted)),
      places_(layout.columns, -1),
      is_clock_(wanted_.size()),
      last_clock_(wanted_.size()) {
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    places_[wanted_[k]] = static_cast<int>(k);
    last_wanted_ = std::max(last_wanted_, wanted_[k]);
  }
}

std::string RowReader::At(std::size_t line, std::size_t column, std::string_view fault) const {
  return fmt::format("{}:{}:{}: {}", file_, line, column + 1, fault);
}

std::string RowReader::TakeFault() {
  return fault_.empty() ? std::exchange(gap_fault_, {}) : std::exchange(fault_, {});
}

RowReader::Row RowReader::Read(std::string_view row, std::size_t number, std::span<double> values) {
  begins_block_ = false;
  cell_faults_.clear();
  if (ReadPlain(row, number, values)) return EndGap(Row::kNumbers);
  if (IsBlankOrComment(row)) return Row::kNone;
  return EndGap(ReadAny(row, number, values));
}

/// A row of numbers ends the text above it, which repeated the header or is at fault.
RowReader::Row RowReader::EndGap(Row row) {
  if (row != Row::kNumbers) return row;
  if (has_repeated_header_) {
    begins_block_ = true;
    has_repeated_header_ = false;
    gap_fault_.clear();
  } else if (!gap_fault_.empty()) {
    fault_ = std::exchange(gap_fault_, {});
  }
  return row;
}

namespace {

bool IsBlank(char character) { return character == ' ' || character == '\t'; }

const char* SkipBlanks(const char* at, const char* end) {
  while (at != end && IsBlank(*at)) ++at;
  return at;
}

/// True for what from_chars reads as a number and not as a word ("nan").
bool BeginsAsNumber(const char* at, const char* end) {
  if (at != end && *at == '-') ++at;
  if (at != end && *at == '.') ++at;
  return at != end && *at >= '0' && *at <= '9';
}

/// Reads the number at the begin of a text, with a comma for its decimal mark.
/// @returns the end of what was read; `at` where that is no number
const char* ReadWithComma(const char* at, const char* end, double& value) {
  std::array<char, 32> copy{};
  std::size_t size = 0;
  bool has_comma = false;
  for (const char* next = at; next != end && size < copy.size(); ++next, ++size) {
    const bool is_comma = *next == ',';
    if (IsBlank(*next) || *next == ';' || *next == '.' || (is_comma && has_comma)) break;
    has_comma = has_comma || is_comma;
    copy[size] = is_comma ? '.' : *next;
  }
  if (size == copy.size() || (size > 0 && copy[size - 1] == '.')) return at;
  const auto [stop, error] = FromChars(copy.data(), copy.data() + size, value);
  return error == std::errc() && stop == copy.data() + size ? at + size : at;
}

}  // namespace

/// Reads a row of numbers without quotation marks, of which no cell is copied.
bool RowReader::ReadPlain(std::string_view row, std::size_t number, std::span<double> values) {
  const char delimiter = layout_.delimiter;
  const bool by_blanks = delimiter == kBlanks;
  const bool may_be_padded = !by_blanks && delimiter != '\t';
  const char* at = row.data();
  const char* const end = at + row.size();
  if (row.empty() || std::memchr(at, '"', row.size()) != nullptr) return false;
  bool has_point = false;
  if (const char* const first = SkipBlanks(at, end); first == end || *first == '#') return false;
  if (by_blanks) at = SkipBlanks(at, end);
  for (std::size_t column = 0; column < places_.size(); ++column) {
    if (column > 0) {  // at the delimiter that ends the cell before
      if (at == end) {
        if (column <= last_wanted_) return false;
        break;
      }
      at = by_blanks ? SkipBlanks(at, end) : at + 1;
    }
    if (places_[column] < 0) {
      const char* next = at;
      while (next != end && (by_blanks ? !IsBlank(*next) : *next != delimiter)) ++next;
      if (next == at && by_blanks) return false;
      at = next;
      continue;
    }
    if (may_be_padded) at = SkipBlanks(at, end);
    if (!BeginsAsNumber(at, end)) return false;
    double value = 0.0;
    const char* stop = at;
    if (mark_ == ',') {
      stop = ReadWithComma(at, end, value);
      if (stop == at) return false;
    } else {
      const auto [read, error] = FromChars(at, end, value);
      if (error != std::errc()) return false;
      stop = read;
      if (delimiter != ',' && !has_point) {
        has_point = std::memchr(at, '.', static_cast<std::size_t>(stop - at)) != nullptr;
      }
    }
    values[static_cast<std::size_t>(places_[column])] = value;
    at = stop;
    if (may_be_padded) at = SkipBlanks(at, end);
    if (at != end && (by_blanks ? !IsBlank(*at) : *at != delimiter)) return false;
  }
  if (at != end && SkipBlanks(at + (by_blanks ? 0 : 1), end) != end) return false;
  if (has_point && mark_ != '.') {
    if (mark_ != '\0') return false;
    mark_ = '.';
    mark_line_ = number;
  }
  return true;
}

RowReader::Row RowReader::ReadAny(std::string_view row, std::size_t number,
                                  std::span<double> values) {
  if (!cells_.Split(row, layout_.delimiter)) {
    fault_ = fmt::format("{}:{}: a quotation mark opened here is never closed", file_, number);
    return Row::kFault;
  }
  if (cells_.FilledSize() == 0) return Row::kNone;
  const bool repeats = !layout_.names_row.empty() && Trimmed(row) == Trimmed(layout_.names_row);
  if (repeats || (has_repeated_header_ && Trimmed(row) == Trimmed(layout_.units_row))) {
    has_repeated_header_ = true;
    return Row::kNone;
  }
  // A row whose first column of numbers has a text may belong to the header of a further block.
  std::size_t first = 0;
  while (first < layout_.columns && !layout_.mostly_numbers[first]) ++first;
  const Cell::Kind begin = ReadCell(cells_.At(first), layout_.has_decimal_comma()).kind;
  if (begin == Cell::Kind::kText && first < layout_.columns) {
    has_repeated_header_ = false;
    if (gap_fault_.empty()) {
      gap_fault_ = At(number, first, DescribeCellFault(cells_.At(first), begin));
      if (cells_.FilledSize() == 1 || !layout_.names_row.empty()) {
        gap_fault_ +=
            fmt::format("; a further block of rows must have the columns of line {} above it",
                        layout_.header_line);
      }
    }
    return Row::kNone;
  }
  for (std::size_t column = layout_.columns; column < cells_.size(); ++column) {
    if (cells_[column].empty()) continue;
    fault_ =
        At(number, column,
           fmt::format("'{}' is one cell too many: the table has {} column{}{}",
                       ForMessage(cells_[column]), layout_.columns, layout_.columns == 1 ? "" : "s",
                       layout_.delimiter == ','
                           ? "; leave out commas that separate thousands, and separate the "
                             "columns by ';' or tabs where commas are decimal marks"
                           : ""));
    return Row::kFault;
  }
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const std::size_t column = wanted_[k];
    Cell cell = ReadCell(cells_.At(column), layout_.has_decimal_comma());
    if (cell.kind == Cell::Kind::kNumber && layout_.has_decimal_comma() &&
        cell.decimal_mark != '\0' && cell.decimal_mark != mark_) {
      if (mark_ == '\0') {
        mark_ = cell.decimal_mark;
        mark_line_ = number;
      } else {
        cell_faults_.push_back(
            {k, number, false,
             At(number, column,
                fmt::format("'{}' has the decimal mark '{}' and line {} has '{}': use one "
                            "throughout",
                            ForMessage(cells_[column]), cell.decimal_mark, mark_line_, mark_))});
        cell = {};
        values[k] = cell.value;
        continue;
      }
    }
    if (cell.kind == Cell::Kind::kClock) {
      constexpr double kDay = 86'400.0;
      // A time of day without a date that is 12 h or more before the last is of the next day.
      if (is_clock_[k] && cell.value < kDay) {
        while (cell.value < last_clock_[k] - kDay / 2) cell.value += kDay;
      }
      last_clock_[k] = cell.value;
    }
    values[k] = cell.value;
    if (cell.is_number()) {
      is_clock_[k] = cell.kind == Cell::Kind::kClock;
      continue;
    }
    const bool is_short = column >= cells_.size();
    cell_faults_.push_back(
        {k, number, cell.kind == Cell::Kind::kMissing && !is_short,
         At(number, column,
            is_short ? fmt::format("the row has {} cell{} of {}: complete it or remove it",
                                   cells_.size(), cells_.size() == 1 ? "" : "s", layout_.columns)
                     : DescribeCellFault(cells_[column], cell.kind))});
  }
  return Row::kNumbers;
}

}  // namespace mindahl::io
