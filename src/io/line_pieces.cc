#include "io/line_pieces.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

/// A line longer than that is no row of a record.
constexpr std::size_t kLongestLine = 16 * LinePieces::kPiece;

}  // namespace

LinePieces::LinePieces(const std::filesystem::path& path)
    : name_(path.string()), file_(std::fopen(path.c_str(), "rb"), &std::fclose) {
  if (!file_) Fail();
}

std::string_view LinePieces::Next() {
  size_ -= given_;
  std::memmove(buffer_.data(), buffer_.data() + given_, size_);
  given_ = 0;
  std::size_t end = std::string::npos;  // of the last line's end
  while (end == std::string::npos && !at_end_) {
    if (size_ > kLongestLine) {
      throw InputError(
          fmt::format("{}: has a line of more than {} bytes: lines must end in LF or CRLF", name_,
                      kLongestLine));
    }
    if (buffer_.size() < size_ + kPiece) buffer_.resize(size_ + kPiece);
    const std::size_t size = std::fread(buffer_.data() + size_, 1, kPiece, file_.get());
    if (std::ferror(file_.get()) != 0) Fail();
    size_ += size;
    bytes_ += size;
    at_end_ = size < kPiece;
    end = Text().rfind('\n');
  }
  given_ = at_end_ ? size_ : end + 1;
  return Text().substr(0, given_);
}

void LinePieces::Fail() const {
  throw InputError(fmt::format("cannot read '{}': {}", name_, std::strerror(errno)));
}

}  // namespace mindahl::io
