#include "mindahl/io/csv_table.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <numeric>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "io/csv_layout.h"
#include "io/csv_tokenizer.h"
#include "io/input_file.h"
#include "io/number_cell.h"
#include "mindahl/core/error.h"
#include "mindahl/core/memory.h"

namespace mindahl::io {

namespace {

constexpr std::string_view kRemedy =
    "fit a part of the file, every n-th row, or each cycle with mindahl track; or allow more";

void RequireRows(const ReadLimits& limits, std::uintmax_t rows, const std::string& name) {
  if (rows <= limits.rows) return;
  throw InputError(fmt::format("{}: has more than the {} rows that --max-rows leaves for it: {}",
                               name, limits.rows, kRemedy));
}

/// Refuses a file that is larger than can be held, by as much of it as has been read.
void RequireMemory(const ReadLimits& limits, std::uintmax_t rows, std::uintmax_t bytes,
                   const std::string& name) {
  const std::uintmax_t memory = ReadLimits::MemoryOf(rows, bytes);
  if (memory <= limits.memory) return;
  throw InputError(fmt::format(
      "{}: {} of it need about {} of memory, more than the {} that --max-memory "
      "leaves for it: {}",
      name, BytesInWords(bytes), BytesInWords(memory), BytesInWords(limits.memory), kRemedy));
}

/// Reads as far as a table can be made of it: to a zero byte, of which RequireText() says where.
std::string ReadFile(const std::filesystem::path& path, const ReadLimits& limits,
                     TextInput& input) {
  const std::string name = NameOfInput(path);
  std::error_code is_no_file;
  const std::uintmax_t size = std::filesystem::file_size(path, is_no_file);
  std::string text;
  std::array<char, 1 << 16> block{};
  std::uintmax_t lines = 0;
  std::size_t line = 0;  // where the last begins
  while (const std::size_t read = input.Read(block.data(), block.size())) {
    const std::string_view piece(block.data(), read);
    text.append(piece);
    if (piece.find('\0') != std::string_view::npos) return text;
    if (text.size() == read && !is_no_file) {
      RequireMemory(limits, 0, size, name);
      text.reserve(size);
    }
    const std::size_t end = piece.find_last_of("\r\n");
    if (end != std::string_view::npos) line = text.size() - read + end + 1;
    if (text.size() - line > kLongestLine) ThrowLongLine(name);
    lines += static_cast<std::uintmax_t>(std::ranges::count(piece, '\n'));
    RequireRows(limits, lines - std::min<std::uintmax_t>(lines, kSampledRows), name);
    RequireMemory(limits, lines, text.size(), name);
  }
  return text;
}

void RequireText(std::string_view text, const std::string& file) {
  if (text.empty()) throw InputError(fmt::format("{}: the file is empty", file));
  const std::size_t zero = text.find('\0');
  if (zero != std::string_view::npos) {
    throw InputError(fmt::format("{}:{}: is not text, it holds a zero byte: export it as CSV", file,
                                 1 + std::ranges::count(text.substr(0, zero), '\n')));
  }
}

/// Refuses a file in which both ',' and '.' are decimal marks.
class DecimalMarkCheck {
 public:
  void Add(char mark, const CsvRow& row, std::size_t column, const std::string& file) {
    if (mark == '\0' || mark == mark_) return;
    if (mark_ != '\0') {
      throw InputError(fmt::format("{}:{}:{}: {}", file, row.line, column + 1,
                                   DescribeSecondMark(row[column], mark, line_, mark_)));
    }
    mark_ = mark;
    line_ = row.line;
  }

