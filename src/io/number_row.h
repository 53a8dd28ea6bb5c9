#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/clock.h"
#include "io/csv_tokenizer.h"

namespace mindahl::io {

/// Reads the numbers of some columns from lines of text, a row a line: what ParseCsvTable() reads
/// there, but that a quoted cell cannot go on in the next line. A plain line, of numbers without
/// quotation marks, is read without a cell being copied; any other is cut up by the tokenizer.
class NumberRowReader {
 public:
  /// @param columns  of the table; a row may lack those behind the last one that is wanted
  /// @param wanted   from 0, each once
  /// @param clock    of these, the one that holds times of day, as ClockReader reads them
  NumberRowReader(Delimiter delimiter, std::size_t columns, std::vector<std::size_t> wanted,
                  std::optional<std::size_t> clock = std::nullopt);

  enum class Row {
    kNumbers,
    kNone,    ///< blank, of delimiters alone, or a comment
    kBroken,  ///< see fault()
  };

  /// @param line    without its end
  /// @param number  of the line in its file, for messages
  /// @param values  written, in the order of `wanted`; of a row of numbers only
  Row Read(std::string_view line, std::size_t number, std::span<double> values);

  /// True if the last broken row begins with a text.
  [[nodiscard]] bool may_be_footer() const { return may_be_footer_; }
  /// Describes the fault of the last broken row, and its cell, from 0.
  [[nodiscard]] const std::string& fault() const { return fault_; }
  [[nodiscard]] std::size_t fault_column() const { return fault_column_; }

 private:
  bool ReadPlain(std::string_view line, std::size_t number, std::span<double> values);
  Row ReadAny(std::string_view line, std::size_t number, std::span<double> values);
  Row Break(std::size_t column, std::string fault);

  Delimiter delimiter_;
  std::vector<std::size_t> wanted_;
  std::optional<std::size_t> clock_;
  ClockReader times_;
  bool may_be_footer_ = false;
  std::size_t last_wanted_ = 0;
  std::vector<int> slots_;  // of each column, in the values; -1 where it is not wanted
  char mark_ = '\0';        // the decimal mark, once one was seen
  std::size_t mark_line_ = 0;
  CsvRow row_;
  std::string fault_;
  std::size_t fault_column_ = 0;
};

}  // namespace mindahl::io
