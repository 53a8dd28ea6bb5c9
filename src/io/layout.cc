#include "io/layout.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "core/text.h"
#include "io/cells.h"
#include "io/column_name.h"
#include "io/source.h"
#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

// A tie goes to the first: a cell may contain what comes after it in this list.
constexpr std::array kDelimiters = {'\t', ';', ',', kBlanks};

struct SampledRow {
  std::string_view text;
  std::size_t line = 0;
  std::size_t offset = 0;
};

/// A row under some delimiter.
struct Row {
  SampledRow at;
  std::vector<std::string> cells = {};
  std::vector<Cell::Kind> kinds = {};

  [[nodiscard]] std::size_t Count(Cell::Kind kind) const {
    return static_cast<std::size_t>(std::ranges::count(kinds, kind));
  }
  [[nodiscard]] std::size_t Numbers() const {
    return Count(Cell::Kind::kNumber) + Count(Cell::Kind::kClock);
  }
  /// Number of cells, empty ones at the end aside.
  [[nodiscard]] std::size_t FilledSize() const {
    std::size_t filled = cells.size();
    while (filled > 0 && cells[filled - 1].empty()) --filled;
    return filled;
  }
  /// A trailing delimiter, or empty cells at the end, leave the number of columns open.
  [[nodiscard]] bool CanHave(std::size_t columns) const {
    return FilledSize() <= columns && columns <= cells.size();
  }
  /// Number of cells, one trailing delimiter aside.
  [[nodiscard]] std::size_t Columns() const {
    return cells.size() > 1 && cells.back().empty() ? cells.size() - 1 : cells.size();
  }
  /// Looks like data whatever the other rows are: "sample_rate,200" does not, "1,2" does.
  [[nodiscard]] bool HasData() const {
    const bool begins = kinds.front() == Cell::Kind::kNumber || kinds.front() == Cell::Kind::kClock;
    const auto meant = cells.size() - Count(Cell::Kind::kText) -
                       static_cast<std::size_t>(std::ranges::count(cells, std::string()));
    return Numbers() >= 1 && (begins || meant >= 2);
  }
  [[nodiscard]] bool IsText() const { return Numbers() == 0 && Count(Cell::Kind::kText) >= 1; }
};

/// The rows under one delimiter, and how well it explains them as columns of numbers.
struct Reading {
  char delimiter = ',';
  std::vector<Row> rows = {};
  std::size_t columns = 0;     ///< number in most rows with data; 0 when there are none
  long score = 0;              ///< numbers less broken numbers in the rows with so many columns
  std::size_t most_cells = 0;  // of a row with data
  std::vector<bool> holds_numbers = {}, mostly_numbers = {};
  std::size_t open_quote_line = 0;  // of a quotation mark that is never closed; 0 without one
};

Reading ReadAs(std::span<const SampledRow> sampled, char delimiter) {
  Reading reading{.delimiter = delimiter};
  std::map<std::size_t, std::size_t> rows_with_columns;
  for (const SampledRow& sample : sampled) {
    Row row{.at = sample};
    CellCursor cells(sample.text, delimiter);
    while (cells.has_next()) row.cells.emplace_back(cells.Take());
    if (cells.is_open() && reading.open_quote_line == 0) reading.open_quote_line = sample.line;
    if (cells.is_open() || row.FilledSize() == 0) continue;
    for (const std::string& cell : row.cells) {
      row.kinds.push_back(ReadCell(cell, delimiter != ',').kind);
    }
    if (row.HasData()) ++rows_with_columns[row.Columns()];
    reading.rows.push_back(std::move(row));
  }
  std::size_t most_rows = 0;
  for (const auto& [columns, rows] : rows_with_columns) {
    if (rows < most_rows) continue;
    most_rows = rows;
    reading.columns = columns;
  }
  std::vector<std::size_t> numbers;
  std::vector<std::size_t> meant;  // and what is meant as one
  for (const Row& row : reading.rows) {
    if (!row.HasData()) continue;
    if (row.CanHave(reading.columns) || row.Columns() > reading.columns) {
      reading.most_cells = std::max(reading.most_cells, row.Columns());
    }
    numbers.resize(std::max(numbers.size(), row.kinds.size()));
    meant.resize(numbers.size());
    for (std::size_t column = 0; column < row.kinds.size(); ++column) {
      const Cell::Kind kind = row.kinds[column];
      if (kind == Cell::Kind::kNumber || kind == Cell::Kind::kClock) ++numbers[column];
      if (kind != Cell::Kind::kText && kind != Cell::Kind::kMissing) ++meant[column];
    }
    if (row.Columns() != reading.columns) continue;
    reading.score +=
        static_cast<long>(row.Numbers()) - static_cast<long>(row.Count(Cell::Kind::kBroken));
  }
  for (std::size_t column = 0; column < numbers.size(); ++column) {
    reading.holds_numbers.push_back(meant[column] > 0);
    reading.mostly_numbers.push_back(2 * numbers[column] > most_rows);
  }
  return reading;
}

