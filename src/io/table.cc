#include "io/table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <utility>

#include "core/text.h"
#include "io/cells.h"

namespace mindahl::io {
namespace {

using Strings = std::vector<std::string>;

constexpr double kBroken = std::numeric_limits<double>::infinity();
constexpr const char* kUnclosed = "a quotation mark opened here is never closed in its line";

/// Takes the first line off a text, without its end.
std::string_view TakeLine(std::string_view& text) {
  const std::size_t end = std::min(text.find('\n'), text.size());
  const std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
}

/// A row of a text, and its cells under some delimiter and decimal mark.
struct Row {
  std::string_view text = {};
  std::size_t line = 0;
  bool is_comment = false;  // the last above all rows, where names may stand
  Strings cells = {};
  std::vector<Cell::Kind> kinds = {};
  std::size_t filled = 0;   // number of cells, empty ones at the end aside
  std::size_t columns = 0;  // number of cells, one trailing delimiter aside

  void ReadCells(char delimiter, char decimal_mark) {
    CellCursor cursor(text, delimiter);
    while (cursor.has_next()) {
      kinds.push_back(ReadCell(cells.emplace_back(cursor.Take()), decimal_mark).kind);
      if (!cells.back().empty()) filled = cells.size();
    }
    columns = cells.size() > 1 && cells.back().empty() ? cells.size() - 1 : cells.size();
  }
  [[nodiscard]] std::size_t Count(Cell::Kind kind) const {
    return static_cast<std::size_t>(std::ranges::count(kinds, kind));
  }
  /// Looks like data whatever the other rows are: "sample_rate,200" does not, "1,2" does.
  [[nodiscard]] bool HasData() const {
    const std::size_t texts = Count(Cell::Kind::kText);
    const auto empty = static_cast<std::size_t>(std::ranges::count(cells, std::string()));
    return !is_comment && Count(Cell::Kind::kNumber) >= 1 &&
           (kinds.front() == Cell::Kind::kNumber || cells.size() - texts - empty >= 2);
  }
  /// Returns names between blanks: words with brackets behind them, or between two blanks or a tab.
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

/// The first rows of a text under one delimiter and decimal mark, and how well these explain them.
class Reading {
 public:
  Reading(std::span<const Row> sampled, char delimiter, char decimal_mark)
      : layout_{.delimiter = delimiter, .decimal_mark = decimal_mark} {
    std::map<std::size_t, std::size_t> rows_with_columns;
    for (Row row : sampled) {
      row.ReadCells(delimiter, decimal_mark);
      if (row.filled == 0) continue;
      if (row.HasData()) ++rows_with_columns[row.columns];
      rows_.push_back(std::move(row));
    }
    std::size_t most_rows = 0;
    for (const auto& [columns, rows] : rows_with_columns) {
      if (rows < most_rows) continue;
      most_rows = rows;
      columns_ = columns;
      score_ = 0;
    }
    std::vector<std::size_t> numbers;  // of each column
    for (const Row& row : rows_) {
      if (!row.HasData()) continue;
      numbers.resize(std::max(numbers.size(), row.kinds.size()));
      layout_.is_wanted.resize(numbers.size());
      for (std::size_t column = 0; column < row.kinds.size(); ++column) {
        const bool is_number = row.kinds[column] == Cell::Kind::kNumber;
        const bool is_broken = row.kinds[column] == Cell::Kind::kBroken;
        if (is_number) ++numbers[column];
        if (is_number || is_broken) layout_.is_wanted[column] = true;
        if (row.columns == columns_) score_ += int{is_number} - int{is_broken};
      }
    }
    for (const std::size_t count : numbers) mostly_numbers_.push_back(2 * count > most_rows);
  }

  /// Returns how well it explains the rows.
  [[nodiscard]] long score() const { return score_; }

