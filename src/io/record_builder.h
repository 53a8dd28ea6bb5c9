#pragma once

#include <cstddef>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "io/roles.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"
#include "mindahl/io/record_stream.h"

namespace mindahl::io {

/// Turns the rows of tables into samples of a record.
class RecordBuilder {
 public:
  /// Assigns the columns, by the rows that the table has.
  /// @throws InputError as ReadRecord()
  RecordBuilder(const CsvTable& table, const RecordColumns& columns);

  /// Returns the columns, units and notes, without samples.
  [[nodiscard]] RecordFile& file() { return file_; }
  /// Returns the columns that are used, from 0, each once.
  [[nodiscard]] const std::vector<std::size_t>& wanted() const { return wanted_; }

  /// Appends the rows of a table, up to one that is refused; those without a number in a column
  /// that is used are left out.
  /// @returns the fault of that row; "" where there is none
  std::string Add(const CsvTable& table, Samples& samples);
  /// Returns the rows left out so far.
  [[nodiscard]] const LeftOutRows& left_out() const { return left_out_; }
  /// Returns what is said of rows left out that are more than one in a hundred; "" where they are
  /// fewer, or broken rows are skipped.
  [[nodiscard]] std::string TooManyLeftOut() const;

 private:
  struct Channel {
    Role role;
    Expression sum;  // of columns
    Unit unit;
    std::string_view name;
    std::vector<double> values = {};  // of a table's rows

    [[nodiscard]] double ValueAt(const CsvTable& table, std::size_t row) const;
  };
  void Choose(const ColumnNames& names, Role role, Expression columns, const std::string& text,
              ChosenColumn& described);
  void ChooseTime(const ColumnNames& names, const Expression& columns, const std::string& text);
  bool Follows(Channel& time, std::size_t row);
  std::string FaultOf(const CsvTable& table, std::size_t row, bool& is_missing) const;

  std::string name_;
  RecordFile file_;
  std::vector<Channel> channels_;
  std::vector<std::size_t> wanted_;
  bool skip_broken_;
  LeftOutRows left_out_;
  std::size_t rows_ = 0;      // seen so far
  double interval_ = 0.0;     // [s] between rows, in place of a column of times
  double time_origin_ = 0.0;  // in the unit of the time
  double shift_ = 0.0;        // of the times of a block, in their unit
  bool begins_block_ = false;
  double last_time_ = -std::numeric_limits<double>::infinity();
  double time_above_ = 0.0;  // the one before the last
  double last_step_ = 0.0;
};

}  // namespace mindahl::io
