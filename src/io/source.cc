#include "io/source.h"

#include <fmt/format.h>
#include <iconv.h>
#include <sha2.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <system_error>
#include <utility>

#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {
namespace {

constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";
constexpr std::string_view kUtf16Little = "\xFF\xFE";
constexpr std::string_view kUtf16Big = "\xFE\xFF";

unsigned char ByteAt(std::string_view text, std::size_t at) {
  return static_cast<unsigned char>(text[at]);
}

/// True for UTF-8, whose last character may be cut off.
bool IsUtf8(std::string_view text) {
  constexpr std::size_t kLongest = 4;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = Utf8LengthAt(text, at);
    if (length == 0) return text.size() - at < kLongest && ByteAt(text, at) >= 0xC2;
    at += length;
  }
  return true;
}

/// True for text of which two characters or more are common ones of Shift-JIS, kana and kanji.
bool IsShiftJis(std::string_view text) {
  std::size_t common = 0;
  for (std::size_t at = 0; at < text.size(); ++at) {
    const unsigned char lead = ByteAt(text, at);
    const bool is_common = lead >= 0x81 && lead <= 0x9F;
    if (lead < 0x80 || (lead >= 0xA1 && lead <= 0xDF)) continue;
    if (!is_common && (lead < 0xE0 || lead > 0xFC)) return false;
    if (++at == text.size()) break;
    const unsigned char trail = ByteAt(text, at);
    if (trail < 0x40 || trail == 0x7F || trail > 0xFC) return false;
    if (is_common) ++common;
  }
  return common >= 2;
}

/// True for text whose bytes beyond ASCII come in pairs alone, two pairs in a row at least once.
bool IsGb18030(std::string_view text) {
  std::size_t longest = 0;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t run = 0;
    while (at + run < text.size() && ByteAt(text, at + run) >= 0xA1) ++run;
    if (run % 2 != 0 && at + run < text.size()) return false;
    longest = std::max(longest, run);
    at += run;
    if (at < text.size() && ByteAt(text, at) >= 0x80) return false;
    ++at;
  }
  return longest >= 4;
}

[[noreturn]] void ThrowCannotRead(const std::string& name, const char* reason) {
  Refuse("cannot read '{}': {}", name, reason);
}

/// The reader of standard input, which nobody closes.
gzFile StandardInput() {
  static const gzFile input = gzdopen(0, "rb");
  if (input != nullptr) gzclearerr(input);
  return input;
}

}  // namespace

std::string NameOfInput(const std::filesystem::path& path) {
  return path == kStandardInput ? "standard input" : path.string();
}

std::string ForMessage(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::size_t size = std::min(text.size(), kLongest);
  // Never within a character, whose bytes after the first are 10xxxxxx.
  while (size < text.size() && (ByteAt(text, size) & 0xC0U) == 0x80U) ++size;
  std::string shown(text.substr(0, size));
  std::ranges::replace_if(
      shown, [](char byte) { return static_cast<unsigned char>(byte) < 0x20; }, ' ');
  return size < text.size() ? shown + "..." : shown;
}

std::size_t Utf8LengthAt(std::string_view text, std::size_t at) {
  const unsigned char lead = ByteAt(text, at);
  if (lead < 0x80) return 1;
  const std::size_t length = lead < 0xC2   ? 0
                             : lead < 0xE0 ? 2
                             : lead < 0xF0 ? 3
                             : lead < 0xF5 ? 4
                                           : 0;
  if (length == 0 || at + length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((ByteAt(text, at + i) & 0xC0U) != 0x80) return 0;
  }
  const unsigned char second = ByteAt(text, at + 1);
  const bool is_overlong = (lead == 0xE0 && second < 0xA0) || (lead == 0xF0 && second < 0x90);
  const bool is_beyond = (lead == 0xED && second > 0x9F) || (lead == 0xF4 && second > 0x8F);
  return is_overlong || is_beyond ? 0 : length;
}

std::string EncodingOf(std::string_view head) {
  if (head.starts_with(kUtf16Little)) return "UTF-16LE";
  if (head.starts_with(kUtf16Big)) return "UTF-16BE";
  std::array<std::ptrdiff_t, 2> zeroes{};  // in even and odd places
  for (std::size_t at = 0; at < head.size(); ++at) zeroes[at % 2] += head[at] == '\0' ? 1 : 0;
  if (const auto [even, odd] = zeroes; even + odd > 0) {
    if (even == 0 && 4 * odd >= std::ssize(head)) return "UTF-16LE";
    return odd == 0 && 4 * even >= std::ssize(head) ? "UTF-16BE" : "";
  }
  if (IsUtf8(head)) return "";
  return IsShiftJis(head) ? "CP932" : IsGb18030(head) ? "GB18030" : "WINDOWS-1252";
}

