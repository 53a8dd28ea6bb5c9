#include "io/csv_layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <utility>

#include "io/column_name.h"
#include "io/csv_tokenizer.h"
#include "io/number_cell.h"
#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

// A tie goes to the first: a cell may contain what comes after it in this list.
constexpr std::array kDelimiters = {Delimiter::kTab, Delimiter::kSemicolon, Delimiter::kComma,
                                    Delimiter::kBlanks};

struct SampledRow {
  CsvRow cells;
  std::vector<NumberCell::Kind> kinds;

  [[nodiscard]] std::size_t Count(NumberCell::Kind kind) const {
    return static_cast<std::size_t>(std::ranges::count(kinds, kind));
  }
  /// A trailing delimiter, or empty cells at the end, leave the number of columns open.
  [[nodiscard]] bool CanHave(std::size_t columns) const {
    return cells.FilledSize() <= columns && columns <= cells.size();
  }
  /// Number of cells, one trailing delimiter aside.
  [[nodiscard]] std::size_t Columns() const {
    return cells.size() > 1 && kinds.back() == NumberCell::Kind::kEmpty ? cells.size() - 1
                                                                        : cells.size();
  }
  /// Looks like data whatever the other rows are: "sample_rate,200" does not, "1,2" does.
  [[nodiscard]] bool HasData() const {
    const std::size_t numbers = Count(NumberCell::Kind::kNumber);
    const std::size_t broken =
        Count(NumberCell::Kind::kBroken) + Count(NumberCell::Kind::kTooLarge);
    return numbers >= 1 && (kinds.front() == NumberCell::Kind::kNumber || numbers + broken >= 2);
  }
  [[nodiscard]] bool IsText() const {
    return Count(NumberCell::Kind::kNumber) == 0 && Count(NumberCell::Kind::kText) >= 1;
  }
};

/// The rows under one delimiter, and how well it explains them as columns of numbers.
struct Reading {
  Delimiter delimiter = Delimiter::kComma;
  std::vector<SampledRow> rows;
  std::size_t columns = 0;  ///< number in most rows with data; 0 when there are none
  long score = 0;           ///< numbers less broken numbers in the rows with so many columns
  std::size_t open_quote_line = 0;  ///< line of a quote that is never closed; 0 when there is none

  /// Number of cells of the last row.
  [[nodiscard]] std::size_t Width() const { return rows.back().Columns(); }
};

void Sample(std::string_view text, Reading& reading) {
  CsvTokenizer tokenizer(text, reading.delimiter);
  CsvRow cells;
  while (reading.rows.size() < kSampledRows && tokenizer.Next(cells)) {
    SampledRow row{cells, {}};
    for (std::size_t cell = 0; cell < cells.size(); ++cell) {
      row.kinds.push_back(ReadNumber(cells[cell], reading.delimiter != Delimiter::kComma).kind);
    }
    reading.rows.push_back(std::move(row));
  }
  if (tokenizer.EndedInQuotes()) reading.open_quote_line = cells.line;
}

Reading ReadAs(std::string_view text, Delimiter delimiter) {
  Reading reading;
  reading.delimiter = delimiter;
  Sample(text, reading);
  std::map<std::size_t, std::size_t> rows_with_columns;
  for (const SampledRow& row : reading.rows) {
    if (row.HasData()) ++rows_with_columns[row.Columns()];
  }
  std::size_t most_rows = 0;
  for (const auto& [columns, rows] : rows_with_columns) {
    if (rows >= most_rows) {
      most_rows = rows;
      reading.columns = columns;
    }
  }
  for (const SampledRow& row : reading.rows) {
    if (!row.HasData() || row.Columns() != reading.columns) continue;
    reading.score += static_cast<long>(row.Count(NumberCell::Kind::kNumber)) -
                     static_cast<long>(row.Count(NumberCell::Kind::kBroken));
  }
  return reading;
}

/// Columns that hold a number in most rows with data. A preamble row with two numbers in it,
/// "range,0,10", has text in one of them and so is not taken for data.
std::vector<std::size_t> NumericColumns(const Reading& reading) {
  std::vector<std::size_t> numbers(reading.columns, 0);
  std::size_t rows = 0;
  for (const SampledRow& row : reading.rows) {
    if (!row.HasData() || row.Columns() != reading.columns) continue;
    ++rows;
    for (std::size_t column = 0; column < reading.columns; ++column) {
      if (row.kinds[column] == NumberCell::Kind::kNumber) ++numbers[column];
    }
  }
  std::vector<std::size_t> numeric;
  for (std::size_t column = 0; column < reading.columns; ++column) {
    if (2 * numbers[column] > rows) numeric.push_back(column);
  }
  return numeric;
}

