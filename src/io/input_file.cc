#include "io/input_file.h"

#include <fmt/format.h>
#include <iconv.h>
#include <openssl/evp.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>
#include <vector>

#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {

namespace {

constexpr std::string_view kUtf16Little = "\xFF\xFE";
constexpr std::string_view kUtf16Big = "\xFE\xFF";

unsigned char ByteAt(std::string_view text, std::size_t at) {
  return static_cast<unsigned char>(text[at]);
}

/// True for UTF-8, whose last character may be cut off.
bool IsUtf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const unsigned char lead = ByteAt(text, at);
    const std::size_t more = lead < 0x80                   ? 0
                             : lead >= 0xC2 && lead < 0xE0 ? 1
                             : lead >= 0xE0 && lead < 0xF0 ? 2
                             : lead >= 0xF0 && lead < 0xF5 ? 3
                                                           : 4;
    if (more == 4) return false;
    for (std::size_t k = 1; k <= more && at + k < text.size(); ++k) {
      if ((ByteAt(text, at + k) & 0xC0U) != 0x80) return false;
    }
    at += 1 + more;
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

/// Returns the number of zero bytes in the even or the odd places.
std::ptrdiff_t ZeroesAt(std::size_t parity, std::string_view text) {
  std::ptrdiff_t count = 0;
  for (std::size_t at = parity; at < text.size(); at += 2) count += text[at] == '\0' ? 1 : 0;
  return count;
}

}  // namespace

std::string EncodingOf(std::string_view head) {
  if (head.starts_with(kUtf16Little)) return "UTF-16LE";
  if (head.starts_with(kUtf16Big)) return "UTF-16BE";
  if (head.find('\0') != std::string_view::npos) {
    const std::ptrdiff_t even = ZeroesAt(0, head);
    const std::ptrdiff_t odd = ZeroesAt(1, head);
    if (even == 0 && 4 * odd >= std::ssize(head)) return "UTF-16LE";
    if (odd == 0 && 4 * even >= std::ssize(head)) return "UTF-16BE";
    return "";
  }
  if (IsUtf8(head)) return "";
  return IsShiftJis(head) ? "CP932" : "WINDOWS-1252";
}

TextInput::TextInput(const std::filesystem::path& path, std::string encoding)
    : name_(NameOfInput(path)), file_(OpenInput(path)), encoding_(std::move(encoding)) {
  if (!encoding_.empty()) Open();
}

TextInput::~TextInput() {
  if (decoder_ != nullptr) ::iconv_close(decoder_);
}

void TextInput::Open() {
  is_decided_ = true;
  if (encoding_.empty()) return;
  const iconv_t decoder = ::iconv_open("UTF-8", encoding_.c_str());
  // iconv_open() answers with (iconv_t)-1.
  if (decoder == reinterpret_cast<iconv_t>(-1)) {  // NOLINT(performance-no-int-to-ptr)
    throw InputError(
        fmt::format("--encoding {}: {} cannot be read this way: {}: give a name of iconv --list, "
                    "as latin1, sjis or utf-16",
                    encoding_, name_, std::strerror(errno)));
  }
  decoder_ = decoder;
}

std::size_t TextInput::ReadRaw(char* to, std::size_t size) {
  const std::size_t count = std::fread(to, 1, size, file_.get());
  if (std::ferror(file_.get()) != 0) ThrowCannotRead(name_);
  bytes_ += count;
  return count;
}

std::size_t TextInput::Read(char* to, std::size_t size) {
  if (!is_decided_) {
    constexpr std::size_t kHead = 1 << 16;
    const std::size_t count = ReadRaw(to, size);
    encoding_ = EncodingOf({to, std::min(count, kHead)});
    Open();
    if (decoder_ == nullptr) return count;
    if (!encoding_.starts_with("UTF-16")) {
      note_ = fmt::format("{}: is not UTF-8 and was read as {}: --encoding sets another encoding",
                          name_, encoding_ == "CP932" ? "Shift-JIS" : "Latin-1 (Windows-1252)");
    }
    raw_.assign(to, count);
    at_end_ = count < size;
  } else if (decoder_ == nullptr) {
    return ReadRaw(to, size);
  }
  while (text_.size() < size && (!at_end_ || !raw_.empty())) {
    if (!at_end_) {
      constexpr std::size_t kBlock = 1 << 16;
      const std::size_t before = raw_.size();
      raw_.resize(before + kBlock);
      const std::size_t count = ReadRaw(raw_.data() + before, kBlock);
      raw_.resize(before + count);
      at_end_ = count < kBlock;
    }
    Decode();
  }
  const std::size_t count = std::min(size, text_.size());
  std::copy_n(text_.data(), count, to);
  text_.erase(0, count);
  return count;
}