  /// Finds the data and the header above them, which may be a comment.
  Layout Find(CsvTable& table) && {
    const bool has_rows = !rows_.empty() && !rows_.back().is_comment;
    if (!has_rows) Refuse("{}: holds no data, only blank or '#' lines", table.file);
    if (columns_ == 0) {
      Refuse(
          "{}:{}: no row down to '{}' has numbers: expected columns of them, under an optional "
          "header, between tabs, ';', blanks, or commas where these are no decimal marks",
          table.file, rows_.back().line, ForMessage(rows_.back().text));
    }
    FindData(table);
    FindNames(table);
    const std::size_t columns = std::max({columns_, names_.size(), units_.size()});
    for (auto* const of_each : {&names_, &units_}) of_each->resize(columns);
    layout_.is_wanted.resize(columns);
    mostly_numbers_.resize(columns);
    layout_.text_column = static_cast<std::size_t>(std::ranges::find(mostly_numbers_, true) -
                                                   mostly_numbers_.begin());
    for (std::size_t k = 0; k < columns; ++k) {
      // "Disp;mm;Force;N": a column of no numbers, named as a unit, has that of the one before.
      const bool is_unit_behind = k + 1 < columns && mostly_numbers_[k] &&
                                  !mostly_numbers_[k + 1] && LooksLikeUnit(names_[k + 1]);
      if (is_unit_behind && units_[k].empty()) units_[k] = names_[k + 1];
      table.columns.push_back(ReadName(names_[k], units_[k]));
    }
    return std::move(layout_);
  }

 private:
  /// Finds the first row of data: with as many cells as most have, and no text among numbers.
  void FindData(CsvTable& table) {
    // A header of LabVIEW has rows of numbers, and states their interval in place of times.
    const auto names =
        std::ranges::find_if(rows_, [](const Row& row) { return row.text.starts_with("X_Value"); });
    const bool is_labview = names != rows_.end();
    const auto is_data = [this](const Row& row) {
      // A trailing delimiter, or empty cells at the end, leave the number of columns open.
      bool may_be = row.filled <= columns_ && columns_ <= row.cells.size() && row.HasData();
      for (std::size_t column = 0; column < row.kinds.size() && may_be; ++column) {
        may_be = !mostly_numbers_[column] || row.kinds[column] != Cell::Kind::kText;
      }
      return may_be;
    };
    auto data = std::find_if(is_labview ? names : rows_.begin(), rows_.end(), is_data);
    // Else text is in every row, each time in another column.
    if (data == rows_.end()) data = std::ranges::find(rows_, false, &Row::is_comment);
    data_ = static_cast<std::size_t>(data - rows_.begin());
    layout_.data_line = data->line;
    for (const Row& row : std::span(rows_).first(data_)) {
      const bool may_be = is_labview && !mostly_numbers_[0] && row.cells.size() > 1;
      if (!may_be || row.cells[0] != "Delta_X") continue;
      const double step = ReadCell(row.cells[1], layout_.decimal_mark).value;
      if (step > 0) table.interval = step;
    }
  }

  /// Returns the cells of a row of text, one for each column of the data; nullopt of another row.
  std::optional<Strings> HeaderCells(const Row& row) const {
    const bool by_blanks = layout_.delimiter == kBlanks;
    const std::size_t numbers = row.Count(Cell::Kind::kNumber);
    // Rows may lack the last column, as that of comments or events.
    const std::size_t columns = std::max(row.filled, rows_[data_].filled);
    const bool is_text = numbers == 0 && row.Count(Cell::Kind::kText) >= 1;
    if (is_text && !by_blanks && columns <= std::min(row.cells.size(), columns_ + 1)) {
      return Strings(row.cells.begin(), row.cells.begin() + static_cast<std::ptrdiff_t>(columns));
    }
    // "Load 1" between blanks is words, of which few are numbers.
    const bool may_be = row.kinds.front() == Cell::Kind::kText && 2 * numbers < row.kinds.size();
    return may_be && (by_blanks || row.is_comment) ? row.NamesByBlanks(columns_) : std::nullopt;
  }

