#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/cells.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {

/// How a text is to be read as a table; csv_table.h states the rules by which it is found.
struct Layout {
  CsvTable header;  ///< the table without rows
  char delimiter = ',';
  // In some of the first rows, and in most, a column holds a number or what is meant as one.
  std::vector<bool> holds_numbers, mostly_numbers;
  std::size_t data_offset = 0;       ///< start of the first data row [bytes]
  std::size_t data_line = 0;         ///< its physical line
  std::string names_row, units_row;  // as they stand in the file: blocks of data repeat them

  [[nodiscard]] std::size_t columns() const { return header.columns.size(); }
};

/// Rows, the first of a file, in which the layout is looked for: at most so many are above the
/// data.
inline constexpr std::size_t kSampledRows = 1000;

/// @param text  the begin of a file, or all of it
/// @throws InputError when no row of numbers is found, or the row above the data is no header
Layout FindLayout(std::string_view text, const std::string& file);

/// Fills a table from the rows of a text that comes in pieces. A row that is at fault as a whole is
/// at fault in all its cells.
class TableReader {
 public:
  /// @param wanted  columns to read, from 0: those of numbers where none is given; the others stay
  ///   empty
  explicit TableReader(const Layout& layout, const std::vector<std::size_t>& wanted = {});

  /// Reads further rows.
  /// @param text  of whole lines; the first piece without what is above the data
  void Read(std::string_view text);
  /// Notes that there are no further rows: text below the data is a fault.
  void Finish() {
    if (gap_ && !gap_->fault.empty()) EndGap();
  }

  [[nodiscard]] CsvTable& table() { return table_; }
  /// Forgets the rows read so far.
  void Clear();

 private:
  void ReadRow(std::string_view row);
  void ReadCell(std::size_t column, std::string_view text);
  bool BelongsToHeader(std::string_view row);
  void EndGap();
  void AddFaulty(std::size_t line, const std::string& fault);
  [[nodiscard]] std::string At(std::size_t column, std::string_view fault) const;

  /// Text since the last row of numbers.
  struct Gap {
    std::size_t line;   // its first
    std::string fault;  // "" of a header that is repeated
  };

  Layout layout_;
  CsvTable table_;
  std::vector<bool> is_wanted_;      // of each column
  std::vector<double> values_;       // of each column, in the row
  std::vector<std::string> faults_;  // of each column whose value is not finite
  std::size_t line_;
  std::size_t row_line_ = 0;
  char mark_ = '\0';  // the decimal mark, once one was seen
  std::size_t mark_line_ = 0;
  std::optional<Gap> gap_;
};

}  // namespace mindahl::io