 private:
  char mark_ = '\0';
  std::size_t line_ = 0;  ///< line on which it was first seen
};

void RequireNoExtraCells(const CsvRow& row, std::size_t columns, const std::string& file) {
  std::size_t column = 0;
  const std::string fault = DescribeExtraCell(row, columns, column);
  if (fault.empty()) return;
  throw InputError(fmt::format("{}:{}:{}: {}", file, row.line, column + 1, fault));
}

}  // namespace

CsvTable ParseCsvTable(std::string text, std::string file) {
  RequireText(text, file);
  if (text.starts_with(kUtf8Mark)) text.erase(0, kUtf8Mark.size());
  CsvLayout layout = FindCsvLayout(text, file);

  CsvTable table;
  table.file_ = std::move(file);
  table.text_ = std::move(text);
  table.delimiter_ = static_cast<char>(layout.delimiter);
  table.names_ = std::move(layout.names);
  table.units_ = std::move(layout.units);
  table.header_line_ = layout.header_line;
  table.preamble_rows_ = layout.preamble_rows;
  table.values_.resize(layout.columns);

  const bool decimal_comma = layout.delimiter != Delimiter::kComma;
  DecimalMarkCheck decimal_marks;
  CsvTokenizer tokenizer(table.text_, layout.delimiter, layout.data_offset, layout.data_line);
  CsvRow row;
  std::size_t cells_in_last_row = layout.columns;
  bool may_have_footer = false;  // the data begin with a number
  std::size_t footer = 0;        // rows at the end that begin with a text
  std::string footer_fault;      // of the first of them, unless they are at the end of the file
  while (tokenizer.Next(row)) {
    if (table.lines_.empty()) may_have_footer = !BeginsFooter(row, decimal_comma);
    if (may_have_footer && BeginsFooter(row, decimal_comma)) {
      std::size_t column = 0;
      const std::string fault = DescribeExtraCell(row, layout.columns, column);
      if (!fault.empty() && footer_fault.empty()) {
        footer_fault = fmt::format("{}:{}:{}: {}", table.file_, row.line, column + 1, fault);
      }
      ++footer;
    } else {
      if (!footer_fault.empty()) throw InputError(footer_fault);
      footer = 0;
      RequireNoExtraCells(row, layout.columns, table.file_);
      cells_in_last_row = row.size();
      if (row.size() < layout.columns) ++table.short_rows_;
    }
    table.lines_.push_back(row.line);
    table.offsets_.push_back(row.offset);
    for (std::size_t column = 0; column < layout.columns; ++column) {
      const NumberCell cell =
          column < row.size() ? ReadNumber(row[column], decimal_comma) : NumberCell{};
      table.values_[column].push_back(cell.value);
      if (decimal_comma && cell.kind == NumberCell::Kind::kNumber) {
        decimal_marks.Add(cell.decimal_mark, row, column, table.file_);
      }
    }
  }
  if (footer > 0) table.DropFooter(footer);
  if (tokenizer.EndedInQuotes()) ThrowOpenQuote(table.file_, row.line);
  const char last = table.text_.back();
  if (cells_in_last_row < layout.usual_columns && last != '\n' && last != '\r') {
    throw InputError(
        fmt::format("{}:{}: the last row is cut short, with {} of {} cells: complete "
                    "the file or remove the row",
                    table.file_, table.lines_.back(), cells_in_last_row, layout.usual_columns));
  }
  return table;
}

CsvTable ReadCsvTable(const std::filesystem::path& path, const ReadLimits& limits,
                      const std::string& encoding) {
  TextInput input(path, encoding);
  CsvTable table = ParseCsvTable(ReadFile(path, limits, input), NameOfInput(path));
  RequireRows(limits, table.rows(), table.file());
  if (!input.note().empty()) table.notes_.insert(table.notes_.begin(), input.note());
  return table;
}

void CsvTable::DropFooter(std::size_t rows) {
  const std::size_t left = lines_.size() - rows;
  notes_.push_back(fmt::format("{}:{}: {} below the data skipped, since {} with a text", file_,
                               lines_[left], rows == 1 ? "a line" : fmt::format("{} lines", rows),
                               rows == 1 ? "it begins" : "they begin"));
  lines_.resize(left);
  offsets_.resize(left);
  for (std::vector<double>& values : values_) values.resize(left);
}

std::optional<std::vector<double>> CsvTable::Times(std::size_t column) const {
  if (text_.empty() || HasNumbers(column)) return std::nullopt;
  std::vector<double> times;
  times.reserve(rows());
  ClockReader clock;
  for (const std::string& cell : Cells(column)) {
    const std::optional<double> time = clock.Read(cell);
    if (!time) return std::nullopt;
    times.push_back(*time);
  }
  return times;
}

CsvTable TableOfColumns(std::vector<NamedColumn> columns, std::string source) {
  CsvTable table;
  table.file_ = std::move(source);
  if (columns.empty() || columns.front().values.empty()) {
    throw InputError(
        fmt::format("{}: there is no {}", table.file_, columns.empty() ? "column" : "row"));
  }
  const std::size_t rows = columns.front().values.size();
  for (NamedColumn& column : columns) {
    if (column.values.size() != rows) {
      throw InputError(fmt::format("{}: '{}' has {} rows and '{}' {}: give as many of both",
                                   table.file_, columns.front().name, rows, column.name,
                                   column.values.size()));
    }
    table.names_.push_back(column.name);
    table.values_.push_back(std::move(column.values));
  }
  table.lines_.resize(rows);
  std::iota(table.lines_.begin(), table.lines_.end(), std::size_t{1});
  return table;
}

std::span<const double> CsvTable::Numbers(std::size_t column) const {
  const std::vector<double>& values = values_.at(column);
  const auto fault = std::ranges::find_if(values, [](double value) { return std::isnan(value); });
  if (fault != values.end()) {
    ThrowNotANumber(static_cast<std::size_t>(fault - values.begin()), column);
  }
  if (!text_.empty() && MayHaveThousands(values)) RequireNoThousands(column);
  return values;
}

std::vector<std::string> CsvTable::Cells(std::size_t column) const {
  CsvTokenizer tokenizer(text_, static_cast<Delimiter>(delimiter_), offsets_.front(),
                         lines_.front());
  std::vector<std::string> texts;
  texts.reserve(rows());
  for (CsvRow row; texts.size() < rows() && tokenizer.Next(row);) {
    texts.emplace_back(column < row.size() ? Trimmed(row[column]) : std::string_view());
  }
  return texts;
}

bool CsvTable::MayHaveCommasForThousands(std::size_t column) const {
  if (static_cast<Delimiter>(delimiter_) == Delimiter::kComma) return false;
  const std::vector<double>& values = values_.at(column);
  if (!std::ranges::none_of(values, [](double value) { return std::isnan(value); })) return false;
  if (!MayHaveThousands(values)) return false;
  const std::vector<std::string> texts = Cells(column);
  if (texts.front().find(',') == std::string::npos) return false;
  return AreAllGrouped(std::vector<std::string_view>(texts.begin(), texts.end()));
}

void CsvTable::RequireNoThousands(std::size_t column) const {
  const std::vector<std::string> texts = Cells(column);
  const std::vector<std::string_view> cells(texts.begin(), texts.end());
  const std::optional<std::size_t> found = FindThousands(cells);
  if (!found) return;
  std::string without = texts[*found];
  const std::size_t mark = without.find_first_of(".,");
  const char separator = without[mark];
  without.erase(mark, 1);
  throw InputError(
      fmt::format("{}:{}:{}: '{}' has a '{}' that separates thousands, since other numbers of this "
                  "column are whole and it would jump back to 1 after 999: write {}",
                  file_, lines_[*found], column + 1, texts[*found], separator, without));
}

bool CsvTable::HasNumbers(std::size_t column) const {
  return std::ranges::any_of(values_.at(column), [](double value) { return !std::isnan(value); });
}

// Only the row at fault is cut into cells again: no text need be kept for the others.
void CsvTable::ThrowNotANumber(std::size_t row_index, std::size_t column) const {
  if (text_.empty()) {
    throw InputError(
        fmt::format("{}:{}:{}: holds no number", file_, lines_[row_index], column + 1));
  }
  const auto delimiter = static_cast<Delimiter>(delimiter_);
  CsvTokenizer tokenizer(text_, delimiter, offsets_[row_index], lines_[row_index]);
  CsvRow row;
  tokenizer.Next(row);
  throw InputError(fmt::format("{}:{}:{}: {}", file_, row.line, column + 1,
                               DescribeCellFault(row, column, columns(), delimiter)));
}

std::string CsvCell(const std::string& text) {
  constexpr std::string_view kFormula = "=+-@";
  if (text.size() > 1 && kFormula.find(text.front()) != std::string_view::npos) {
    return CsvCell("./" + text);
  }
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
