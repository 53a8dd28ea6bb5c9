#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::io {

/// A column that is in memory already.
struct NamedColumn {
  std::string name;            ///< header cell with its unit: "x [um]"
  std::vector<double> values;  ///< NaN where there is no number
};

/// The name of standard input where a file is asked for; ./- is a file of that name.
inline constexpr std::string_view kStandardInput = "-";

/// Limits the size of a file that is read whole. A file beyond it is refused as soon as that
/// shows, not when it has been read.
struct ReadLimits {
  std::uintmax_t rows = std::numeric_limits<std::uintmax_t>::max();
  /// Memory [bytes] for the table and its fit: kMemoryOfRow a row and kMemoryOfText a byte.
  std::uintmax_t memory = std::numeric_limits<std::uintmax_t>::max();

  /// Memory [bytes] of a fit per row, and of reading it per byte of text, measured for records of
  /// three columns: 1.14 kB a row of 59 bytes.
  static constexpr std::uintmax_t kMemoryOfRow = 1000;
  static constexpr std::uintmax_t kMemoryOfText = 3;

  /// @returns the memory [bytes] that so much takes
  static std::uintmax_t MemoryOf(std::uintmax_t rows, std::uintmax_t text) {
    return kMemoryOfRow * rows + kMemoryOfText * text;
  }
};

/// A delimited text file of columns, read whole: the numbers as doubles, and the text itself, to
/// which messages go back. Positions in messages are `file:line:column`, with the 1-based physical
/// line on which the row begins and the 1-based number of the cell in it.
class CsvTable {
 public:
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] std::size_t rows() const { return lines_.size(); }
  [[nodiscard]] std::size_t columns() const { return values_.size(); }

  /// Returns the header cells as written, one a column, or none when the file has no names row.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }
  /// Cells of the units row, one a column, or none when the file has no units row.
  [[nodiscard]] const std::vector<std::string>& units() const { return units_; }
  /// Returns the physical line of the header, 0 when there is none.
  [[nodiscard]] std::size_t header_line() const { return header_line_; }
  /// Returns the number of rows of preamble above the header, blank lines and comments aside.
  [[nodiscard]] std::size_t preamble_rows() const { return preamble_rows_; }
  /// Returns what was assumed of the file and left out below the data, a sentence each.
  [[nodiscard]] const std::vector<std::string>& notes() const { return notes_; }
  /// Returns the number of rows with fewer cells than the table has columns.
  [[nodiscard]] std::size_t short_rows() const { return short_rows_; }
  /// Returns the physical line of each data row.
  [[nodiscard]] const std::vector<std::size_t>& lines() const { return lines_; }

  /// Returns the numbers of a column, one a row, valid as long as the table.
  /// @param column  from 0, < columns()
  /// @throws InputError at the first cell that is missing or is not a number, and at the first
  /// whose
  ///   decimal mark separates thousands beyond doubt: all others of the column are whole, below
  ///   1000, and the column is smooth without the mark only
  [[nodiscard]] std::span<const double> Numbers(std::size_t column) const;

  /// Returns the same, with NaN where a cell is missing or is not a number.
  [[nodiscard]] std::span<const double> NumbersOrNan(std::size_t column) const {
    return values_.at(column);
  }

  /// True when the column was read with decimal commas, and every cell is written like 1,234, so
  /// that nothing in it distinguishes them from commas that separate thousands.
  [[nodiscard]] bool MayHaveCommasForThousands(std::size_t column) const;

  /// Returns the times of a column whose every cell is a time of day, with or without a date, as
  /// seconds since midnight of the first one's day; empty where they are not.
  [[nodiscard]] std::optional<std::vector<double>> Times(std::size_t column) const;

  /// False when not one cell of the column is a number.
  [[nodiscard]] bool HasNumbers(std::size_t column) const;

 private:
  friend CsvTable ParseCsvTable(std::string text, std::string file);
  friend CsvTable ReadCsvTable(const std::filesystem::path& path, const ReadLimits& limits,
                               const std::string& encoding);
  friend CsvTable TableOfColumns(std::vector<NamedColumn> columns, std::string source);
  [[noreturn]] void ThrowNotANumber(std::size_t row, std::size_t column) const;
  void RequireNoThousands(std::size_t column) const;
  void DropFooter(std::size_t rows);
  /// Returns the cells as written, without blanks around them.
  [[nodiscard]] std::vector<std::string> Cells(std::size_t column) const;

  std::string file_;
  std::string text_;  ///< empty for columns that were in memory
  char delimiter_ = ',';
  std::vector<std::string> names_;
  std::vector<std::string> units_;
  std::size_t header_line_ = 0;
  std::size_t preamble_rows_ = 0;
  std::size_t short_rows_ = 0;
  std::vector<std::string> notes_;
  std::vector<std::vector<double>> values_;  ///< columns; NaN where the cell is not a number
  std::vector<std::size_t> lines_;
  std::vector<std::size_t> offsets_;  ///< start of each data row in text_ [bytes]
};

