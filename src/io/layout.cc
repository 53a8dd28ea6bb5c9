#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "core/text.h"
#include "io/cells.h"
#include "io/column_name.h"
#include "io/source.h"
#include "io/table_reader.h"

namespace mindahl::io {
namespace {

using Strings = std::vector<std::string>;

/// A row of a text, and its cells under some delimiter.
struct Row {
  std::string_view text;
  std::size_t line = 0;
  std::size_t offset = 0;
  Strings cells = {};
  std::vector<Cell::Kind> kinds = {};
  std::size_t numbers = 0;
  std::size_t texts = 0;
  std::size_t filled = 0;   ///< number of cells, empty ones at the end aside
  std::size_t columns = 0;  ///< number of cells, one trailing delimiter aside

  /// @returns false where it has no cell with a content
  bool ReadCells(char delimiter) {
    CellCursor cursor(text, delimiter);
    while (cursor.has_next()) {
      kinds.push_back(ReadCell(cells.emplace_back(cursor.Take()), delimiter).kind);
      numbers += IsNumber(kinds.back()) ? 1 : 0;
      texts += kinds.back() == Cell::Kind::kText ? 1 : 0;
      if (!cells.back().empty()) filled = cells.size();
    }
    columns = cells.size() > 1 && cells.back().empty() ? cells.size() - 1 : cells.size();
    return filled > 0;
  }
  static bool IsNumber(Cell::Kind kind) {
    return kind == Cell::Kind::kNumber || kind == Cell::Kind::kClock;
  }
  /// A trailing delimiter, or empty cells at the end, leave the number of columns open.
  [[nodiscard]] bool CanHave(std::size_t number) const {
    return filled <= number && number <= cells.size();
  }
  /// Looks like data whatever the other rows are: "sample_rate,200" does not, "1,2" does.
  [[nodiscard]] bool HasData() const {
    const auto empty = static_cast<std::size_t>(std::ranges::count(cells, std::string()));
    return numbers >= 1 && (IsNumber(kinds.front()) || cells.size() - texts - empty >= 2);
  }
  [[nodiscard]] bool IsText() const { return numbers == 0 && texts >= 1; }
  /// Returns that many names of a header between blanks: words, each with what is in brackets
  /// behind it, or what two blanks or a tab separate.
  [[nodiscard]] std::optional<Strings> NamesByBlanks(std::size_t number) const {
    Strings names;
    for (const std::string& word : cells) {
      if (names.empty() && (word == "%" || word == "//")) continue;  // the mark of a comment
      const bool is_within = !names.empty() && names.back().find_first_of("[(") != text.npos &&
                             names.back().find_first_of("])") == text.npos;
      if (!names.empty() && (is_within || word.starts_with('[') || word.starts_with('('))) {
        names.back().append(" ").append(word);
      } else {
        names.push_back(word);
      }
    }
    if (names.size() == number) return names;
    names.clear();
    for (std::string_view rest = Trimmed(text); !rest.empty(); rest = Trimmed(rest)) {
      const std::size_t end = std::min({rest.find("  "), rest.find('\t'), rest.size()});
      names.emplace_back(rest.substr(0, end));
      rest.remove_prefix(end);
    }
    return names.size() == number ? std::optional(names) : std::nullopt;
  }
};

bool IsUnitsRow(std::span<const std::string> cells) {
  const auto units = std::ranges::count_if(cells, LooksLikeUnit);
  const auto empty = std::ranges::count_if(cells, [](auto& cell) { return cell.empty(); });
  return units > 0 && 2 * units + empty >= std::ssize(cells);
}

bool StatesUnits(std::string_view first) {
  const std::string label = LowerCase(first);
  return label.find("unit") != std::string::npos || label.starts_with("einheit");
}

/// The first rows of a text under one delimiter, and how well it explains them as columns of
/// numbers.
class Reading {
 public:
  Reading(std::span<const Row> sampled, char delimiter) {
    layout_.delimiter = delimiter;
    std::map<std::size_t, std::size_t> rows_with_columns;
    for (Row row : sampled) {
      if (!row.ReadCells(delimiter)) continue;
      if (row.HasData()) ++rows_with_columns[row.columns];
      rows_.push_back(std::move(row));
    }
    std::size_t most_rows = 0;
    for (const auto& [columns, rows] : rows_with_columns) {
      if (rows < most_rows) continue;
      most_rows = rows;
      columns_ = columns;
    }
    std::vector<std::size_t> numbers;
    for (const Row& row : rows_) {
      if (!row.HasData()) continue;
      numbers.resize(std::max(numbers.size(), row.kinds.size()));
      layout_.holds_numbers.resize(numbers.size());
      for (std::size_t column = 0; column < row.kinds.size(); ++column) {
        const Cell::Kind kind = row.kinds[column];
        if (Row::IsNumber(kind)) ++numbers[column];
        if (kind != Cell::Kind::kText && kind != Cell::Kind::kMissing) {
          layout_.holds_numbers[column] = true;
        }
      }
      if (row.columns != columns_) continue;
      score_ += static_cast<long>(row.numbers) - std::ranges::count(row.kinds, Cell::Kind::kBroken);
    }
    for (const std::size_t count : numbers) layout_.mostly_numbers.push_back(2 * count > most_rows);
  }

