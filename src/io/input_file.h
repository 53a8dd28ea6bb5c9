#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace mindahl::io {

/// Bytes of the longest line that is read as a row of a record.
inline constexpr std::size_t kLongestLine = 16U << 20U;

/// Returns what messages call the file.
std::string NameOfInput(const std::filesystem::path& path);

/// @throws InputError "cannot read '<name>': <reason>", by errno
[[noreturn]] void ThrowCannotRead(const std::string& name);

[[noreturn]] void ThrowLongLine(const std::string& name);

/// Closes what was opened; standard input stays open.
struct CloseInput {
  void operator()(std::FILE* file) const;
};
using InputFile = std::unique_ptr<std::FILE, CloseInput>;

/// @throws InputError where the file cannot be opened
InputFile OpenInput(const std::filesystem::path& path);

/// Returns the encoding of a text by its first bytes, as iconv calls it; "" for UTF-8 and ASCII.
/// UTF-16 is known by its byte order mark or by zero bytes in every other place; of what is not
/// UTF-8, Shift-JIS by two characters or more that begin with 0x81 to 0x9F; the rest is
/// Windows-1252, of which Latin-1 is a part.
std::string EncodingOf(std::string_view head);

/// Reads a file as UTF-8. What is UTF-8 already is passed on as it is.
class TextInput {
 public:
  /// @param encoding  a name of iconv; "" for EncodingOf() the first bytes
  /// @throws InputError where the file cannot be opened, and for a name that iconv does not know
  TextInput(const std::filesystem::path& path, std::string encoding);
  ~TextInput();
  TextInput(const TextInput&) = delete;
  TextInput& operator=(const TextInput&) = delete;

  /// Returns the number of bytes read; fewer than `size` at the end only.
  /// @throws InputError where the file cannot be read or is not in its encoding
  std::size_t Read(char* to, std::size_t size);

  /// Returns the number of bytes of the file that were read.
  [[nodiscard]] std::uintmax_t bytes() const { return bytes_; }
  /// Returns what was assumed of the encoding, a sentence; "" where nothing was.
  [[nodiscard]] const std::string& note() const { return note_; }

 private:
  std::size_t ReadRaw(char* to, std::size_t size);
  void Open();
  void Decode();

  std::string name_;
  InputFile file_;
  std::string encoding_;
  bool is_decided_ = false;
  void* decoder_ = nullptr;  // iconv_t
  std::string raw_;          // bytes that are not decoded yet
  std::string text_;         // decoded bytes that were not returned yet
  bool at_end_ = false;
  std::uintmax_t bytes_ = 0;
  std::string note_;
};

/// The text of a file in pieces of whole lines.
class LinePieces {
 public:
  static constexpr std::size_t kPiece = 1 << 20;  // bytes read at a time

  /// @throws InputError as TextInput()
  explicit LinePieces(const std::filesystem::path& path, const std::string& encoding = {});

  /// @returns whole lines, the last of the file perhaps without its end; empty at the end. Valid
  ///   until the next call
  /// @throws InputError where the file cannot be read or has a line of more than 16 pieces
  std::string_view Next();

  [[nodiscard]] bool at_end() const { return at_end_; }
  [[nodiscard]] std::uintmax_t bytes() const { return file_.bytes(); }
  [[nodiscard]] const std::string& note() const { return file_.note(); }

 private:
  [[nodiscard]] std::string_view Text() const { return {buffer_.data(), size_}; }

  std::string name_;
  TextInput file_;
  std::vector<char> buffer_ = std::vector<char>(kPiece);
  std::size_t size_ = 0;   // bytes of it that were read
  std::size_t given_ = 0;  // bytes of these that were returned
  bool at_end_ = false;
};

/// Returns SHA-256 (FIPS 180-4) of a file's bytes as 64 hexadecimal digits, as sha256sum prints it:
/// two files with one digest are one record. Empty for what is no regular file, which cannot be
/// read twice.
/// @throws InputError "cannot read '<path>': <reason>", also where libcrypto gives no digest
std::optional<std::string> Sha256OfFile(const std::filesystem::path& path);

}  // namespace mindahl::io
