#include "io/number_row.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstring>
#include <system_error>
#include <utility>

#include "io/message_text.h"
#include "io/number_cell.h"

namespace mindahl::io {
namespace {

bool IsBlank(char character) { return character == ' ' || character == '\t'; }

const char* SkipBlanks(const char* at, const char* end) {
  while (at != end && IsBlank(*at)) ++at;
  return at;
}

/// Neither "nan" nor "inf", which from_chars takes too.
bool BeginsAsNumber(const char* at, const char* end) {
  if (at != end && *at == '-') ++at;
  return at != end && (IsDigit(*at) || *at == '.');
}

}  // namespace

NumberRowReader::NumberRowReader(Delimiter delimiter, std::size_t columns,
                                 std::vector<std::size_t> wanted, std::optional<std::size_t> clock)
    : delimiter_(delimiter), wanted_(std::move(wanted)), clock_(clock), slots_(columns, -1) {
  for (std::size_t k = 0; k < wanted_.size(); ++k) slots_[wanted_[k]] = static_cast<int>(k);
  for (const std::size_t column : wanted_) last_wanted_ = std::max(last_wanted_, column);
}

NumberRowReader::Row NumberRowReader::Read(std::string_view line, std::size_t number,
                                           std::span<double> values) {
  if (ReadPlain(line, number, values)) return Row::kNumbers;
  return ReadAny(line, number, values);
}

/// False where the line is not plain: then nothing is said of it.
bool NumberRowReader::ReadPlain(std::string_view line, std::size_t number,
                                std::span<double> values) {
  const bool by_blanks = delimiter_ == Delimiter::kBlanks;
  const bool comma_may_be_mark = delimiter_ != Delimiter::kComma;
  const bool may_be_padded = !by_blanks && delimiter_ != Delimiter::kTab;
  const auto delimiter = static_cast<char>(delimiter_);
  const char* at = line.data();
  const char* const end = at + line.size();
  if (line.empty() || std::memchr(at, '"', line.size()) != nullptr) return false;
  bool has_point = false;
  if (const char* const first = SkipBlanks(at, end); first == end || *first == '#') return false;
  if (by_blanks) at = SkipBlanks(at, end);
  for (std::size_t column = 0; column < slots_.size(); ++column) {
    if (column > 0) {  // at the delimiter that ends the cell before
      if (at == end) {
        if (column <= last_wanted_) return false;
        break;
      }
      at = by_blanks ? SkipBlanks(at, end) : at + 1;
    }
    if (slots_[column] < 0) {
      const char* next = at;
      while (next != end && (by_blanks ? !IsBlank(*next) : *next != delimiter)) ++next;
      if (next == at && by_blanks) return false;
      at = next;
      continue;
    }
    if (may_be_padded) at = SkipBlanks(at, end);
    if (!BeginsAsNumber(at, end)) return false;
    double value = 0.0;
    const auto [stop, error] = std::from_chars(at, end, value);
    if (error != std::errc()) return false;
    if (comma_may_be_mark && !has_point) {
      has_point = std::memchr(at, '.', static_cast<std::size_t>(stop - at)) != nullptr;
    }
    values[static_cast<std::size_t>(slots_[column])] = value;
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

NumberRowReader::Row NumberRowReader::ReadAny(std::string_view line, std::size_t number,
                                              std::span<double> values) {
  CsvTokenizer tokenizer(line, delimiter_, 0, number);
  if (!tokenizer.Next(row_)) {
    if (!tokenizer.EndedInQuotes()) return Row::kNone;
    may_be_footer_ = false;
    return Break(0, "a quotation mark opened here is never closed");
  }
  const bool decimal_comma = delimiter_ != Delimiter::kComma;
  may_be_footer_ = BeginsFooter(row_, decimal_comma);
  std::size_t extra = 0;
  std::string fault = DescribeExtraCell(row_, slots_.size(), extra);
  if (!fault.empty()) return Break(extra, std::move(fault));
  for (std::size_t k = 0; k < wanted_.size(); ++k) {
    const std::size_t column = wanted_[k];
    if (column == clock_ && column < row_.size()) {
      const std::optional<double> time = times_.Read(row_[column]);
      if (!time) {
        return Break(column, fmt::format("'{}' is not a time of day as the rows above have: write "
                                         "it like 14:05:06.789, or remove the row",
                                         ForMessage(row_[column])));
      }
      values[k] = *time;
      continue;
    }
    const NumberCell cell =
        column < row_.size() ? ReadNumber(row_[column], decimal_comma) : NumberCell{};
    if (cell.kind != NumberCell::Kind::kNumber) {
      return Break(column, DescribeCellFault(row_, column, slots_.size(), delimiter_));
    }
    values[k] = cell.value;
    if (!decimal_comma || cell.decimal_mark == '\0' || cell.decimal_mark == mark_) continue;
    if (mark_ != '\0') {
      return Break(column, DescribeSecondMark(row_[column], cell.decimal_mark, mark_line_, mark_));
    }
    mark_ = cell.decimal_mark;
    mark_line_ = number;
  }
  return Row::kNumbers;
}

NumberRowReader::Row NumberRowReader::Break(std::size_t column, std::string fault) {
  fault_column_ = column;
  fault_ = std::move(fault);
  return Row::kBroken;
}

}  // namespace mindahl::io
