#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::io {

/// Files that are read, and standard input under the name "-".

/// A line longer than that is no row of a record.
inline constexpr std::size_t kLongestLine = 16U << 20U;

/// Returns what messages call the file.
std::string NameOfInput(const std::filesystem::path& path);

/// @throws InputError "cannot read '<name>': <reason>", by errno
[[noreturn]] void ThrowCannotRead(const std::string& name);

/// @throws InputError for a line longer than kLongestLine
[[noreturn]] void ThrowLongLine(const std::string& name);

/// Closes what was opened; standard input stays open.
struct CloseInput {
  void operator()(std::FILE* file) const;
};
using InputFile = std::unique_ptr<std::FILE, CloseInput>;

/// @throws InputError where the file cannot be opened
InputFile OpenInput(const std::filesystem::path& path);

/// The text of a file in pieces of whole lines.
class LinePieces {
 public:
  static constexpr std::size_t kPiece = 1 << 20;  // bytes read at a time

  /// @throws InputError where the file cannot be opened
  explicit LinePieces(const std::filesystem::path& path);

  /// @returns whole lines, the last of the file perhaps without its end; empty at the end. Valid
  ///   until the next call
  /// @throws InputError where the file cannot be read or has a line of more than 16 pieces
  std::string_view Next();

  [[nodiscard]] bool at_end() const { return at_end_; }
  [[nodiscard]] std::uintmax_t bytes() const { return bytes_; }

 private:
  [[nodiscard]] std::string_view Text() const { return {buffer_.data(), size_}; }

  std::string name_;
  InputFile file_;
  std::vector<char> buffer_ = std::vector<char>(kPiece);
  std::size_t size_ = 0;   // bytes of it that were read
  std::size_t given_ = 0;  // bytes of these that were returned
  bool at_end_ = false;
  std::uintmax_t bytes_ = 0;
};

}  // namespace mindahl::io
