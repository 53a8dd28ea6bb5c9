#include "io/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include "core/text.h"
#include "io/source.h"

namespace mindahl::io {
namespace {

using Strings = std::vector<std::string>;

constexpr double kBroken = std::numeric_limits<double>::infinity();

/// A row of a text, and its cells under some delimiter and decimal mark.
struct Row {
  std::string_view text = {};
  std::size_t line = 0;
  std::size_t offset = 0;
  Strings cells = {};
  std::vector<Cell::Kind> kinds = {};
  std::size_t numbers = 0, texts = 0, empty = 0;
  std::size_t filled = 0;   // number of cells, empty ones at the end aside
  std::size_t columns = 0;  // number of cells, one trailing delimiter aside

  /// @returns false where it has no cell with a content
  bool ReadCells(char delimiter, char decimal_mark) {
    CellCursor cursor(text, delimiter);
    while (cursor.has_next()) {
      kinds.push_back(ReadCell(cells.emplace_back(cursor.Take()), decimal_mark).kind);
      numbers += kinds.back() == Cell::Kind::kNumber ? 1 : 0;
      texts += kinds.back() == Cell::Kind::kText ? 1 : 0;
      empty += cells.back().empty() ? 1 : 0;
      if (!cells.back().empty()) filled = cells.size();
    }
    columns = cells.size() > 1 && cells.back().empty() ? cells.size() - 1 : cells.size();
    return filled > 0;
  }
  /// Looks like data whatever the other rows are: "sample_rate,200" does not, "1,2" does.
  [[nodiscard]] bool HasData() const {
    return numbers >= 1 &&
           (kinds.front() == Cell::Kind::kNumber || cells.size() - texts - empty >= 2);
  }
  /// Returns that many names of a header between blanks: words, each with what is in brackets
  /// behind it, or what two blanks or a tab separate.
  [[nodiscard]] std::optional<Strings> NamesByBlanks(std::size_t number) const {
    Strings names;
    for (const std::string& word : cells) {
      if (names.empty() && (word == "%" || word == "//")) continue;  // the mark of a comment
      const bool is_within = !names.empty() && names.back().find_first_of("[(") != text.npos &&
                             names.back().find_first_of("])") == text.npos;
      if (!names.empty() && (is_within || word.starts_with('[') || word.starts_with('('))) {
        names.back() += ' ' + word;
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
  return units > 0 && 2 * units + std::ranges::count(cells, std::string()) >= std::ssize(cells);
}

/// The first rows of a text under one delimiter and decimal mark, and how well it explains them as
/// columns of numbers.
class Reading {
 public:
  Reading(std::span<const Row> sampled, const std::string& file, char delimiter, char decimal_mark)
      : layout_{.header = {.file = file}, .delimiter = delimiter, .decimal_mark = decimal_mark} {
    std::map<std::size_t, std::size_t> rows_with_columns;
    for (Row row : sampled) {
      if (!row.ReadCells(delimiter, decimal_mark)) continue;
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
        const bool is_number = kind == Cell::Kind::kNumber;
        if (is_number) ++numbers[column];
        if (is_number || kind == Cell::Kind::kBroken) layout_.holds_numbers[column] = true;
      }
      if (row.columns != columns_) continue;
      score_ += static_cast<long>(row.numbers) - std::ranges::count(row.kinds, Cell::Kind::kBroken);
    }
    for (const std::size_t count : numbers) layout_.mostly_numbers.push_back(2 * count > most_rows);
  }

  /// Returns how well it explains the rows; without a row of data, how many cells it finds.
  [[nodiscard]] std::pair<bool, long> rank() const {
    const auto cells = static_cast<long>(rows_.empty() ? 0 : rows_.back().columns);
    return {columns_ > 0, columns_ > 0 ? score_ : cells};
  }

  /// Finds the data and the header above them, which may be a comment.
  Layout Find(const Row& comment) && {
    const std::string& file = layout_.header.file;
    if (rows_.empty()) Refuse("{}: holds no data, only blank or '#' lines", file);
    if (columns_ == 0) {
      // The first row that cannot be a header stands for the file.
      const auto data = std::ranges::find(rows_, std::size_t{0}, &Row::texts);
      const Row& row = data == rows_.end() ? rows_.back() : *data;
      Refuse(
          "{}:{}: none of the first {} rows has numbers, nor has '{}': expected columns of numbers "
          "under an optional header, between tabs, ';', blanks, or commas where these are no "
          "decimal marks",
          file, row.line, rows_.size(), ForMessage(row.text));
    }
    FindData();
    FindNames();
    if (data_ == 0) FindNamesIn(comment);
    const std::size_t columns = std::max({columns_, names_.size(), units_.size()});
    for (auto* const of_each : {&names_, &units_}) of_each->resize(columns);
    layout_.holds_numbers.resize(columns);
    layout_.mostly_numbers.resize(columns);
    // "Disp;mm;Force;N": a column of no numbers, named as a unit, has that of the one before.
    for (std::size_t k = 1; k < columns; ++k) {
      const bool may_be = layout_.mostly_numbers[k - 1] && !layout_.mostly_numbers[k];
      if (may_be && units_[k - 1].empty() && LooksLikeUnit(names_[k])) units_[k - 1] = names_[k];
    }
    for (std::size_t k = 0; k < columns; ++k) {
      layout_.header.columns.push_back(ReadName(names_[k], units_[k]));
    }
    return std::move(layout_);
  }

 private:
  /// Finds the first row of data: with as many cells as most have, and no text among numbers.
  void FindData() {
    // A header of LabVIEW has rows of numbers, and states their interval in place of times.
    const auto names =
        std::ranges::find_if(rows_, [](const Row& row) { return row.text.starts_with("X_Value"); });
    const bool is_labview = names != rows_.end();
    const auto is_data = [this](const Row& row) {
      // A trailing delimiter, or empty cells at the end, leave the number of columns open.
      bool may_be = row.filled <= columns_ && columns_ <= row.cells.size() && row.HasData();
      for (std::size_t column = 0; column < row.kinds.size() && may_be; ++column) {
        may_be = !layout_.mostly_numbers[column] || row.kinds[column] != Cell::Kind::kText;
      }
      return may_be;
    };
    const auto data = std::find_if(is_labview ? names : rows_.begin(), rows_.end(), is_data);
    // Else text is in every row, each time in another column.
    if (data != rows_.end()) data_ = static_cast<std::size_t>(data - rows_.begin());
    layout_.data_offset = rows_[data_].offset;
    layout_.data_line = rows_[data_].line;
    for (const Row& row : std::span(rows_).first(data_)) {
      if (!is_labview || layout_.mostly_numbers[0] || row.cells.size() < 2) continue;
      if (row.cells[0] != "Delta_X") continue;
      const double step = ReadCell(row.cells[1], layout_.decimal_mark).value;
      if (step > 0) layout_.header.interval = step;
    }
  }

  /// Returns the cells of a row of text, one for each column of the data; nullopt when it is not
  /// that.
  std::optional<Strings> HeaderCells(const Row& row) const {
    const bool by_blanks = layout_.delimiter == kBlanks;
    // "Load 1" between blanks is words, of which few are numbers.
    const bool is_text = row.numbers == 0 && row.texts >= 1;
    const bool is_sentence =
        by_blanks && row.kinds.front() == Cell::Kind::kText && 2 * row.numbers < row.kinds.size();
    if (!is_text && !is_sentence) return std::nullopt;
    // Rows may lack the last column, as that of comments or events.
    const std::size_t columns = std::max(row.filled, rows_[data_].filled);
    const std::size_t most = columns_ + (by_blanks ? 0 : 1);
    if (is_text && columns <= row.cells.size() && columns <= most) {
      return Strings(row.cells.begin(), row.cells.begin() + static_cast<std::ptrdiff_t>(columns));
    }
    return by_blanks ? row.NamesByBlanks(columns_) : std::nullopt;
  }

  /// Looks for names and units: the row above the data, or, where that is no header or one of
  /// units, the nearest row above of which two words are known.
  void FindNames() {
    std::size_t header = data_;
    bool are_known = false;
    for (std::size_t k = data_; k-- > 0;) {
      const Row& row = rows_[k];
      const bool may_be_data = row.columns >= columns_ && 2 * row.numbers >= row.columns;
      if (names_.empty() && may_be_data) break;
      auto cells = HeaderCells(row);
      if (!cells) continue;
      if (IsUnitsRow(*cells)) {
        const bool says_so = LowerCase(cells->front()).find("unit") != std::string::npos;
        // Units may stand above the names.
        const bool are_above = k + 1 == header && std::ranges::all_of(*cells, LooksLikeUnit);
        if (!units_.empty() || !(names_.empty() || says_so || are_above)) continue;
        if (says_so) cells->front().clear();
        if (names_.empty()) header = k;
        units_ = *std::move(cells);
        layout_.units_row = row.text;
        continue;
      }
      const bool is_adjacent = names_.empty() && (k + 1 == data_ || k + 1 == header);
      const std::size_t known = CountKnownWords(*cells);
      if (are_known || !(is_adjacent || known >= 2)) continue;
      are_known = known > 0;
      header = k;
      names_ = *std::move(cells);
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
    layout_.header.header_line = rows_[header].line;
    if (header < data_) return;
    const Row& row = rows_[data_ - 1];
    Refuse(
        "{}:{}: '{}' is neither a row of data nor a header for the {} column{} of line {}: name "
        "every column, begin the line with '#' if it is a comment, or leave out commas that "
        "separate "
        "thousands",
        file, row.line, ForMessage(row.text), columns_, columns_ == 1 ? "" : "s",
        rows_[data_].line);
  }

  /// "# time [s]  x [mm]": a header behind a mark of a comment, if it names columns as one does.
  void FindNamesIn(Row comment) {
    comment.text.remove_prefix(std::min(comment.text.find('#') + 1, comment.text.size()));
    if (!comment.ReadCells(layout_.delimiter, layout_.decimal_mark)) return;
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

std::span<const double> CsvTable::Numbers(std::size_t column) const {
  const Column& of = columns.at(column);
  if (of.values.empty()) {
    Refuse("{}:{}:{}: '{}' (column {}) holds no numbers", file,
           lines.empty() ? header_line : lines.front(), column + 1, ForMessage(of.header),
           column + 1);
  }
  if (!of.broken.empty()) throw InputError(of.broken);
  if (!of.missing.empty()) throw InputError(of.missing);
  return of.values;
}

std::optional<std::size_t> CsvTable::Named(std::string_view name, Role role) const {
  const std::string lower = LowerCase(name);
  for (const bool exactly : {true, false}) {
    std::optional<std::size_t> found;
    for (std::size_t column = 0; column < columns.size() && !name.empty(); ++column) {
      const std::string& full = columns[column].header;
      const bool is_one =
          exactly ? full == name
                  : LowerCase(full) == lower || LowerCase(columns[column].name) == lower;
      if (is_one && found) ThrowAmbiguous(role, *found, column);
      if (is_one) found = column;
    }
    if (found) return found;
  }
  return std::nullopt;
}

std::string CsvTable::Label(std::size_t column) const {
  const std::string& name = columns[column].header;
  if (header_line == 0 || name.empty()) return fmt::format("column {}", column + 1);
  return fmt::format("'{}' (column {})", ForMessage(name), column + 1);
}

std::string CsvTable::Listing() const {
  if (std::ranges::all_of(columns, [](auto& column) { return column.header.empty(); })) {
    return fmt::format("the file names none of its {} columns", columns.size());
  }
  std::vector<std::string> listed;
  for (const Column& column : columns) {
    listed.push_back(fmt::format("'{}' ({})", ForMessage(column.header), listed.size() + 1));
  }
  return fmt::format("the columns are {}", fmt::join(listed, ", "));
}

std::string CsvTable::Header() const { return fmt::format("{}:{}", file, header_line); }

void CsvTable::ThrowAmbiguous(Role role, std::size_t one, std::size_t other) const {
  Refuse("{}: {} and {} may each be the {}: choose one by its number, as {} {}", Header(),
         Label(one), Label(other), RulesOf(role).name, RulesOf(role).option, one + 1);
}

Layout FindLayout(std::string_view text, const std::string& file) {
  constexpr std::size_t kSampledRows = 1000;  // at most so many are above the data
  std::vector<Row> sampled;
  Row comment;  // the last above all rows, where a header may stand
  std::size_t line = 0;
  for (std::string_view rest = text; !rest.empty() && sampled.size() < kSampledRows;) {
    Row row{.line = ++line, .offset = text.size() - rest.size()};
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
    for (const char decimal_mark : {'.', ','}) {
      const bool occurs = delimiter == kBlanks || text.find(delimiter) != text.npos;
      if (!occurs || decimal_mark == delimiter) continue;
      Reading reading(sampled, file, delimiter, decimal_mark);
      if (!best || reading.rank() > best->rank()) best = std::move(reading);
    }
  }
  return std::move(*best).Find(comment);
}

TableReader::TableReader(const Layout& layout, const std::vector<std::size_t>& wanted)
    : layout_(layout),
      table_(layout.header),
      is_wanted_(wanted.empty() ? layout.holds_numbers
                                : std::vector<bool>(layout.header.columns.size())),
      // A row of text has its text in the first column of numbers.
      text_column_(static_cast<std::size_t>(std::ranges::find(layout.mostly_numbers, true) -
                                            layout.mostly_numbers.begin())),
      line_(layout.data_line - 1) {
  for (const std::size_t column : wanted) is_wanted_[column] = true;
}

void TableReader::Clear() {
  table_.lines.clear();
  for (Column& column : table_.columns) {
    column.values.clear();
    column.broken.clear();
    column.missing.clear();
  }
}

std::string TableReader::At(std::size_t column, std::string_view fault) const {
  return fmt::format("{}:{}:{}: {}", table_.file, line_, column + 1, fault);
}

void TableReader::Read(std::string_view text) {
  const std::string no_content = {layout_.delimiter, ' ', '\t', '\r'};
  while (!text.empty()) {
    ++line_;
    const std::string_view row = TakeLine(text);
    const std::size_t first = row.starts_with(' ') ? row.find_first_not_of(' ') : 0;
    const char front = first < row.size() ? row[first] : ' ';
    const bool is_number = IsDigit(front) || front == '-';
    const bool may_be_none = !is_number && !IsLetter(front);
    if (may_be_none && (IsBlankOrComment(row) || row.find_first_not_of(no_content) == row.npos)) {
      continue;
    }
    if (!is_number && BelongsToHeader(row)) continue;
    EndText();
    ReadRow(row);
    front_ = front;
  }
}

void TableReader::ReadRow(std::string_view row) {
  const std::size_t columns = is_wanted_.size();
  const bool has_points = layout_.decimal_mark == '.';
  table_.lines.push_back(line_);
  CellCursor cells(row, layout_.delimiter);
  std::size_t count = 0;
  for (; count < columns && cells.has_next(); ++count) {
    if (!is_wanted_[count]) {
      cells.Take();
      continue;
    }
    double value = 0.0;
    if (!has_points || !cells.TakeNumber(value)) value = ReadText(count, cells.Take());
    table_.columns[count].values.push_back(value);
  }
  std::string fault;  // of the row
  for (std::size_t column = count; cells.has_next(); ++column) {
    if (cells.Take().empty() || !fault.empty()) continue;
    fault = At(column, fmt::format("one cell too many: the table has {} column{}{}", columns,
                                   columns == 1 ? "" : "s",
                                   layout_.delimiter == ','
                                       ? "; leave out commas that separate thousands, and separate "
                                         "the columns by ';' or tabs where commas are decimal marks"
                                       : ""));
  }
  if (cells.is_open()) {
    fault = fmt::format("{}:{}: a quotation mark opened here is never closed in its line",
                        table_.file, line_);
  }
  if (!fault.empty()) Break(fault, 0);
  if (std::find(is_wanted_.begin() + static_cast<std::ptrdiff_t>(count), is_wanted_.end(), true) ==
      is_wanted_.end()) {
    return;
  }
  Break(At(count, fmt::format("the row has {} cell{} of {}: complete it or remove it", count,
                              count == 1 ? "" : "s", columns)),
        count);
}

/// Says what is at fault in the last row, from a column on.
void TableReader::Break(const std::string& fault, std::size_t column) {
  for (; column < is_wanted_.size(); ++column) {
    if (!is_wanted_[column]) continue;
    Column& of = table_.columns[column];
    of.values.resize(table_.lines.size());
    of.values.back() = kBroken;
    if (of.broken.empty()) of.broken = fault;
  }
}

/// Returns the value of a cell that is not plainly a number.
double TableReader::ReadText(std::size_t column, std::string_view text) {
  const Cell cell = ReadCell(text, layout_.decimal_mark);
  Column& of = table_.columns[column];
  of.is_clock = of.is_clock || cell.is_clock;
  if (cell.kind == Cell::Kind::kNumber) return cell.value;
  const bool is_missing = cell.kind == Cell::Kind::kMissing;
  std::string& said = is_missing ? of.missing : of.broken;
  if (said.empty()) said = At(column, DescribeCellFault(text, cell.kind, layout_.decimal_mark));
  return is_missing ? cell.value : kBroken;
}

/// True for a row of text that repeats the header, or may be above a header that is repeated.
bool TableReader::BelongsToHeader(std::string_view row) {
  if ((!layout_.names_row.empty() && row == layout_.names_row) ||
      (repeats_header_ && row == layout_.units_row)) {
    repeats_header_ = true;
    text_fault_.clear();
    return true;
  }
  // Rows with a label begin alike.
  if (text_column_ == is_wanted_.size() || (IsLetter(row.front()) && row.front() == front_)) {
    return false;
  }
  CellCursor cells(row, layout_.delimiter);
  for (std::size_t k = 0; k < text_column_ && cells.has_next(); ++k) cells.Take();
  double number = 0.0;
  if (cells.TakeNumber(number)) return false;
  const std::string cell(cells.has_next() ? cells.Take() : std::string_view());
  if (ReadCell(cell, layout_.decimal_mark).kind != Cell::Kind::kText) return false;
  if (!text_fault_.empty()) return true;
  text_line_ = line_;
  text_fault_ = At(text_column_, DescribeCellFault(cell, Cell::Kind::kText, layout_.decimal_mark));
  if (!layout_.names_row.empty()) {
    text_fault_ += fmt::format(
        "; a further block of rows must have the columns of line {} above it", table_.header_line);
  }
  return true;
}

void TableReader::EndText() {
  if (!text_fault_.empty()) {
    table_.lines.push_back(text_line_);
    Break(text_fault_, 0);
  } else if (repeats_header_) {
    ++table_.repeats;
  }
  text_fault_.clear();
  repeats_header_ = false;
}

CsvTable ReadCsvTable(const std::filesystem::path& path, const std::string& encoding) {
  const std::string name = NameOfInput(path);
  LinePieces pieces(path, encoding);
  std::string_view text = pieces.Next();
  const Layout layout = FindLayout(text, name);
  TableReader reader(layout);
  for (text.remove_prefix(layout.data_offset); !text.empty(); text = pieces.Next()) {
    reader.Read(text);
  }
  reader.EndText();
  CsvTable table = std::move(reader.table());
  Observe(table.columns);
  if (table.repeats > 0) {
    table.notes.push_back(
        fmt::format("{}:{}: the header is repeated {} times: the blocks are joined", name,
                    table.header_line, table.repeats));
  }
  if (!pieces.note().empty()) table.notes.insert(table.notes.begin(), pieces.note());
  return table;
}

}  // namespace mindahl::io
