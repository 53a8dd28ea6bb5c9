#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mindahl/io/csv_table.h"
#include "mindahl/loop/record.h"

namespace mindahl::io {

/// Selects the columns of a file, and how they are read. Each of displacement, force, time and
/// normal load is a text: "" for the column that is recognised; a header name or a number from 1,
/// "Fx" or "3"; with its unit, "3 [kN]", or that alone, "[kN]"; or a sum of columns with factors
/// and an offset, "raw*0.0123-4.5 [N]", "lvdt2-lvdt1". Without a unit the header's is taken,
/// and SI where that has none.
struct RecordColumns {
  std::string displacement{};
  std::string force{};
  std::string time{};
  std::string normal_load{};                 ///< "none": no column, whatever names say
  std::vector<std::string> covariates = {};  ///< header names or 1-based numbers
  std::string encoding = {};                 ///< name of iconv; "" for the one that is found
  std::optional<double> sample_rate = {};    // [Hz], of a file without a time
  /// Another file of the same test, whose columns follow those of the first, row by row; where both
  /// have a time, it is the same.
  std::string with = {};
  bool skip_broken_rows = false;  ///< rows that would be refused are left out
};

/// A column as it was read; false where there is none.
struct ChosenColumn {
  std::string name;          ///< header cell as written, or the sum; "" in a file without names
  std::size_t index = 0;     ///< 1-based; of a sum the first
  std::string unit;          ///< symbol the numbers were taken to be in
  bool has_no_unit = false;  ///< the file and the request name none: the unit is assumed

  explicit operator bool() const { return index > 0; }
};

/// Rows that were left out, as a column that is used has no number there; the fault of the first.
struct LeftOutRows {
  std::size_t count = 0;
  std::string fault = {};  ///< "file:line:column: …"

  /// "2 rows are left out, the first: loop.csv:3:1: …"
  [[nodiscard]] std::string InWords() const;
};

/// A record and where it came from.
struct RecordFile {
  std::string name{};  ///< in messages and reports: series.csv, of a piece series.csv:2-501
  loop::Record record;
  /// A torque [N m] against an angle [rad]: they are in the record's force and displacement.
  bool is_torsional = false;
  std::vector<std::size_t> lines;  ///< line in the file of each sample, 1-based
  ChosenColumn displacement, force, time, normal_load;
  std::vector<std::string> notes;  ///< assumptions of the reader, one sentence each
  LeftOutRows left_out = {};

  /// Returns the line of a sample; its number from 1 where the record does not know its lines.
  [[nodiscard]] std::size_t LineOf(std::size_t sample) const {
    return sample < lines.size() ? lines[sample] : sample + 1;
  }
};

/// Largest number of columns that a record keeps without being asked for.
inline constexpr std::size_t kMostOtherColumns = 8;

/// Reads a hysteresis record [m, N, s, N], or [rad, N m, s, N], from a delimited file, plain or
/// compressed by gzip; "-" is standard input, ./- a file of that name. docs/input.md describes it.
///
/// Columns that are not given are found by evidence: the words of the name, the unit, which counts
/// more, and whether the numbers go to and fro, which counts most; what none of these decides is
/// taken from the columns that are left, if they are as many, with a note.
///
/// Covariates are those chosen; then up to kMostOtherColumns of the others that hold a number in
/// every row, not the same in all, called by their name without its unit, or else by number.
///
/// @throws InputError naming the file and, where they exist, line and column: an unknown or
///   ambiguous column, an unknown unit, a cell that is not a finite number, a time before that of
///   the row above; a file beyond the limits
RecordFile ReadRecord(const std::filesystem::path& path, const RecordColumns& columns = {});

/// Reads columns in memory as ReadRecord() reads a file with their names, with units, in its first
/// line; lines are rows, counted from 1.
/// @param source  where they are from, for messages
/// @throws InputError as ReadRecord(), and where lengths differ or there is no column or row
RecordFile RecordOf(const std::vector<CsvColumn>& columns, std::string source,
                    const RecordColumns& asked = {});

/// Samples of a record [m, N, s, N], or [rad, N m, s, N], in the order of the file.
struct Samples : loop::Record {
  std::vector<std::size_t> lines{};  ///< lines in the file, 1-based
};

/// A record read piece by piece, in memory that does not depend on its length.
///
/// The layout is found, and columns are judged, by the first mebibyte; every row is then read by
/// the rules of ReadRecord(). Covariates are not read.
class RecordStream {
 public:
  /// @throws InputError as ReadRecord() does of a file that ends with these rows
  explicit RecordStream(const std::filesystem::path& path, const RecordColumns& columns = {});

  /// Returns the columns, units, notes and the rows left out so far; without samples.
  [[nodiscard]] const RecordFile& layout() const;

  /// Replaces the samples by the next, of a mebibyte or up to a row that is refused.
  /// @returns false at the end of the file, when there are none
  /// @throws InputError naming file, line and column of such a row, and where the file cannot be
  ///   read
  bool Next(Samples& samples);

 private:
  struct State;
  std::shared_ptr<State> state_;
};

/// Returns the displacements [m] or [rad] to impose, one a row, in order; numbers in SI
/// units are the doubles of the file.
/// @param column  by default the first, or, where that is another channel by its name, the one of a
///   recognised name; unit as for ReadRecord(), without one SI
/// @throws InputError as ReadRecord()
std::vector<double> ImposedDisplacement(const std::filesystem::path& path,
                                        const std::string& column = {});

/// Keeps the samples of a record whose time [s] lies from `first` to `last`, both included.
/// @throws InputError when the record has no time, or no sample lies there
void KeepTimeWindow(RecordFile& input, double first, double last);

/// Keeps the samples [first, last) of a record.
void KeepSamples(RecordFile& input, std::size_t first, std::size_t last);

}  // namespace mindahl::io
