#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "core/refuse.h"

struct gzFile_s;  // NOLINT(readability-identifier-naming): zlib's

namespace mindahl::io {

/// Returns a text from a file as a message shows it: on one line, cut off after 60 bytes or so.
std::string ForMessage(std::string_view text);

/// An iconv_t, closed with it.
using Decoder = std::unique_ptr<void, void (*)(void*)>;

/// A file, plain or compressed by gzip, as UTF-8 in pieces of whole lines that end in LF.
class LinePieces {
 public:
  /// Reads the first piece.
  /// @param encoding  a name of iconv; "" for EncodingOf() the first bytes
  /// @throws InputError as Next(), where the file cannot be opened or is a workbook of a
  ///   spreadsheet, and for a name that iconv does not know
  explicit LinePieces(const std::filesystem::path& path, std::string encoding = {});

  /// Returns whole lines, the last of the file perhaps without its end; "" at the end of the file.
  /// Valid until the next call.
  /// @throws InputError where the file cannot be read, is not in its encoding, holds a zero byte,
  ///   or has a line of more than 16 MiB
  std::string_view Next();

  /// Returns what messages call the file.
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Returns what was assumed of the encoding, a sentence; "" where nothing was.
  [[nodiscard]] const std::string& note() const { return note_; }

 private:
  void Read();
  void FindEncoding(std::string_view head);

  std::string name_;
  std::string encoding_;
  std::shared_ptr<gzFile_s> file_;
  Decoder decoder_{nullptr, nullptr};
  std::unique_ptr<char[]> piece_;  // gzread() fills it
  std::string undecoded_;          // bytes of a character that is not whole
  std::string text_;
  std::size_t given_ = 0;  // bytes of it that were returned
  std::uintmax_t bytes_ = 0;
  bool at_end_ = false;
  std::string note_;
};

}  // namespace mindahl::io
