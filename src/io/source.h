#pragma once

#include <fmt/format.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "mindahl/core/error.h"

struct gzFile_s;  // NOLINT(readability-identifier-naming): zlib's

namespace mindahl::io {

/// Bytes of the longest line that is read as a row of a record.
inline constexpr std::size_t kLongestLine = 16U << 20U;

/// @throws InputError of a text always
template <typename... Parts>
[[noreturn]] void Refuse(fmt::format_string<Parts...> text, Parts&&... parts) {
  throw InputError(fmt::format(text, std::forward<Parts>(parts)...));
}

/// Returns what messages call the file.
std::string NameOfInput(const std::filesystem::path& path);

/// Returns a text from a file as a message shows it: on one line, cut off after 60 bytes or so.
std::string ForMessage(std::string_view text);

/// Returns the encoding of a text by its first bytes, as iconv calls it; "" for UTF-8 and ASCII.
/// UTF-16 is known by its byte order mark or by zero bytes in every other place; of what is not
/// UTF-8, Shift-JIS by two bytes or more from 0x81 to 0x9F, GB18030 by two characters of GB2312 in
/// a row, Windows-1251 by a word of Cyrillic letters; the rest is Windows-1252, of which Latin-1 is
/// a part.
std::string EncodingOf(std::string_view head);

/// An iconv_t, closed with it.
using Decoder = std::unique_ptr<void, void (*)(void*)>;

/// A file, plain or compressed by gzip, as UTF-8 in pieces of whole lines that end in LF.
class LinePieces {
 public:
  static constexpr std::size_t kPiece = 1 << 20;  // bytes read at a time

  /// Reads the first piece.
  /// @param encoding  a name of iconv; "" for EncodingOf() the first bytes
  /// @throws InputError as Next(), where the file cannot be opened or is a workbook of a
  ///   spreadsheet, and for a name that iconv does not know
  explicit LinePieces(const std::filesystem::path& path, std::string encoding = {});

  /// @returns whole lines, the last of the file perhaps without its end; empty at the end. Valid
  ///   until the next call
  /// @throws InputError where the file cannot be read, is not in its encoding, holds a zero byte,
  ///   or has a line of more than kLongestLine
  std::string_view Next();

  /// Returns the number of bytes that were read.
  [[nodiscard]] std::uintmax_t bytes() const { return bytes_; }
  /// Returns what was assumed of the encoding, a sentence; "" where nothing was.
  [[nodiscard]] const std::string& note() const { return note_; }

 private:
  void ReadBytes(std::string& to);
  void FindEncoding();
  void TakeUndecoded();
  [[noreturn]] void ThrowZeroByte(const std::string& line) const;

  std::string name_;
  std::string encoding_;
  std::shared_ptr<gzFile_s> file_;
  Decoder decoder_{nullptr, nullptr};
  // gzread() fills it; of a short file the most of it is never touched.
  std::unique_ptr<char[]> piece_ = std::make_unique_for_overwrite<char[]>(kPiece);
  std::string undecoded_;  // bytes that were read
  std::string text_;
  std::size_t given_ = 0;  // bytes of it that were returned
  std::uintmax_t bytes_ = 0;
  bool ends_lines_in_cr_ = false;
  bool at_end_ = false;
  std::string note_;
};

/// Returns SHA-256 (FIPS 180-4) of a file's bytes as 64 hexadecimal digits, as sha256sum prints it:
/// two files with one digest are one record. Empty for what is no regular file, which cannot be
/// read twice.
/// @throws InputError "cannot read '<path>': <reason>"
std::optional<std::string> Sha256OfFile(const std::filesystem::path& path);

}  // namespace mindahl::io
