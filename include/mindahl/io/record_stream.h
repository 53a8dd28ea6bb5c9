#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mindahl/io/record_reader.h"
#include "mindahl/loop/record.h"

namespace mindahl::io {

/// Samples of a record [m, N, s, N], or [rad, N m, s, N], in the order of the file.
struct Samples : loop::Record {
  std::vector<std::size_t> lines{};  ///< lines in the file, 1-based
};

/// A record read piece by piece, in memory that does not depend on its length.
///
/// Delimiter, decimal mark, header, columns and units are found as ReadRecord() finds them, from
/// the header, in the first mebibyte, and the first 128 kibibytes of rows; every row is then read
/// by the same rules, but that a quoted cell ends with its line. Lines end in LF or CRLF.
/// Covariates are not read.
class RecordStream {
 public:
  /// @throws InputError as ReadRecord() does of a file that ends with these rows
  explicit RecordStream(const std::filesystem::path& path, const RecordColumns& columns = {});
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

  /// Returns the rows left out so far: those that are skipped, and those whose cell in a column
  /// that is used is empty or holds no number.
  [[nodiscard]] LeftOutRows left_out() const;

  /// Returns the number of bytes read so far.
  [[nodiscard]] std::uintmax_t bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace mindahl::io
