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
  /// @param skip_broken  rows that are at fault are left out
  /// @param wanted       columns to read, from 0, each once: those of numbers where none is given;
  ///   the others stay empty
  TableReader(const Layout& layout, std::string file, bool skip_broken,
              std::vector<std::size_t> wanted = {});

  /// Reads further rows, up to one that is at fault.
  /// @param text  of whole lines; the first piece without what is above the data
  void Read(std::string_view text);
  /// Notes that there are no further rows: text below the data is a fault.
  void Finish() {
    if (gap_ && !gap_->empty()) EndGap();
  }

  /// Returns the fault of the row at which reading ended; "" where there is none.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] const LeftOutRows& skipped() const { return skipped_; }
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
  double ValueOf(std::size_t place, std::string_view text);

  Layout layout_;
  CsvTable table_;
  std::vector<std::size_t> wanted_;
  std::vector<int> places_;  // of each column, among the wanted; -1 where it is not
  std::vector<double> values_, last_clock_;
  struct CellFault {
    std::size_t place;
    bool is_missing;
    std::string message;
  };
  std::vector<CellFault> cell_faults_;  // of the row
  std::size_t line_;
  std::size_t row_line_ = 0;
  char mark_ = '\0';  // the decimal mark, once one was seen
  std::size_t mark_line_ = 0;
  /// Text since the last row of numbers: its fault, "" of a header that is repeated.
  std::optional<std::string> gap_;
  bool skip_broken_;
  LeftOutRows skipped_;
  std::string fault_;
};

}  // namespace mindahl::io
