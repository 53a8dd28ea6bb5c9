#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mindahl/io/record_reader.h"

namespace mindahl::io {

/// Samples of a record [m, N, s, N], or [rad, N m, s, N], in the order of the file.
struct Samples {
  std::vector<double> displacement{};
  std::vector<double> force{};
  std::vector<double> time{};         ///< empty where the file has none
  std::vector<double> normal_load{};  ///< likewise
  std::vector<std::size_t> lines{};   ///< lines in the file, 1-based

  [[nodiscard]] std::size_t size() const { return lines.size(); }
};

/// Says whether to refuse or to skip a row in which a needed cell is missing or no finite number,
/// that has a cell too many, or whose time is before that of the row above.
enum class BrokenRows { kRefuse, kSkip };

/// A record read piece by piece, in memory that does not depend on its length.
///
/// Delimiter, decimal mark, header, columns and units are found as ReadRecord() finds them, from
/// the header, in the first mebibyte, and the first 128 kibibytes of rows; every row is then read
/// by the same rules, but that a quoted cell ends with its line. Lines end in LF or CRLF.
/// Covariates are not read.
class RecordStream {
 public:
  /// @throws InputError as ReadRecord() does of a file that ends with these rows
  RecordStream(const std::filesystem::path& path, const RecordColumns& columns, BrokenRows broken);
  ~RecordStream();
  RecordStream(const RecordStream&) = delete;
  RecordStream& operator=(const RecordStream&) = delete;

  /// Returns the columns, units and notes; without samples.
  [[nodiscard]] const RecordFile& layout() const;

  /// Replaces the samples by the next, as many as a mebibyte holds, or as there are before a row
  /// that is refused.
  /// @returns false at the end of the file, when there are none
  /// @throws InputError naming file, line and column of such a row, and where the file cannot be
  ///   read
  bool Next(Samples& samples);

  /// Returns the number of rows skipped so far; below, the fault of the first as an error names it.
  [[nodiscard]] std::size_t broken_rows() const;
  [[nodiscard]] const std::string& first_broken_row() const;

  /// Returns the rows left out so far since a cell that is used is empty or holds no number.
  [[nodiscard]] const LeftOutRows& left_out() const;

  /// Returns the number of bytes read so far.
  [[nodiscard]] std::uintmax_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mindahl::io