/// Decodes all whole characters that were read.
void TextInput::Decode() {
  char* from = raw_.data();
  std::size_t left = raw_.size();
  while (left > 0) {
    std::array<char, 1 << 14> decoded{};
    char* to = decoded.data();
    std::size_t room = decoded.size();
    const std::size_t result = ::iconv(decoder_, &from, &left, &to, &room);
    text_.append(decoded.data(), decoded.size() - room);
    if (result != static_cast<std::size_t>(-1) || errno == E2BIG) continue;
    if (errno == EINVAL && !at_end_) break;  // a character that goes on in the next block
    throw InputError(
        fmt::format("{}: byte {} is not valid in {}: give the encoding of the file with --encoding",
                    name_, bytes_ - left + 1, encoding_));
  }
  raw_.erase(0, raw_.size() - left);
}

std::string NameOfInput(const std::filesystem::path& path) {
  return path == kStandardInput ? "standard input" : path.string();
}

void ThrowCannotRead(const std::string& name) {
  throw InputError(fmt::format("cannot read '{}': {}", name, std::strerror(errno)));
}

void ThrowLongLine(const std::string& name) {
  throw InputError(fmt::format("{}: has a line of more than {} bytes: lines must end in LF or CRLF",
                               name, kLongestLine));
}

void CloseInput::operator()(std::FILE* file) const {
  if (file != stdin) std::fclose(file);
}

InputFile OpenInput(const std::filesystem::path& path) {
  InputFile file(path == kStandardInput ? stdin : std::fopen(path.c_str(), "rb"));
  if (!file) ThrowCannotRead(NameOfInput(path));
  return file;
}

LinePieces::LinePieces(const std::filesystem::path& path, const std::string& encoding)
    : name_(NameOfInput(path)), file_(path, encoding) {}

std::string_view LinePieces::Next() {
  size_ -= given_;
  std::memmove(buffer_.data(), buffer_.data() + given_, size_);
  given_ = 0;
  std::size_t end = std::string::npos;  // of the last line's end
  while (end == std::string::npos && !at_end_) {
    if (size_ > kLongestLine) ThrowLongLine(name_);
    if (buffer_.size() < size_ + kPiece) buffer_.resize(size_ + kPiece);
    const std::size_t size = file_.Read(buffer_.data() + size_, kPiece);
    size_ += size;
    at_end_ = size < kPiece;
    end = Text().rfind('\n');
  }
  given_ = at_end_ ? size_ : end + 1;
  return Text().substr(0, given_);
}

std::optional<std::string> Sha256OfFile(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) return std::nullopt;
  const InputFile file = OpenInput(path);
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(),
                                                                        &EVP_MD_CTX_free);
  bool works = context && EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) == 1;
  constexpr std::size_t kPiece = 1 << 16;
  std::vector<char> piece(kPiece);
  for (std::size_t count = kPiece; works && count == kPiece;) {
    count = std::fread(piece.data(), 1, kPiece, file.get());
    works = EVP_DigestUpdate(context.get(), piece.data(), count) == 1;
  }
  if (std::ferror(file.get()) != 0) ThrowCannotRead(path.string());
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int size = 0;
  works = works && EVP_DigestFinal_ex(context.get(), digest.data(), &size) == 1;
  if (!works) {
    throw InputError(
        fmt::format("cannot read '{}': libcrypto cannot compute its SHA-256, for lack of memory or "
                    "by configuration",
                    path.string()));
  }
  std::string text;
  for (unsigned int i = 0; i < size; ++i) text += fmt::format("{:02x}", digest[i]);
  return text;
}

}  // namespace mindahl::io