  /// Looks for names and units: the row above the data, or, where that is no header or one of
  /// units, the nearest row above of which two words are known.
  void FindNames(CsvTable& table) {
    std::size_t header = data_;
    bool are_known = false;
    for (std::size_t k = data_; k-- > 0;) {
      const Row& row = rows_[k];
      const bool may_be_data =
          row.columns >= columns_ && 2 * row.Count(Cell::Kind::kNumber) >= row.columns;
      if (names_.empty() && may_be_data) break;
      auto cells = HeaderCells(row);
      if (!cells) continue;
      if (!row.is_comment && IsUnitsRow(*cells)) {
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
      const bool is_adjacent = names_.empty() && k + 1 == header;
      const auto known = std::ranges::count_if(*cells, [](const std::string& cell) {
        const Column column = ReadName(cell);
        return !column.unit.empty() || !column.word.empty();
      });
      const bool is_above_units = std::ranges::all_of(units_, LooksLikeUnit);
      const bool may_be =
          row.is_comment ? is_adjacent && is_above_units && known >= 2 : is_adjacent || known >= 2;
      if (are_known || !may_be) continue;
      are_known = known > 0;
      header = k;
      names_ = *std::move(cells);
      layout_.names_row = row.text;
    }
    if (names_.empty() && !std::ranges::all_of(units_, LooksLikeUnit)) {
      names_ = std::exchange(units_, {});  // one of the names is a symbol of a unit
      layout_.names_row = std::exchange(layout_.units_row, {});
    }
    for (const Row& row : std::span(rows_).first(data_)) {
      if (row.is_comment || !row.cells.back().starts_with('"')) continue;
      Refuse("{}:{}: {}", table.file, row.line, kUnclosed);
    }
    if (header < data_) {
      table.header_line = rows_[header].line;
    } else if (data_ > 0 && !rows_[data_ - 1].is_comment) {
      const Row& row = rows_[data_ - 1];
      Refuse(
          "{}:{}: '{}' is neither a row of data nor a header for line {}: name every column, begin "
          "the line with '#' if it is a comment, or remove commas within numbers",
          table.file, row.line, ForMessage(row.text), rows_[data_].line);
    }
  }

  Layout layout_;
  std::vector<bool> mostly_numbers_;  // of each column, in the rows with data
  Strings names_, units_;             // one a column, or none
  std::vector<Row> rows_;             // the comment first
  std::size_t columns_ = 0;           // number in most rows with data
  // Numbers less broken numbers in the rows with so many columns.
  long score_ = std::numeric_limits<long>::min();
  std::size_t data_ = 0;  // index of the first data row
};

/// Finds how a text, or its begin, is to be read, and the columns of its table.
Layout FindLayout(std::string_view text, CsvTable& table) {
  constexpr std::size_t kSampledRows = 1000;  // at most so many are above the data
  std::vector<Row> sampled;
  std::size_t line = 0;
  for (std::string_view rest = text; !rest.empty() && sampled.size() < kSampledRows;) {
    Row row{.text = TakeLine(rest), .line = ++line};
    row.is_comment = IsBlankOrComment(row.text);
    if (!row.is_comment) {
      sampled.push_back(std::move(row));
    } else if ((sampled.empty() || sampled.back().is_comment) && !Trimmed(row.text).empty()) {
      row.text.remove_prefix(row.text.find('#') + 1);
      sampled.assign(1, row);
    }
  }
  std::optional<Reading> best;
  // A tie goes to the first: a cell may contain what comes after it in this list.
  for (const char delimiter : {'\t', ';', ',', kBlanks}) {
    for (const char decimal_mark : {'.', ','}) {
      // In quotes the delimiter may be a decimal mark, "-0,0754"; one behind 0 parts no thousands.
      const bool occurs = decimal_mark != delimiter
                              ? delimiter == kBlanks || text.find(delimiter) != text.npos
                              : text.find("\"0,") != text.npos || text.find("\"-0,") != text.npos;
      if (!occurs) continue;
      Reading reading(sampled, delimiter, decimal_mark);
      if (!best || reading.score() > best->score()) best = std::move(reading);
    }
  }
  return std::move(*best).Find(table);
}

}  // namespace

std::span<const double> CsvTable::Numbers(std::size_t column) const {
  const Column& of = columns.at(column);
  if (of.values.empty()) {
    Refuse("{}:{}:{}: {} holds no numbers", file, lines.front(), column + 1, Label(column));
  }
  if (!of.broken.empty()) throw InputError(of.broken);
  if (!of.missing.empty()) throw InputError(of.missing);
  return of.values;
}

std::optional<std::size_t> CsvTable::Best(Role role, bool may_tie,
                                          const std::function<int(std::size_t)>& score) const {
  std::size_t best = 0, last = 0;  // the first and the last with the greatest
  int most = 0;
  for (std::size_t column = 0; column < columns.size(); ++column) {
    const int found = score(column);
    if (found > most) best = column;
    if (found >= most) last = column;
    most = std::max(most, found);
  }
  if (most == 0) return std::nullopt;
  if (best == last || may_tie) return best;
  Refuse("{}: {} and {} may each be the {}: choose one by its number, as {} {}", Header(),
         Label(best), Label(last), RulesOf(role).name, RulesOf(role).option, best + 1);
}

std::optional<std::size_t> CsvTable::Named(std::string_view name, Role role) const {
  const std::string lower = LowerCase(name);
  return Best(role, false, [&](std::size_t column) {
    const Column& of = columns[column];
    const bool is_like = LowerCase(of.header) == lower || LowerCase(of.name) == lower;
    return name.empty() ? 0 : of.header == name ? 2 : int{is_like};
  });
}

std::string CsvTable::Label(std::size_t column) const {
  const std::string& name = columns[column].header;
  if (name.empty()) return fmt::format("column {}", column + 1);
  return fmt::format("'{}' (column {})", ForMessage(name), column + 1);
}

std::string CsvTable::Listing() const {
  constexpr std::size_t kMost = 20;
  Strings listed(std::min(columns.size(), kMost));
  for (std::size_t column = 0; column < listed.size(); ++column) listed[column] = Label(column);
  if (columns.size() > kMost) listed.push_back(fmt::format("… {} in all", columns.size()));
  return fmt::format("the columns are {}", fmt::join(listed, ", "));
}

TableReader::TableReader(const std::filesystem::path& path, const std::string& encoding)
    : pieces_(path, encoding), first_(pieces_.Next()), table_{.file = pieces_.name()} {
  if (!pieces_.note().empty()) table_.notes.push_back(pieces_.note());
  layout_ = FindLayout(first_, table_);
}

bool TableReader::Read() {
  const std::string no_content = {layout_.delimiter, ' ', '\t', '\r'};
  std::string_view text = first_.empty() ? pieces_.Next() : std::exchange(first_, {});
  const bool is_end = text.empty();
  while (!text.empty()) {
    const std::string_view row = TakeLine(text);
    if (++line_ < layout_.data_line) continue;
    const std::size_t first = row.find_first_not_of(' ');
    const char front = first < row.size() ? row[first] : ' ';
    const bool is_number = IsDigit(front) || front == '-';
    const auto is_blank = [&] { return row.find_first_not_of(no_content) == row.npos; };
    if (!is_number && (IsBlankOrComment(row) || is_blank() || IsText(row))) continue;
    EndText();
    ReadRow(row);
  }
  if (is_end) EndText();
  return !is_end;
}

void TableReader::KeepColumns(const std::vector<std::size_t>& wanted) {
  layout_.is_wanted.assign(table_.columns.size(), false);
  for (const std::size_t column : wanted) layout_.is_wanted[column] = true;
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

void TableReader::ReadRow(std::string_view row) {
  const std::vector<bool>& is_wanted = layout_.is_wanted;
  const bool has_points = layout_.decimal_mark == '.';
  table_.lines.push_back(line_);
  CellCursor cells(row, layout_.delimiter);
  std::size_t column = 0;
  std::size_t excess = 0;  // the first column that the table has not
  for (; cells.has_next(); ++column) {
    if (column >= is_wanted.size() || !is_wanted[column]) {
      const bool has_content = !cells.Take().empty();
      if (has_content && column >= is_wanted.size() && excess == 0) excess = column;
      continue;
    }
    double value = 0.0;
    if (!has_points || !cells.TakeNumber(value)) value = ReadText(column, cells.Take());
    table_.columns[column].values.push_back(value);
  }
  // A column that is not used may be absent.
  while (column < is_wanted.size() && !is_wanted[column]) ++column;
  if (cells.is_open()) {
    Break(fmt::format("{}:{}: {}", table_.file, line_, kUnclosed), 0);
  } else if (excess > 0) {
    Break(At(excess, "one cell too many: remove it, or commas within numbers"), 0);
  } else if (column < is_wanted.size()) {
    Break(At(column, "the row ends before this column: complete it or remove it"), column);
  }
}

/// Says what is at fault in the last row, from a column on.
void TableReader::Break(const std::string& fault, std::size_t column) {
  for (; column < layout_.is_wanted.size(); ++column) {
    if (!layout_.is_wanted[column]) continue;
    Column& of = table_.columns[column];
    of.values.resize(table_.lines.size());
    of.values.back() = kBroken;
    if (of.broken.empty()) of.broken = fault;
  }
}

/// Describes the fault of a cell that should hold a number, and the remedy.
std::string TableReader::NoNumber(std::size_t column, std::string_view text) const {
  return At(column, fmt::format("'{}' is not a number: write one like -1{}5e-3, without separators "
                                "of thousands, or remove the row",
                                ForMessage(text), layout_.decimal_mark));
}

/// Returns the value of a cell that is not plainly a number.
double TableReader::ReadText(std::size_t column, std::string_view text) {
  const Cell cell = ReadCell(text, layout_.decimal_mark);
  Column& of = table_.columns[column];
  of.is_clock = of.is_clock || cell.is_clock;
  if (cell.kind == Cell::Kind::kNumber) return cell.value;
  const bool is_missing = cell.kind == Cell::Kind::kMissing;
  std::string& said = is_missing ? of.missing : of.broken;
  if (said.empty()) said = NoNumber(column, text);
  return is_missing ? cell.value : kBroken;
}

/// True for a row of text that is, or may be above, a header that is repeated.
bool TableReader::IsText(std::string_view row) {
  if (row == layout_.names_row) text_fault_.clear();
  if (row == layout_.names_row || row == layout_.units_row) return true;
  CellCursor cells(row, layout_.delimiter);
  for (std::size_t k = 0; k < layout_.text_column && cells.has_next(); ++k) cells.Take();
  const std::string_view cell = cells.has_next() ? cells.Take() : std::string_view();
  if (ReadCell(cell, layout_.decimal_mark).kind != Cell::Kind::kText) return false;
  if (!text_fault_.empty()) return true;
  text_line_ = line_;
  text_fault_ = NoNumber(layout_.text_column, cell);
  return true;
}

/// Ends the text above a row of numbers, or the file, which is at fault unless it is a header.
void TableReader::EndText() {
  if (text_fault_.empty()) return;
  table_.lines.push_back(text_line_);
  Break(text_fault_, 0);
  text_fault_.clear();
}

CsvTable ReadCsvTable(const std::filesystem::path& path, const std::string& encoding) {
  TableReader reader(path, encoding);
  while (reader.Read()) {
  }
  Observe(reader.table().columns);
  return std::move(reader.table());
}

}  // namespace mindahl::io
