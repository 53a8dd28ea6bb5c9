#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/cells.h"
#include "io/layout.h"

namespace mindahl::io {

/// Reads the numbers of some columns from rows of text.
class RowReader {
 public:
  /// @param wanted  columns from 0, each once
  RowReader(const Layout& layout, std::string file, std::vector<std::size_t> wanted);

  enum class Row {
    kNumbers,
    kNone,   ///< blank, a comment, or text that may belong to the header of a further block
    kFault,  ///< see fault()
  };

  /// @param row     without its end
  /// @param number  of its line in the file, for messages
  /// @param values  written, in the order of `wanted`; NaN where the cell holds no number
  Row Read(std::string_view row, std::size_t number, std::span<double> values);

  /// A cell without a number, or a whole row.
  struct Fault {
    std::size_t place = 0;  // of the column in `wanted`
    std::size_t line = 0;
    bool is_missing = false;   ///< empty, or a mark of a missing number
    std::string message = {};  ///< "file:line:column: …"
  };
  /// Returns the faults of the last row's cells.
  [[nodiscard]] const std::vector<Fault>& cell_faults() const { return cell_faults_; }
  /// Returns the fault of a whole row, of the last one or of the text above it; then there is none.
  std::string TakeFault();
  /// True if the last row is the first below a repeated header.
  [[nodiscard]] bool begins_block() const { return begins_block_; }
  /// True if a column's last number was a time of day.
  [[nodiscard]] bool is_clock(std::size_t place) const { return is_clock_[place]; }

 private:
  bool ReadPlain(std::string_view row, std::size_t number, std::span<double> values);
  Row ReadAny(std::string_view row, std::size_t number, std::span<double> values);
  Row EndGap(Row row);
  std::string At(std::size_t line, std::size_t column, std::string_view fault) const;

  Layout layout_;
  std::string file_;
  std::vector<std::size_t> wanted_;
  std::size_t last_wanted_ = 0;
  std::vector<int> places_;  // of each column, in the values; -1 where it is not wanted
  std::vector<bool> is_clock_;
  std::vector<double> last_clock_;
  char mark_ = '\0';  // the decimal mark, once one was seen
  std::size_t mark_line_ = 0;
  Cells cells_;
  std::vector<Fault> cell_faults_;
  std::string gap_fault_;  // of the first row of text since the last row of numbers
  bool has_repeated_header_ = false;
  bool begins_block_ = false;
  std::string fault_;
};

}  // namespace mindahl::io