  [[nodiscard]] const std::vector<Row>& rows() const { return rows_; }
  [[nodiscard]] std::size_t columns() const { return columns_; }  ///< 0 without a row of data
  /// Returns how well it explains the rows; without a row of data, how many cells it finds.
  [[nodiscard]] std::pair<bool, long> rank() const {
    const auto cells = static_cast<long>(rows_.empty() ? 0 : rows_.back().columns);
    return {columns_ > 0, columns_ > 0 ? score_ : cells};
  }

  /// Finds the data and the header above them, which may be a comment.
  Layout Find(const std::string& file, const Row* comment) && {
    layout_.header.file = file;
    data_ = FirstDataRow();
    layout_.data_offset = rows_[data_].offset;
    layout_.data_line = rows_[data_].line;
    FindNames();
    if (data_ == 0 && comment != nullptr) FindNamesIn(*comment);
    // LabVIEW states the time between rows in place of times.
    const bool has_no_times =
        !names_.empty() && names_.front() == "X_Value" && !layout_.mostly_numbers[0];
    for (const Row& row : std::span(rows_).first(has_no_times ? data_ : 0)) {
      if (row.cells.front() != "Delta_X" || row.cells.size() < 2) continue;
      const double step = ReadCell(row.cells[1], layout_.delimiter).value;
      if (step > 0) layout_.header.interval = step;
    }

    std::vector<TableColumn>& columns = layout_.header.columns;
    columns.resize(std::max({columns_, names_.size(), units_.size()}));
    layout_.holds_numbers.resize(columns.size());
    layout_.mostly_numbers.resize(columns.size());
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (k < names_.size()) columns[k].name = names_[k];
      if (k < units_.size()) columns[k].unit = units_[k];
      // "Disp;mm;Force;N": a column of no numbers, named as a unit, has that of the one before.
      const bool may_be = k > 0 && layout_.mostly_numbers[k - 1] && !layout_.mostly_numbers[k];
      if (may_be && columns[k - 1].unit.empty() && LooksLikeUnit(columns[k].name)) {
        columns[k - 1].unit = columns[k].name;
      }
    }
    return std::move(layout_);
  }

  /// The first row that cannot be a header stands for the file.
  [[noreturn]] void ThrowNoNumbers(const std::string& file) const {
    const auto data = std::ranges::find(rows_, std::size_t{0}, &Row::texts);
    if (data == rows_.end() && rows_.size() == 1) {
      Refuse(
          "{}:{}: the file ends after its header, with no row of numbers below it: export the data "
          "too",
          file, rows_.front().line);
    }
    const Row& row = data == rows_.end() ? rows_.back() : *data;
    Refuse(
        "{}:{}: none of the first {} rows has numbers, nor has '{}': expected columns of numbers "
        "under an optional header, between tabs, ';', blanks, or commas where these are no decimal "
        "marks",
        file, row.line, rows_.size(), ForMessage(row.text));
  }

 private:
  std::size_t FirstDataRow() const {
    const auto has_text_among_numbers = [&](const Row& row) {
      for (std::size_t column = 0; column < row.kinds.size(); ++column) {
        if (layout_.mostly_numbers[column] && row.kinds[column] == Cell::Kind::kText) return true;
      }
      return false;
    };
    // A header of LabVIEW has rows of numbers.
    const auto names =
        std::ranges::find_if(rows_, [](const Row& row) { return row.text.starts_with("X_Value"); });
    for (auto row = names == rows_.end() ? rows_.begin() : names; row != rows_.end(); ++row) {
      if (!row->HasData() || !row->CanHave(columns_)) continue;
      if (!has_text_among_numbers(*row)) return static_cast<std::size_t>(row - rows_.begin());
    }
    return 0;  // text in every row, each time in another column
  }

  /// Returns the cells of a row of text, one for each column of the data; nullopt when it is not
  /// that.
  std::optional<Strings> HeaderCells(const Row& row) const {
    const bool by_blanks = layout_.delimiter == kBlanks;
    // "Load 1" between blanks is words, of which few are numbers.
    const bool is_sentence =
        row.kinds.front() == Cell::Kind::kText && 2 * row.numbers < row.kinds.size();
    if (!row.IsText() && !(by_blanks && is_sentence)) return std::nullopt;
    // Rows may lack the last column, as that of comments or events.
    const std::size_t columns = std::max(row.filled, rows_[data_].filled);
    const std::size_t most = columns_ + (by_blanks ? 0 : 1);
    if (row.IsText() && columns <= row.cells.size() && columns <= most) {
      return Strings(row.cells.begin(), row.cells.begin() + static_cast<std::ptrdiff_t>(columns));
    }
    return by_blanks ? row.NamesByBlanks(columns_) : std::nullopt;
  }

