#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/columns.h"
#include "io/source.h"

namespace mindahl::io {

/// A delimited text of columns. Positions in messages are `file:line:column`, counted from 1.
struct CsvTable {
  std::string file;
  std::vector<Column> columns = {};
  std::vector<std::size_t> lines = {};  ///< the physical line of each row
  std::size_t header_line = 0;          ///< physical line of the header, 0 when there is none
  double interval = 0.0;  ///< [s] between rows, where the header states it instead of times
  std::vector<std::string> notes = {};  ///< sentences on what was assumed of the file

  [[nodiscard]] std::size_t rows() const { return lines.size(); }
  /// Returns the numbers of a column, one a row, valid as long as the table.
  /// @throws InputError at the first cell that is missing or is not a number
  [[nodiscard]] std::span<const double> Numbers(std::size_t column) const;
  /// Returns the column, from 0, of the greatest score; empty where all have 0.
  /// @throws InputError where several have it, unless the first of them is the one
  [[nodiscard]] std::optional<std::size_t> Best(Role role, bool may_tie,
                                                const std::function<int(std::size_t)>& score) const;
  /// Returns the column of a name; empty where there is none.
  /// @throws InputError where it is that of several
  [[nodiscard]] std::optional<std::size_t> Named(std::string_view name, Role role) const;
  /// "'x [mm]' (column 2)", or "column 2" without a header.
  [[nodiscard]] std::string Label(std::size_t column) const;
  /// "the columns are 'x' (column 1), 'F' (column 2)".
  [[nodiscard]] std::string Listing() const;
  /// "file:line" of the header.
  [[nodiscard]] std::string Header() const { return file + ':' + std::to_string(header_line); }
};

/// How the rows of a text are read. Delimiter and decimal mark are those under which the first 1000
/// rows hold the most numbers less broken numbers ("5;2", "12:30").
struct Layout {
  char delimiter = ',', decimal_mark = '.';
  std::vector<bool> is_wanted = {};            // of each column; found: it holds some numbers
  std::size_t text_column = 0;                 // mostly holds numbers: text is seen there
  std::size_t data_line = 0;                   // physical line of the first data row
  std::string names_row = {}, units_row = {};  // as they stand in the file: blocks repeat them
};

/// Fills a table from a file, plain or compressed by gzip, piece by piece: 0.1 s for 10⁶ cells, in
/// 8 bytes a number.
class TableReader {
 public:
  /// Finds the layout.
  /// @param encoding  as LinePieces takes it
  /// @throws InputError when the file cannot be read, no row of numbers is found, or the row above
  ///   the data is no header
  explicit TableReader(const std::filesystem::path& path, const std::string& encoding = {});

  /// Appends the rows of the next mebibyte or so, of columns that hold numbers in the first.
  /// @returns false at the end of the file
  bool Read();
  /// Forgets the rows read so far, and reads no other columns than these, from 0, any more.
  void KeepColumns(const std::vector<std::size_t>& wanted);

  [[nodiscard]] CsvTable& table() { return table_; }

 private:
  void ReadRow(std::string_view row);
  double ReadText(std::size_t column, std::string_view text);
  bool IsText(std::string_view row);
  void EndText();
  void Break(const std::string& fault, std::size_t column);
  [[nodiscard]] std::string NoNumber(std::size_t column, std::string_view text) const;
  [[nodiscard]] std::string At(std::size_t column, std::string_view fault) const;

  LinePieces pieces_;
  std::string_view first_;  // what is to be read of the first piece
  Layout layout_;
  CsvTable table_;
  std::size_t line_ = 0;
  // The fault and the line of the first text since the last row of numbers, unless it is a header.
  std::string text_fault_;
  std::size_t text_line_ = 0;
};

/// Reads a whole file as a table.
/// @throws InputError as TableReader
CsvTable ReadCsvTable(const std::filesystem::path& path, const std::string& encoding = {});

}  // namespace mindahl::io