std::size_t FirstDataRow(const Reading& reading) {
  const std::vector<std::size_t> numeric = NumericColumns(reading);
  const auto may_be_data = [&](const SampledRow& row) {
    if (!row.HasData()) return false;
    if (row.CanHave(reading.columns)) return true;
    // A row that has more than most, as an event of a logger, below a header that names them.
    if (&row == &reading.rows.front()) return false;
    const SampledRow& above = *(&row - 1);
    return !numeric.empty() && row.cells.size() > reading.columns && above.IsText() &&
           above.cells.size() >= row.cells.size() &&
           std::ranges::all_of(numeric, [&](std::size_t column) {
             return row.kinds[column] == NumberCell::Kind::kNumber;
           });
  };
  auto first = std::ranges::find_if(reading.rows, [&](const SampledRow& row) {
    return may_be_data(row) && std::ranges::none_of(numeric, [&](std::size_t column) {
             return row.kinds[column] == NumberCell::Kind::kText;
           });
  });
  // Text in every row, each time in another column: the first row is as good as any.
  if (first == reading.rows.end()) first = std::ranges::find_if(reading.rows, may_be_data);
  return static_cast<std::size_t>(first - reading.rows.begin());
}

std::string_view LineAt(std::string_view text, std::size_t offset) {
  text.remove_prefix(offset);
  return text.substr(0, text.find_first_of("\r\n"));
}

/// The words of a blank-separated header with each bracketed unit put back to its name.
std::vector<std::string> JoinBracketedUnits(const CsvRow& words) {
  std::vector<std::string> names;
  bool within_brackets = false;
  for (std::size_t word = 0; word < words.size(); ++word) {
    const std::string_view text = words[word];
    const bool opens = text.starts_with('[') || text.starts_with('(');
    if (!names.empty() && (within_brackets || opens)) {
      names.back() += fmt::format(" {}", text);
    } else {
      names.emplace_back(text);
    }
    const std::string& name = names.back();
    within_brackets = name.find_first_of("[(") != std::string::npos &&
                      name.find_first_of("])") == std::string::npos;
  }
  return names;
}

std::vector<std::string> SplitAtTwoBlanks(std::string_view line) {
  std::vector<std::string> names;
  for (line = Trimmed(line); !line.empty(); line = Trimmed(line)) {
    const std::size_t end = std::min({line.find("  "), line.find('\t'), line.size()});
    names.emplace_back(line.substr(0, end));
    line.remove_prefix(end);
  }
  return names;
}

class HeaderFinder {
 public:
  HeaderFinder(std::string_view text, const std::string& file, const Reading& reading)
      : text_(text), file_(file), reading_(reading), data_(FirstDataRow(reading)) {}

  CsvLayout Find() const {
    CsvLayout layout;
    layout.delimiter = reading_.delimiter;
    layout.columns = reading_.columns;
    layout.usual_columns = reading_.columns;
    const SampledRow& first = reading_.rows[data_];
    layout.data_offset = first.cells.offset;
    layout.data_line = first.cells.line;
    if (data_ == 0) return layout;

    const std::optional<std::vector<std::string>> above = HeaderCells(data_ - 1);
    if (!above) ThrowNoHeader();
    std::size_t header = data_ - 1;
    if (IsUnitsRow(*above)) {
      const auto names = data_ >= 2 ? HeaderCells(data_ - 2) : std::nullopt;
      const bool only_units = std::ranges::all_of(*above, LooksLikeUnit);
      (names || only_units ? layout.units : layout.names) = *above;
      if (names) {
        layout.names = *names;
        --header;
      }
    } else {
      layout.names = *above;
    }
    layout.columns = std::max(layout.names.size(), layout.units.size());
    if (!layout.names.empty()) layout.names.resize(layout.columns);
    if (!layout.units.empty()) layout.units.resize(layout.columns);
    layout.header_line = reading_.rows[header].cells.line;
    layout.preamble_rows = header;
    return layout;
  }

