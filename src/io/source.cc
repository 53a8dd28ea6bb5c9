#include "io/source.h"

#include <fmt/format.h>
#include <iconv.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

namespace mindahl::io {
namespace {

constexpr std::string_view kStandardInput = "-";
constexpr std::size_t kLongestLine = 16U << 20U;  // [bytes]
constexpr std::size_t kPiece = 1U << 20U;         // [bytes] read at a time

unsigned char ByteOf(char character) { return static_cast<unsigned char>(character); }

/// Opens a decoder to UTF-8; null where iconv does not know the encoding.
Decoder DecoderFrom(const std::string& encoding) {
  const iconv_t opened = ::iconv_open("UTF-8", encoding.c_str());
  // iconv_open() answers with (iconv_t)-1.
  const bool is_known =
      opened != reinterpret_cast<iconv_t>(-1);  // NOLINT(performance-no-int-to-ptr)
  return {is_known ? opened : nullptr, [](void* decoder) { ::iconv_close(decoder); }};
}

/// Moves the whole characters of a text, decoded, to another; false where the next is not valid.
bool Decode(const Decoder& decoder, std::string& text, std::string& to) {
  char* from = text.data();
  std::size_t left = text.size();
  std::array<char, 1 << 14> decoded{};
  int error = E2BIG;
  while (left > 0 && error == E2BIG) {
    char* end = decoded.data();
    std::size_t room = decoded.size();
    const bool is_done = ::iconv(decoder.get(), &from, &left, &end, &room) != std::size_t(-1);
    error = is_done ? 0 : errno;
    to.append(decoded.data(), end);
  }
  text.erase(0, text.size() - left);
  return left == 0 || error == EINVAL;
}

bool IsIn(std::string text, const std::string& encoding) {
  std::string decoded;
  return Decode(DecoderFrom(encoding), text, decoded);
}

/// Returns the encoding of a text by its first bytes, as iconv calls it; "" for UTF-8 and ASCII.
/// UTF-16 is known by its byte order mark; of what is not UTF-8, Shift-JIS by two bytes or more
/// from 0x81 to 0x9F; the rest is Windows-1252, of which Latin-1 is a part.
std::string EncodingOf(std::string_view head) {
  if (head.starts_with("\xFF\xFE") || head.starts_with("\xFE\xFF")) return "UTF-16";
  const std::string text(head);
  if (IsIn(text, "UTF-8")) return "";
  // European letters may look like a few characters of it by chance.
  const auto is_kanji = [](char of) { return ByteOf(of) >= 0x81 && ByteOf(of) <= 0x9F; };
  const bool is_japanese = std::ranges::count_if(head, is_kanji) >= 2 && IsIn(text, "CP932");
  return is_japanese ? "CP932" : "WINDOWS-1252";
}

std::shared_ptr<gzFile_s> OpenedForReading(const std::filesystem::path& path) {
  if (path != kStandardInput) return {gzopen(path.c_str(), "rb"), gzclose};
  // Nobody closes standard input.
  static const std::shared_ptr<gzFile_s> input(gzdopen(0, "rb"), [](gzFile_s*) {});
  if (input) gzclearerr(input.get());
  return input;
}

}  // namespace

std::string ForMessage(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::size_t size = std::min(text.size(), kLongest);
  // Never within a character, whose bytes after the first are 10xxxxxx.
  while (size < text.size() && (ByteOf(text[size]) & 0xC0U) == 0x80U) ++size;
  std::string shown(text.substr(0, size));
  std::ranges::replace_if(
      shown, [](char byte) { return ByteOf(byte) < 0x20; }, ' ');
  return size < text.size() ? shown + "..." : shown;
}

LinePieces::LinePieces(const std::filesystem::path& path, std::string encoding)
    : name_(path == kStandardInput ? "standard input" : path.string()),
      encoding_(std::move(encoding)),
      file_(OpenedForReading(path)) {
  if (!file_) Refuse("cannot read '{}': {}", name_, std::strerror(errno));
  gzbuffer(file_.get(), 1U << 17U);
  piece_ = std::make_unique_for_overwrite<char[]>(kPiece);  // of a short file most is not touched
  Read();
  if (text_.starts_with("\xEF\xBB\xBF")) text_.erase(0, 3);  // the byte-order mark of UTF-8
}

std::string_view LinePieces::Next() {
  text_.erase(0, given_);
  while (text_.rfind('\n') == std::string::npos && !at_end_) {
    if (text_.size() > kLongestLine) {
      Refuse("{}: has a line of more than {} bytes: lines must end in LF or CRLF", name_,
             kLongestLine);
    }
    Read();
  }
  given_ = at_end_ ? text_.size() : text_.rfind('\n') + 1;
  return std::string_view(text_).substr(0, given_);
}

/// Appends the next bytes of the file to the text, decoded.
void LinePieces::Read() {
  const int count = gzread(file_.get(), piece_.get(), kPiece);
  int error = Z_OK;
  const char* const reason = gzerror(file_.get(), &error);
  if (count < 0 || (error != Z_OK && error != Z_STREAM_END)) {
    Refuse("cannot read '{}': {}", name_, error == Z_ERRNO ? std::strerror(errno) : reason);
  }
  const std::string_view bytes(piece_.get(), static_cast<std::size_t>(count));
  const bool is_first = bytes_ == 0;
  const std::size_t before = text_.size();
  if (is_first) FindEncoding(bytes.substr(0, 1 << 16));
  at_end_ = bytes.size() < kPiece;
  bytes_ += bytes.size();
  if (!decoder_) {
    text_ += bytes;
  } else if (undecoded_ += bytes;
             !Decode(decoder_, undecoded_, text_) || (at_end_ && !undecoded_.empty())) {
    Refuse("{}: byte {} is not valid in {}: give the encoding of the file with --encoding", name_,
           bytes_ - undecoded_.size() + 1, encoding_);
  }
  if (const std::size_t zero = text_.find('\0', before); zero != std::string::npos) {
    const auto line = 1 + std::count(text_.data(), text_.data() + zero, '\n');
    Refuse("{}{}: is not text, it holds a zero byte: export it as CSV, or give --encoding", name_,
           is_first ? fmt::format(":{}", line) : "");
  }
}

/// Opens the decoder, where the text is not in UTF-8, by the file's first bytes.
void LinePieces::FindEncoding(std::string_view head) {
  if (head.empty()) Refuse("{}: the file is empty", name_);
  if (head.starts_with("PK\x03\x04") || head.starts_with("\xD0\xCF\x11\xE0")) {
    Refuse(
        "{}: is a workbook of a spreadsheet: save its sheet as CSV there, or read it "
        "in Python by pandas.read_excel(), whose frame mindahl.fit() takes",
        name_);
  }
  const bool is_found = encoding_.empty();
  if (is_found) encoding_ = EncodingOf(head);
  if (encoding_.empty()) return;
  decoder_ = DecoderFrom(encoding_);
  if (!decoder_) {
    Refuse(
        "--encoding {}: {} cannot be read this way: {}: give a name of iconv --list, as latin1, "
        "sjis or utf-16",
        encoding_, name_, std::strerror(errno));
  }
  if (is_found && encoding_ != "UTF-16") {
    note_ = fmt::format("{}: is not UTF-8 and was read as {}: --encoding sets another encoding",
                        name_, encoding_ == "CP932" ? "Shift-JIS" : "Latin-1 (Windows-1252)");
  }
}

}  // namespace mindahl::io