/// Reads a delimited text as a table.
///
/// *Text.* UTF-8 or ASCII, with or without byte order mark; lines end in LF, CRLF or CR, the last
/// one optionally. Blank lines, rows of delimiters alone and lines that begin with '#' are skipped,
/// but for error values of a spreadsheet ("#N/A"), which are cells that hold no number.
/// Cells may be quoted (RFC 4180). A trailing delimiter is no cell.
///
/// *Delimiter.* Tab, semicolon, comma or runs of blanks: the one under which the first 1000 rows
/// hold the most numbers less broken numbers ("5;2", "12:30"), in that order on a tie. Hence
/// "1,5;2,5" has two columns and decimal commas, and "1,5" has two columns of integers.
///
/// *Decimal mark.* Point; or comma, when the comma is not the delimiter. Both in one file is an
/// error: one of the two would separate thousands.
///
/// *Data.* A row with data has a number in its first cell, or at least two cells that are or were
/// meant to be numbers, one of them a number: "sample_rate,200" has none. The number of columns is
/// that of most such rows. The data begin at the first row with so many cells and no text in a
/// column of numbers; from there on every row is data, and none may be longer than the header.
///
/// *Header.* The row above the data is the names row; or, when at least half of its cells are
/// symbols of units, the units row, with the names row above it (or none, when all are). It has a
/// text for every column of a row of data, more than most of them have where some rows have more
/// cells; in a blank-separated file "Time [s]" is one, and so is whatever stands
/// between two or more blanks. What is above the header is preamble and skipped. A file whose first
/// row is data has no header. Anything else above the data is an error: a comment there must begin
/// with '#'.
///
/// *Footer.* Rows at the end that begin with a text are skipped, with a note.
///
/// @param text  the file's content
/// @param file  its name, for messages
/// @throws InputError naming file, line and, where there is one, column
/// About 0.1 s for 10⁶ cells; keeps the text and 8 bytes a cell.
CsvTable ParseCsvTable(std::string text, std::string file);

/// Parses a file as ParseCsvTable() does.
/// @param path      kStandardInput reads that, called "standard input" in messages
/// @param encoding  as iconv calls it; "" for UTF-8, or UTF-16, Shift-JIS or Windows-1252 by the
///   first bytes, with a note of the latter two
/// @throws InputError also when the file cannot be read, and where it is beyond the limits: a file
///   that is too large, holds a zero byte or a line of more than 16 MiB is read no further
CsvTable ReadCsvTable(const std::filesystem::path& path, const ReadLimits& limits = {},
                      const std::string& encoding = {});

/// Returns a table of columns that are in memory, to be read as a file with these names in its
/// first line is; its lines are the rows, counted from 1.
/// @param columns  of one length, at least one
/// @param source   where they are from, for messages
/// @throws InputError where lengths differ, and where there is no column or no row
CsvTable TableOfColumns(std::vector<NamedColumn> columns, std::string source);

/// One column to write. The values must outlive the call that writes them.
struct CsvColumn {
  std::string name;  ///< with its unit, e.g. "displacement [m]"
  std::span<const double> values;
};

/// Returns a text as one cell, quoted when it must be: RFC 4180 §2.6, and a '#' or a blank at an
/// end, or nothing at all, which a reader would take for its own. Where a spreadsheet would take it
/// for a formula, since it begins with =, +, - or @, it begins with ./ instead, so that the name of
/// a file still is one.
std::string CsvCell(const std::string& text);

/// Returns the columns as CSV text (RFC 4180, with LF at line ends): a header, then one row a
/// value, with 17 significant digits so that every double reads back as itself. NaN, a value that
/// is not known, is an empty cell.
/// @param columns  at least one; all of one length
/// @throws InvalidArgument when lengths differ, there is no column, or a value is infinite
std::string CsvText(const std::vector<CsvColumn>& columns);

}  // namespace mindahl::io