/// The words of a blank-separated header with each bracketed unit put back to its name.
std::vector<std::string> JoinBracketedUnits(std::span<const std::string> words) {
  std::vector<std::string> names;
  bool within_brackets = false;
  for (const std::string& word : words) {
    const bool opens = word.starts_with('[') || word.starts_with('(');
    if (!names.empty() && (within_brackets || opens)) {
      names.back() += " " + word;
    } else {
      names.push_back(word);
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
  HeaderFinder(const std::string& file, const Reading& reading)
      : file_(file), reading_(reading), data_(FirstDataRow()) {}

  Layout Find() const {
    Layout layout;
    layout.delimiter = reading_.delimiter;
    layout.columns = reading_.columns;
    const Row& first = reading_.rows[data_];
    layout.data_offset = first.at.offset;
    layout.data_line = first.at.line;
    FindNames(layout);
    layout.columns = std::max({layout.columns, layout.names.size(), layout.units.size()});
    if (!layout.names.empty()) layout.names.resize(layout.columns);
    if (!layout.units.empty()) layout.units.resize(layout.columns);
    layout.holds_numbers = reading_.holds_numbers;
    layout.mostly_numbers = reading_.mostly_numbers;
    layout.holds_numbers.resize(layout.columns);
    layout.mostly_numbers.resize(layout.columns);
    return layout;
  }

 private:
  [[nodiscard]] std::size_t FirstDataRow() const {
    const std::vector<Row>& rows = reading_.rows;
    // A header of LabVIEW has rows of numbers.
    const auto names = std::ranges::find_if(
        rows, [](const Row& row) { return row.at.text.starts_with("X_Value"); });
    std::optional<std::size_t> any;
    for (auto row = names == rows.end() ? rows.begin() : names; row != rows.end(); ++row) {
      // One that has more than most, as an event of a logger, stands below a header that names
      // them.
      const bool is_named = row != rows.begin() && row->cells.size() > reading_.columns &&
                            (row - 1)->IsText() && (row - 1)->cells.size() >= row->cells.size();
      if (!row->HasData() || (!row->CanHave(reading_.columns) && !is_named)) continue;
      const auto place = static_cast<std::size_t>(row - rows.begin());
      if (!HasTextAmongNumbers(*row)) return place;
      if (!any) any = place;
    }
    // Text in every row, each time in another column: the first row is as good as any.
    return any.value_or(0);
  }

  [[nodiscard]] bool HasTextAmongNumbers(const Row& row) const {
    for (std::size_t column = 0; column < row.kinds.size(); ++column) {
      if (reading_.mostly_numbers[column] && row.kinds[column] == Cell::Kind::kText) return true;
    }
    return false;
  }

  /// The cells of a row of text, one for each column of the data; nullopt when it is not that.
  std::optional<std::vector<std::string>> HeaderCells(std::size_t index) const {
    const Row& row = reading_.rows[index];
    const bool by_blanks = reading_.delimiter == kBlanks;
    // "Load 1" between blanks is words, of which few are numbers.
    const bool is_sentence =
        row.kinds.front() == Cell::Kind::kText && 2 * row.Numbers() < row.kinds.size();
    if (!row.IsText() && !(by_blanks && is_sentence)) return std::nullopt;
    const Row& data = reading_.rows[data_];
    // Rows may lack the last column, as that of comments or events.
    const std::size_t columns = std::max(row.FilledSize(), data.FilledSize());
    const std::size_t most = reading_.most_cells + (by_blanks ? 0 : 1);
    if (row.IsText() && columns <= row.cells.size() && columns <= most) {
      return std::vector<std::string>(row.cells.begin(),
                                      row.cells.begin() + static_cast<std::ptrdiff_t>(columns));
    }
    if (by_blanks) {
      for (auto& cells : {JoinBracketedUnits(row.cells), SplitAtTwoBlanks(row.at.text)}) {
        if (cells.size() == reading_.columns) return cells;
      }
    }
    return std::nullopt;
  }

  static bool IsUnitsRow(std::span<const std::string> cells) {
    const auto units = std::ranges::count_if(cells, LooksLikeUnit);
    const auto empty = std::ranges::count_if(cells, [](auto& cell) { return cell.empty(); });
    return units > 0 && 2 * units + empty >= std::ssize(cells);
  }

  /// True for a row of text that names every column that mostly holds numbers.
  [[nodiscard]] bool NamesColumns(std::span<const std::string> cells) const {
    for (std::size_t column = 0; column < reading_.mostly_numbers.size(); ++column) {
      if (reading_.mostly_numbers[column] && (column >= cells.size() || cells[column].empty())) {
        return false;
      }
    }
    return true;
  }

  /// Looks for names and units: the row above the data, or, where that is no header or one of
  /// units, the nearest row above with a name for every column; of several the one with most known
  /// words.
  void FindNames(Layout& layout) const {
    constexpr std::size_t kFarthest = 100;
    const std::size_t begin = data_ - std::min(data_, kFarthest);
    std::size_t header = data_;
    std::size_t most = 0;
    for (std::size_t k = data_; k-- > begin;) {
      const Row& row = reading_.rows[k];
      const bool may_be_data =
          row.Columns() >= reading_.columns && 2 * row.Numbers() >= row.Columns();
      if (layout.names.empty() && may_be_data) break;
      auto cells = HeaderCells(k);
      if (!cells) {
        FindStatedUnits(row, layout);
        continue;
      }
      if (IsUnitsRow(*cells)) {
        const bool states = StatesUnits(cells->front());
        if (!layout.units.empty() || (!states && !layout.names.empty())) continue;
        if (states) cells->front().clear();
        layout.units = std::move(*cells);
        layout.units_row = row.at.text;
        if (layout.names.empty()) header = k;
        continue;
      }
      const std::size_t known = CountKnownWords(*cells);
      const bool is_adjacent = k + 1 == data_ || (k + 1 == header && layout.names.empty());
      const bool is_better = (most == 0 && known >= 2) || (layout.names.empty() && is_adjacent);
      if (!is_better || (!is_adjacent && !NamesColumns(*cells))) continue;
      most = known;
      header = k;
      layout.names = std::move(*cells);
      layout.names_row = row.at.text;
    }
    if (layout.names.empty() && !std::ranges::all_of(layout.units, LooksLikeUnit)) {
      layout.names = std::exchange(layout.units, {});  // one of the names is a symbol of a unit
      layout.names_row = std::exchange(layout.units_row, {});
    }
    FindInterval(layout);
    if (data_ == 0) return;
    if (header == data_) ThrowNoHeader();
    layout.header_line = reading_.rows[header].at.line;
    layout.preamble_rows = header;
  }

  static bool StatesUnits(std::string_view first) {
    const std::string label = LowerCase(first);
    return label.find("unit") != std::string::npos || label.starts_with("einheit");
  }

  /// A row of the preamble that states the units, "Y_Unit_Label" of LabVIEW or "Unit", behind which
  /// those of the columns stand.
  void FindStatedUnits(const Row& row, Layout& layout) const {
    if (!layout.units.empty() || row.cells.size() < 2) return;
    if (!StatesUnits(row.cells.front()) || row.cells.size() > reading_.columns + 1) return;
    layout.units = row.cells;
    layout.units.front().clear();
    layout.units.resize(reading_.columns);
  }

  /// The time between rows of a LabVIEW file without a column of it.
  void FindInterval(Layout& layout) const {
    if (layout.names.empty() || layout.names.front() != "X_Value" || reading_.mostly_numbers[0])
      return;
    for (std::size_t k = 0; k < data_; ++k) {
      const Row& row = reading_.rows[k];
      if (row.cells.front() != "Delta_X" || row.cells.size() < 2) continue;
      const Cell cell = ReadCell(row.cells[1], true);
      if (cell.kind == Cell::Kind::kNumber && cell.value > 0) layout.interval = cell.value;
    }
  }

  [[noreturn]] void ThrowNoHeader() const {
    const Row& row = reading_.rows[data_ - 1];
    throw InputError(fmt::format(
        "{}:{}: '{}' is neither a row of data nor a header for the {} column{} of line {}: name "
        "every column, or begin the line with '#' if it is a comment{}",
        file_, row.at.line, ForMessage(row.at.text), reading_.columns,
        reading_.columns == 1 ? "" : "s", reading_.rows[data_].at.line,
        reading_.delimiter == ',' && row.Columns() > 1 && row.Columns() < reading_.columns
            ? "; or leave out commas that separate thousands or are decimal marks"
            : ""));
  }

  const std::string& file_;
  const Reading& reading_;
  std::size_t data_;  ///< index of the first data row
};

/// The whole file is at fault: its first row that cannot be a header, and the cell that should have
/// been a number, stand for it.
[[noreturn]] void ThrowNoNumbers(const std::string& file, const Reading& reading) {
  const auto data = std::ranges::find_if(
      reading.rows, [](const Row& row) { return row.Count(Cell::Kind::kText) == 0; });
  if (data == reading.rows.end() && reading.rows.size() == 1) {
    throw InputError(fmt::format(
        "{}:{}: the file ends after its header, with no row of numbers below it: export the data "
        "too",
        file, reading.rows.front().at.line));
  }
  const Row& row = data == reading.rows.end() ? reading.rows.back() : *data;
  const auto cell = static_cast<std::size_t>(
      std::ranges::find_if(row.kinds, [](Cell::Kind kind) { return kind != Cell::Kind::kNumber; }) -
      row.kinds.begin());
  const std::string_view remedy =
      row.at.text.find('|') != std::string_view::npos
          ? "; separate the columns by ',', ';' or tabs in place of '|'"
      : row.cells[cell].find(',') != std::string::npos
          ? "; where commas are decimal marks, separate the columns by ';' or tabs"
          : "";
  throw InputError(fmt::format(
      "{}:{}:{}: '{}' is not a number, and none of the first {} rows has numbers: expected columns "
      "of numbers under an optional header{}",
      file, row.at.line, cell + 1, ForMessage(row.cells[cell]), reading.rows.size(), remedy));
}

/// The delimiter that a first line for spreadsheets states, "sep=;"; '\0' where there is none.
char StatedDelimiter(std::string_view row) {
  if (row.starts_with('"') && row.ends_with('"')) row = row.substr(1, row.size() - 2);
  const bool states = row.size() == 5 && LowerCase(row.substr(0, 4)) == "sep=";
  return states ? row.back() : '\0';
}

}  // namespace

Layout FindLayout(std::string_view text, const std::string& file) {
  std::vector<SampledRow> sampled;
  std::optional<SampledRow> comment;  // the last above all rows, where a header may stand
  char stated = '\0';
  std::size_t line = 0;
  for (std::string_view rest = text; !rest.empty() && sampled.size() < kSampledRows;) {
    SampledRow row{{}, line + 1, text.size() - rest.size()};
    row.text = TakeRow(rest, line);
    if (row.line == 1) stated = StatedDelimiter(row.text);
    if (row.line == 1 && stated != '\0') continue;
    if (!IsBlankOrComment(row.text)) {
      sampled.push_back(row);
    } else if (sampled.empty() && !Trimmed(row.text).empty()) {
      comment = row;
    }
  }
  std::optional<Reading> best;
  std::optional<Reading> widest;  // of those without a row of numbers
  bool always_open = true;  // under the wrong delimiter, text after a closing quote reopens it
  std::size_t open_quote_line = 0;
  for (const char delimiter : kDelimiters) {
    if (stated != '\0' && delimiter != stated) continue;
    Reading reading = ReadAs(sampled, delimiter);
    always_open = always_open && reading.open_quote_line > 0;
    open_quote_line = reading.open_quote_line;
    if (reading.columns > 0) {
      if (!best || reading.score > best->score) best = std::move(reading);
    } else if (!reading.rows.empty() &&
               (!widest || reading.rows.back().Columns() > widest->rows.back().Columns())) {
      widest = std::move(reading);
    }
  }
  const auto throw_open = [&](std::size_t at) {
    throw InputError(fmt::format("{}:{}: a quotation mark opened here is never closed", file, at));
  };
  if (!best) {
    if (always_open && open_quote_line > 0) throw_open(open_quote_line);
    if (!widest) throw InputError(fmt::format("{}: holds no data, only blank or '#' lines", file));
    ThrowNoNumbers(file, *widest);
  }
  Layout layout = HeaderFinder(file, *best).Find();
  if (best->open_quote_line > 0 && best->open_quote_line < layout.data_line) {
    throw_open(best->open_quote_line);
  }
  if (layout.header_line == 0 && comment) {
    // "# time [s]  x [mm]": a header behind a mark of a comment, if it names columns as one does.
    comment->text.remove_prefix(comment->text.find('#') + 1);
    const Reading above = ReadAs(std::span(&*comment, 1), layout.delimiter);
    if (above.rows.size() == 1) {
      for (auto& cells : {above.rows.front().cells, JoinBracketedUnits(above.rows.front().cells),
                          SplitAtTwoBlanks(comment->text)}) {
        if (cells.size() != layout.columns || CountKnownWords(cells) < 2) continue;
        layout.names = cells;
        layout.header_line = comment->line;
        break;
      }
    }
  }
  return layout;
}

}  // namespace mindahl::io