  /// True for a row of text that names every column that mostly holds numbers.
  bool NamesColumns(std::span<const std::string> cells) const {
    for (std::size_t column = 0; column < layout_.mostly_numbers.size(); ++column) {
      const bool is_named = column < cells.size() && !cells[column].empty();
      if (layout_.mostly_numbers[column] && !is_named) return false;
    }
    return true;
  }

  /// Looks for names and units: the row above the data, or, where that is no header or one of
  /// units, the nearest row above with a name for every column; of several the one with most known
  /// words.
  void FindNames() {
    std::size_t header = data_;
    std::size_t most = 0;
    for (std::size_t k = data_; k-- > 0;) {
      const Row& row = rows_[k];
      const bool may_be_data = row.columns >= columns_ && 2 * row.numbers >= row.columns;
      if (names_.empty() && may_be_data) break;
      auto cells = HeaderCells(row);
      if (!cells) continue;
      if (IsUnitsRow(*cells)) {
        const bool states = StatesUnits(cells->front());
        // Units may stand above the names, or above a row of types, "double", where names would.
        const bool are_above = k + 1 == header && std::ranges::all_of(*cells, LooksLikeUnit);
        if (!units_.empty() || (!states && !names_.empty() && !are_above)) continue;
        if (states) cells->front().clear();
        units_ = std::move(*cells);
        layout_.units_row = row.text;
        if (names_.empty()) header = k;
        continue;
      }
      const std::size_t known = CountKnownWords(*cells);
      const bool is_adjacent = k + 1 == data_ || (k + 1 == header && names_.empty());
      const bool is_better = (most == 0 && known >= 2) || (names_.empty() && is_adjacent);
      if (!is_better || (!is_adjacent && !NamesColumns(*cells))) continue;
      most = known;
      header = k;
      names_ = std::move(*cells);
      layout_.names_row = row.text;
    }
    if (names_.empty() && !std::ranges::all_of(units_, LooksLikeUnit)) {
      names_ = std::exchange(units_, {});  // one of the names is a symbol of a unit
      layout_.names_row = std::exchange(layout_.units_row, {});
    }
    if (data_ == 0) return;
    const std::string& file = layout_.header.file;
    for (const Row& row : std::span(rows_).first(data_)) {
      if (!row.cells.back().starts_with('"')) continue;
      Refuse("{}:{}: a quotation mark opened here is never closed in its line", file, row.line);
    }
    if (header == data_) {
      const Row& row = rows_[data_ - 1];
      Refuse(
          "{}:{}: '{}' is neither a row of data nor a header for the {} column{} of line {}: name "
          "every column, or begin the line with '#' if it is a comment{}",
          file, row.line, ForMessage(row.text), columns_, columns_ == 1 ? "" : "s",
          rows_[data_].line,
          layout_.delimiter == ',' && row.columns > 1 && row.columns < columns_
              ? "; or leave out commas that separate thousands or are decimal marks"
              : "");
    }
    layout_.header.header_line = rows_[header].line;
  }

  /// "# time [s]  x [mm]": a header behind a mark of a comment, if it names columns as one does.
  void FindNamesIn(Row comment) {
    comment.text.remove_prefix(comment.text.find('#') + 1);
    if (!comment.ReadCells(layout_.delimiter)) return;
    auto cells = comment.cells.size() == columns_ ? std::optional(comment.cells)
                                                  : comment.NamesByBlanks(columns_);
    if (!cells || CountKnownWords(*cells) < 2) return;
    names_ = *std::move(cells);
    layout_.header.header_line = comment.line;
  }

  Layout layout_;
  Strings names_, units_;  // one a column, or none
  std::vector<Row> rows_;
  std::size_t columns_ = 0;  ///< number in most rows with data
  long score_ = 0;           ///< numbers less broken numbers in the rows with so many columns
  std::size_t data_ = 0;     // index of the first data row
};

}  // namespace

Layout FindLayout(std::string_view text, const std::string& file) {
  std::vector<Row> sampled;
  std::optional<Row> comment;  // the last above all rows, where a header may stand
  std::size_t line = 0;
  for (std::string_view rest = text; !rest.empty() && sampled.size() < kSampledRows;) {
    Row row{.text = {}, .line = ++line, .offset = text.size() - rest.size()};
    row.text = TakeLine(rest);
    if (!IsBlankOrComment(row.text)) {
      sampled.push_back(std::move(row));
    } else if (sampled.empty() && !Trimmed(row.text).empty()) {
      comment = std::move(row);
    }
  }
  std::optional<Reading> best;
  // A tie goes to the first: a cell may contain what comes after it in this list.
  for (const char delimiter : {'\t', ';', ',', kBlanks}) {
    Reading reading(sampled, delimiter);
    if (!best || reading.rank() > best->rank()) best = std::move(reading);
  }
  if (!best || best->rows().empty()) Refuse("{}: holds no data, only blank or '#' lines", file);
  if (best->columns() == 0) best->ThrowNoNumbers(file);
  return std::move(*best).Find(file, comment ? &*comment : nullptr);
}

}  // namespace mindahl::io
