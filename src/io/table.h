#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/cells.h"
#include "io/columns.h"

namespace mindahl::io {

/// A delimited text of columns. Positions in messages are `file:line:column`, counted from 1.
struct CsvTable {
  std::string file;
  std::vector<Column> columns = {};
  std::vector<std::size_t> lines = {};  ///< the physical line of each row
  std::size_t repeats = 0;              ///< number of times the header stands among the rows
  std::size_t header_line = 0;          ///< physical line of the header, 0 when there is none
  double interval = 0.0;  ///< [s] between rows, where the header states it instead of times
  std::vector<std::string> notes = {};  ///< sentences on what was assumed of the file

  [[nodiscard]] std::size_t rows() const { return lines.size(); }
  /// Returns the numbers of a column, one a row, valid as long as the table.
  /// @throws InputError at the first cell that is missing or is not a number
  [[nodiscard]] std::span<const double> Numbers(std::size_t column) const;
  /// Returns the column of a name, from 0; empty where there is none.
  /// @throws InputError where it is that of several
  [[nodiscard]] std::optional<std::size_t> Named(std::string_view name, Role role) const;
  /// "'x [mm]' (column 2)", or "column 2" without a header.
  [[nodiscard]] std::string Label(std::size_t column) const;
  /// "the columns are 'x' (1), 'F' (2)".
  [[nodiscard]] std::string Listing() const;
  /// "file:line" of the header.
  [[nodiscard]] std::string Header() const;
  /// Refuses two columns for one role.
  [[noreturn]] void ThrowAmbiguous(Role role, std::size_t one, std::size_t other) const;
};

/// How a text is to be read as a table.
///
/// *Delimiter and decimal mark.* Tab, semicolon, comma or runs of blanks, and a point or a comma
/// that is not the delimiter: those under which the first 1000 rows hold the most numbers less
/// broken numbers ("5;2", "12:30"), in that order on a tie. Cells may be quoted (RFC 4180) within a
/// line, a trailing delimiter is no cell.
///
/// *Data.* A row with data has a number in its first cell, or at least two cells that are or were
/// meant to be numbers, one of them a number: "sample_rate,200" has none. The data begin at the
/// first row with as many cells as most such rows and no text in a column of numbers. Text below is
/// an error, unless it repeats the header; blank lines and comments, which begin with '#', are not.
///
/// *Header.* Of the rows of text above the data one with two words that are known, or the last, has
/// the names, and one where at least half of the cells are symbols of units has these; other rows
/// are skipped. A file whose first row is data has the header of a last comment above it, or none.
struct Layout {
  CsvTable header;  ///< the table without rows
  char delimiter = ',', decimal_mark = '.';
  // In some of the first rows, and in most, a column holds a number or what is meant as one.
  std::vector<bool> holds_numbers = {}, mostly_numbers = {};
  std::size_t data_offset = 0;                 ///< start of the first data row [bytes]
  std::size_t data_line = 0;                   ///< its physical line
  std::string names_row = {}, units_row = {};  // as they stand in the file: blocks repeat them
};

/// @param text  the begin of a file, or all of it
/// @throws InputError when no row of numbers is found, or the row above the data is no header
Layout FindLayout(std::string_view text, const std::string& file);

/// Fills a table from the rows of a text that comes in pieces.
class TableReader {
 public:
  /// @param wanted  columns to read, from 0: those of numbers where none is given; the others stay
  ///   empty
  explicit TableReader(const Layout& layout, const std::vector<std::size_t>& wanted = {});

  /// Reads further rows.
  /// @param text  of whole lines; the first piece without what is above the data
  void Read(std::string_view text);
  /// Ends the text above a row of numbers, or the file, which repeated the header or is at fault.
  void EndText();

  [[nodiscard]] CsvTable& table() { return table_; }
  /// Forgets the rows read so far.
  void Clear();

 private:
  void ReadRow(std::string_view row);
  double ReadText(std::size_t column, std::string_view text);
  bool BelongsToHeader(std::string_view row);
  void Break(const std::string& fault, std::size_t column);
  [[nodiscard]] std::string At(std::size_t column, std::string_view fault) const;

  Layout layout_;
  CsvTable table_;
  std::vector<bool> is_wanted_;  // of each column
  std::size_t text_column_;      // where a row of text has its text
  std::size_t line_;
  char front_ = '\0';  // of the last row
  // They describe the text since the last row of numbers; fault and line are those of the first
  // text that is not a header.
  bool repeats_header_ = false;
  std::string text_fault_;
  std::size_t text_line_ = 0;
};

/// Reads a delimited text as a table, from a file that is plain or compressed by gzip. About 0.1 s
/// for 10⁶ cells; keeps 8 bytes a number.
/// @param encoding     as LinePieces takes it
/// @throws InputError also when the file cannot be read: one that holds a zero byte or a line of
///   more than 16 MiB is read no further
CsvTable ReadCsvTable(const std::filesystem::path& path, const std::string& encoding = {});

}  // namespace mindahl::io