 private:
  /// The cells of a row of text, one for each column of the data; nullopt when it is not that.
  std::optional<std::vector<std::string>> HeaderCells(std::size_t index) const {
    const SampledRow& row = reading_.rows[index];
    if (!row.IsText()) return std::nullopt;
    const CsvRow& data = reading_.rows[data_].cells;
    const std::size_t columns = std::max(row.cells.FilledSize(), data.FilledSize());
    if (columns <= row.cells.size() && (columns <= data.size() || AnyRowHas(columns))) {
      std::vector<std::string> cells;
      cells.reserve(columns);
      for (std::size_t cell = 0; cell < columns; ++cell) {
        cells.emplace_back(Trimmed(row.cells[cell]));
      }
      return cells;
    }
    if (reading_.delimiter == Delimiter::kBlanks) {
      for (auto& cells :
           {JoinBracketedUnits(row.cells), SplitAtTwoBlanks(LineAt(text_, row.cells.offset))}) {
        if (cells.size() == reading_.columns) return cells;
      }
    }
    return std::nullopt;
  }

  /// True if a row of data has so many cells, though the first one has fewer.
  [[nodiscard]] bool AnyRowHas(std::size_t columns) const {
    CsvTokenizer tokenizer(text_, reading_.delimiter, reading_.rows[data_].cells.offset,
                           reading_.rows[data_].cells.line);
    bool found = false;
    for (CsvRow row; tokenizer.Next(row) && row.size() <= columns;) {
      found = found || row.size() == columns;
    }
    return found;
  }

  static bool IsUnitsRow(const std::vector<std::string>& cells) {
    const auto units = std::ranges::count_if(cells, LooksLikeUnit);
    const auto empty = std::ranges::count_if(cells, [](auto& cell) { return cell.empty(); });
    return units > 0 && 2 * units + empty >= std::ssize(cells);
  }

  [[noreturn]] void ThrowNoHeader() const {
    const SampledRow& row = reading_.rows[data_ - 1];
    const SampledRow& data = reading_.rows[data_];
    throw InputError(fmt::format(
        "{}:{}: '{}' is neither a row of data nor a header for the {} column{} of line {}: name "
        "every column, or begin the line with '#' if it is a comment",
        file_, row.cells.line, ForMessage(LineAt(text_, row.cells.offset)), reading_.columns,
        reading_.columns == 1 ? "" : "s", data.cells.line));
  }

  std::string_view text_;
  const std::string& file_;
  const Reading& reading_;
  std::size_t data_;  ///< index of the first data row
};

/// The whole file is at fault: its first row that cannot be a header, and the cell that should have
/// been a number, stand for it.
[[noreturn]] void ThrowNoNumbers(const std::string& file, const Reading& reading) {
  const auto data = std::ranges::find_if(
      reading.rows, [](const SampledRow& row) { return row.Count(NumberCell::Kind::kText) == 0; });
  if (data == reading.rows.end() && reading.rows.size() == 1) {
    throw InputError(fmt::format(
        "{}:{}: the file ends after its header, with no row of numbers below it: export the data "
        "too",
        file, reading.rows.front().cells.line));
  }
  const SampledRow& row = data == reading.rows.end() ? reading.rows.back() : *data;
  const auto cell = static_cast<std::size_t>(
      std::ranges::find_if(
          row.kinds, [](NumberCell::Kind kind) { return kind != NumberCell::Kind::kNumber; }) -
      row.kinds.begin());
  throw InputError(fmt::format(
      "{}:{}:{}: '{}' is not a number, and none of the first {} rows has numbers: expected columns "
      "of numbers under an optional header",
      file, row.cells.line, cell + 1, ForMessage(row.cells[cell]), reading.rows.size()));
}

}  // namespace

void ThrowOpenQuote(const std::string& file, std::size_t line) {
  throw InputError(fmt::format("{}:{}: a quotation mark opened here is never closed", file, line));
}

CsvLayout FindCsvLayout(std::string_view text, const std::string& file) {
  std::optional<Reading> best;
  std::optional<Reading> widest;  // of those without a row of numbers
  bool always_open = true;  // under the wrong delimiter, text after a closing quote reopens it
  std::size_t open_quote_line = 0;
  for (const Delimiter delimiter : kDelimiters) {
    Reading reading = ReadAs(text, delimiter);
    always_open = always_open && reading.open_quote_line > 0;
    open_quote_line = reading.open_quote_line;
    if (reading.columns > 0) {
      if (!best || reading.score > best->score) best = std::move(reading);
    } else if (!reading.rows.empty() && (!widest || reading.Width() > widest->Width())) {
      widest = std::move(reading);
    }
  }
  if (best) return HeaderFinder(text, file, *best).Find();
  if (always_open) ThrowOpenQuote(file, open_quote_line);
  if (!widest) throw InputError(fmt::format("{}: holds no data, only blank or '#' lines", file));
  ThrowNoNumbers(file, *widest);
}

}  // namespace mindahl::io
