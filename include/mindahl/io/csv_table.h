#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::io {

/// The name of standard input where a file is asked for; ./- is a file of that name.
inline constexpr std::string_view kStandardInput = "-";

/// Rows that were left out, as a column that is used has no number there, and the fault of the
/// first.
struct LeftOutRows {
  std::size_t count = 0;
  std::string fault = {};  ///< "file:line:column: …"

  /// "2 rows are left out, the first: loop.csv:3:1: …"
  [[nodiscard]] std::string InWords() const;
};

/// A column of a table.
struct TableColumn {
  std::string name{};  ///< header cell as written, "" without one
  /// One a row; none in a column of text. NaN where the cell is empty or holds a mark of a missing
  /// number, infinite where it or its row is at fault otherwise.
  std::vector<double> values = {};
  std::string unit = {};  ///< cell of the units row, "" without one
  bool is_clock = false;  ///< its numbers are times of day [s]
  /// Say of the first NaN, and of the first infinite value: "file:line:column: …".
  std::string missing = {}, broken = {};
};

/// A delimited text of columns. Positions in messages are `file:line:column`, with the 1-based
/// physical line on which the row begins and the 1-based number of the cell in it.
struct CsvTable {
  std::string file;
  std::vector<TableColumn> columns;
  std::vector<std::size_t> lines = {};   ///< the physical line of each row
  std::vector<std::size_t> blocks = {};  ///< rows below a header that is repeated among them
  std::size_t header_line = 0;           ///< physical line of the header, 0 when there is none
  double interval = 0.0;  ///< [s] between rows, where the header states it instead of times
  std::vector<std::string> notes = {};  ///< sentences on what was assumed of the file

  [[nodiscard]] std::size_t rows() const { return lines.size(); }
  /// Returns the numbers of a column, one a row, valid as long as the table.
  /// @throws InputError at the first cell that is missing or is not a number
  [[nodiscard]] std::span<const double> Numbers(std::size_t column) const;
};

/// Reads a delimited text as a table, from a file that is plain or compressed by gzip.
///
/// *Delimiter.* Tab, semicolon, comma or runs of blanks: the one under which the first 1000 rows
/// hold the most numbers less broken numbers ("5;2", "12:30"), in that order on a tie. The decimal
/// mark is a point, or a comma that is not the delimiter; both in one file is an error. Cells may
/// be quoted (RFC 4180) within a line, a trailing delimiter is no cell.
///
/// *Data.* A row with data has a number in its first cell, or at least two cells that are or were
/// meant to be numbers, one of them a number: "sample_rate,200" has none. The data begin at the
/// first row with as many cells as most such rows and no text in a column of numbers. Text below is
/// an error, unless it repeats the header; blank lines and comments, which begin with '#', are not.
///
/// *Header.* Of the rows of text above the data one with a name for every column of numbers has the
/// names, and one where at least half of the cells are symbols of units has these; other rows are
/// skipped. A file whose first row is data has the header of a last comment above it, or none.
///
/// About 0.1 s for 10⁶ cells; keeps 8 bytes a number.
/// @param path         kStandardInput reads that, called "standard input" in messages
/// @param encoding     as iconv calls it; "" for UTF-8, UTF-16 with its mark, or, with a note,
///   Shift-JIS or Windows-1252 by the first bytes
/// @throws InputError also when the file cannot be read: one that holds a zero byte or a line of
///   more than 16 MiB is read no further
CsvTable ReadCsvTable(const std::filesystem::path& path, const std::string& encoding = {});

/// Returns a table of columns that are in memory, to be read as a file with these names in its
/// first line is; its lines are the rows, counted from 1.
/// @param columns  of one length, at least one; their names, with units, and numbers
/// @param source   where they are from, for messages
/// @throws InputError where lengths differ, and where there is no column or no row
CsvTable TableOfColumns(std::vector<TableColumn> columns, std::string source);

/// One column to write. The values must outlive the call that writes them.
struct CsvColumn {
  std::string name;  ///< with its unit, e.g. "displacement [m]"
  std::span<const double> values;
};

/// Returns a text as one cell, quoted when it must be: RFC 4180 §2.6, and a '#' or a blank at an
/// end, or nothing at all, which a reader would take for its own.
std::string CsvCell(const std::string& text);

/// Returns the columns as CSV text (RFC 4180, with LF at line ends): a header, then one row a
/// value, with 17 significant digits so that every double reads back as itself. NaN, a value that
/// is not known, is an empty cell.
/// @param columns  at least one; all of one length
/// @throws InvalidArgument when lengths differ, there is no column, or a value is infinite
std::string CsvText(const std::vector<CsvColumn>& columns);

}  // namespace mindahl::io
