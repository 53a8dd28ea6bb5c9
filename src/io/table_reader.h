#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "io/layout.h"
#include "io/row_reader.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {

/// Fills a table from a text that comes in pieces.
class TableReader {
 public:
  /// @param text         the begin of the file, in which its layout is found
  /// @param skip_broken  rows that are at fault are left out
  TableReader(std::string_view text, const std::string& file, bool skip_broken);

  /// Reads further rows.
  /// @param text  of whole lines; the first piece without what is above the data
  /// @throws InputError at a row that is at fault
  void Read(std::string_view text);
  /// @throws InputError for text below the data
  CsvTable Finish();

  [[nodiscard]] const Layout& layout() const { return layout_; }
  [[nodiscard]] std::size_t rows() const { return table_.rows(); }

 private:
  Layout layout_;
  CsvTable table_;
  std::vector<std::size_t> wanted_;  // columns that hold numbers
  RowReader rows_;
  std::vector<double> values_;
  std::size_t line_;
  bool skip_broken_;
};

}  // namespace mindahl::io
