#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "io/roles.h"
#include "mindahl/io/csv_table.h"
#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// Values of a row in SI: displacement, force, time and normal load, those that the record has.
using RowValues = std::array<double, 4>;

/// Turns rows of a table into samples of a record.
class RecordBuilder {
 public:
  /// Assigns the columns, by the rows that the table has.
  /// @throws InputError as ReadRecord()
  RecordBuilder(const CsvTable& table, const RecordColumns& columns);

  /// Returns the columns, units and notes, without samples.
  [[nodiscard]] RecordFile& file() { return file_; }
  /// Returns the columns that are used, from 0, each once.
  [[nodiscard]] const std::vector<std::size_t>& wanted() const { return wanted_; }

  /// @param cells         of the columns that are wanted, in their order
  /// @param line          of the row in the file
  /// @param row           from 0, counted with those that are left out
  /// @param begins_block  a header stands above it again: its clock may begin anew
  /// @param values        written
  /// @returns the fault of the row, "file:line:column: …"; "" where there is none
  std::string Convert(std::span<const double> cells, std::size_t line, std::size_t row,
                      bool begins_block, RowValues& values);

  /// Appends values to the columns that the record has.
  template <typename Columns>
  void Append(const RowValues& values, Columns& columns) const {
    columns.displacement.push_back(values[0]);
    columns.force.push_back(values[1]);
    if (has_time()) columns.time.push_back(values[2]);
    if (file_.normal_load) columns.normal_load.push_back(values[3]);
  }

 private:
  struct Channel {
    std::size_t place;  // in the values
    Expression sum;     // of the columns that are wanted, by their place among these
    Unit unit;
    std::string_view name;
  };
  void Add(const ColumnNames& names, Role role, Expression columns, const std::string& text,
           ChosenColumn& described);
  void AddTime(const ColumnNames& names, const Expression& columns, const std::string& text);
  [[nodiscard]] bool has_time() const { return file_.time.has_value() || interval_ > 0; }

  std::string name_;
  RecordFile file_;
  std::vector<Channel> channels_;
  std::vector<std::size_t> wanted_;
  double interval_ = 0.0;     // [s] between rows, in place of a column of times
  double time_origin_ = 0.0;  // in the unit of the time
  double shift_ = 0.0;        // of the times of a block, in their unit
  double last_time_;
  double last_step_ = 0.0;
};

/// Rows that are left out since a cell is empty or holds no number: few of them are no error.
struct MissingRows {
  LeftOutRows rows;
  std::string first;  ///< fault of the first

  void Count(std::size_t line, const std::string& fault);
  /// @throws InputError where they are more than 1 % of so many rows
  void RequireFew(std::size_t of_rows) const;
};

}  // namespace mindahl::io