LinePieces::LinePieces(const std::filesystem::path& path, std::string encoding)
    : name_(NameOfInput(path)),
      encoding_(std::move(encoding)),
      file_(path == kStandardInput ? StandardInput() : gzopen(path.c_str(), "rb"),
            {.is_shared = path == kStandardInput}) {
  if (!file_) ThrowCannotRead(name_, std::strerror(errno));
  gzbuffer(file_.get(), 1U << 17U);
  ReadBytes(undecoded_);
  FindEncoding();
  if (decoder_ != nullptr) {
    Decode();
  } else {
    text_.swap(undecoded_);
  }
  if (text_.starts_with(kUtf8Mark)) text_.erase(0, kUtf8Mark.size());
  if (const std::size_t zero = text_.find('\0'); zero != std::string::npos) {
    ThrowZeroByte(fmt::format(":{}", 1 + std::count(text_.data(), text_.data() + zero, '\n')));
  }
  ends_lines_in_cr_ = text_.find('\n') == text_.npos && text_.find('\r') != text_.npos;
  if (ends_lines_in_cr_) std::ranges::replace(text_, '\r', '\n');
}

void LinePieces::CloseGzip::operator()(gzFile_s* file) const {
  if (!is_shared) gzclose(file);
}

void LinePieces::CloseDecoder::operator()(void* decoder) const { ::iconv_close(decoder); }

std::string_view LinePieces::Next() {
  text_.erase(0, given_);
  while (text_.rfind('\n') == std::string::npos && !at_end_) {
    if (text_.size() > kLongestLine) {
      Refuse("{}: has a line of more than {} bytes: lines must end in LF or CRLF", name_,
             kLongestLine);
    }
    const std::size_t before = text_.size();
    ReadBytes(decoder_ != nullptr ? undecoded_ : text_);
    if (decoder_ != nullptr) Decode();
    if (text_.find('\0', before) != std::string::npos) ThrowZeroByte("");
    if (ends_lines_in_cr_) std::ranges::replace(text_, '\r', '\n');
  }
  given_ = at_end_ ? text_.size() : text_.rfind('\n') + 1;
  return std::string_view(text_).substr(0, given_);
}

/// Appends the next bytes of the file to a text.
void LinePieces::ReadBytes(std::string& to) {
  const int count = gzread(file_.get(), piece_.get(), kPiece);
  int error = Z_OK;
  const char* const reason = gzerror(file_.get(), &error);
  if (count < 0 || (error != Z_OK && error != Z_STREAM_END)) {
    ThrowCannotRead(name_, error == Z_ERRNO ? std::strerror(errno) : reason);
  }
  to.append(piece_.get(), static_cast<std::size_t>(count));
  at_end_ = static_cast<std::size_t>(count) < kPiece;
  bytes_ += static_cast<std::uintmax_t>(count);
}

void LinePieces::ThrowZeroByte(const std::string& line) const {
  Refuse("{}{}: is not text, it holds a zero byte: export it as CSV", name_, line);
}

/// Opens the decoder, where the text is not in UTF-8, by the file's first bytes.
void LinePieces::FindEncoding() {
  const std::string_view head = std::string_view(undecoded_).substr(0, 1 << 16);
  if (head.empty()) Refuse("{}: the file is empty", name_);
  if (head.starts_with("PK\x03\x04") || head.starts_with("\xD0\xCF\x11\xE0")) {
    Refuse(
        "{}: is a workbook of a spreadsheet: save its sheet as CSV there, or read it by "
        "mindahl.read_excel() in Python",
        name_);
  }
  const bool is_found = encoding_.empty();
  if (is_found) encoding_ = EncodingOf(head);
  if (encoding_.empty()) return;
  const iconv_t decoder = ::iconv_open("UTF-8", encoding_.c_str());
  // iconv_open() answers with (iconv_t)-1.
  if (decoder == reinterpret_cast<iconv_t>(-1)) {  // NOLINT(performance-no-int-to-ptr)
    Refuse(
        "--encoding {}: {} cannot be read this way: {}: give a name of iconv --list, as latin1, "
        "sjis or utf-16",
        encoding_, name_, std::strerror(errno));
  }
  decoder_.reset(decoder);
  if (is_found && !encoding_.starts_with("UTF-16")) {
    note_ =
        fmt::format("{}: is not UTF-8 and was read as {}: --encoding sets another encoding", name_,
                    encoding_ == "CP932"          ? "Shift-JIS"
                    : encoding_ == "WINDOWS-1252" ? "Latin-1 (Windows-1252)"
                                                  : encoding_);
  }
}

/// Decodes all whole characters that were read.
void LinePieces::Decode() {
  char* from = undecoded_.data();
  std::size_t left = undecoded_.size();
  std::array<char, 1 << 14> decoded{};
  while (left > 0) {
    char* to = decoded.data();
    std::size_t room = decoded.size();
    const std::size_t result = ::iconv(decoder_.get(), &from, &left, &to, &room);
    text_.append(decoded.data(), decoded.size() - room);
    if (result != static_cast<std::size_t>(-1) || errno == E2BIG) continue;
    if (errno == EINVAL && !at_end_) break;  // a character that goes on in the next block
    Refuse("{}: byte {} is not valid in {}: give the encoding of the file with --encoding", name_,
           bytes_ - left + 1, encoding_);
  }
  undecoded_.erase(0, undecoded_.size() - left);
}

std::optional<std::string> Sha256OfFile(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  std::string digest(SHA256_DIGEST_STRING_LENGTH, '\0');
  if (SHA256File(path.c_str(), digest.data()) == nullptr) {
    ThrowCannotRead(path.string(), std::strerror(errno));
  }
  digest.pop_back();  // the zero byte at its end
  return digest;
}

}  // namespace mindahl::io
