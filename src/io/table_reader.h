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

/// Fills a table from the rows of a text that comes in pieces.
class TableReader {
 public:
  /// @param skipped  where it is given, rows that are at fault are left out and counted there
  /// @param wanted   columns to read, from 0: those of numbers where none is given; the others stay
  ///   empty
  TableReader(const Layout& layout, LeftOutRows* skipped,
              const std::vector<std::size_t>& wanted = {});

  /// Reads further rows, up to one that is at fault.
  /// @param text  of whole lines; the first piece without what is above the data
  void Read(std::string_view text);
  /// Notes that there are no further rows: text below the data is a fault.
  void Finish() {
    if (gap_ && !gap_->empty()) EndGap();
  }

  /// Returns the fault of the row at which reading ended; "" where there is none.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] CsvTable& table() { return table_; }
  /// Forgets the rows read so far.
  void Clear();

 private:
  void ReadRow(std::string_view row);
  bool ReadCells(std::string_view row);
  bool BelongsToHeader(std::string_view row);
  void EndGap();
  void RefuseRow(const std::string& fault);
  [[nodiscard]] std::string At(std::size_t column, std::string_view fault) const;
  double ValueOf(std::size_t column, std::string_view text);

  struct CellFault {
    std::size_t column;
    bool is_missing;
    std::string message;
  };

  Layout layout_;
  CsvTable table_;
  LeftOutRows* skipped_;
  std::vector<bool> is_wanted_;              // of each column
  std::vector<double> values_, last_clock_;  // of each column, in the row and in those above
  std::vector<CellFault> cell_faults_;       // of the row
  std::size_t line_;
  std::size_t row_line_ = 0;
  char mark_ = '\0';  // the decimal mark, once one was seen
  std::size_t mark_line_ = 0;
  /// Text since the last row of numbers: its fault, "" of a header that is repeated.
  std::optional<std::string> gap_;
  std::string fault_;
};

}  // namespace mindahl::io
