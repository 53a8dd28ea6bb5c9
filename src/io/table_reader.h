#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/cells.h"
#include "io/layout.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {

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
  std::vector<bool> is_wanted_;              // of each column
  std::vector<double> values_, last_clock_;  // of each column, in the row and in those above
  std::vector<std::string> faults_;          // of each column whose value is not finite
  std::size_t line_;
  std::size_t row_line_ = 0;
  char mark_ = '\0';  // the decimal mark, once one was seen
  std::size_t mark_line_ = 0;
  std::optional<Gap> gap_;
};

}  // namespace mindahl::io
