#include "io/line_pieces.h"

#include <cstring>

namespace mindahl::io {

LinePieces::LinePieces(const std::filesystem::path& path)
    : name_(NameOfInput(path)), file_(OpenInput(path)) {}

std::string_view LinePieces::Next() {
  size_ -= given_;
  std::memmove(buffer_.data(), buffer_.data() + given_, size_);
  given_ = 0;
  std::size_t end = std::string::npos;  // of the last line's end
  while (end == std::string::npos && !at_end_) {
    if (size_ > kLongestLine) ThrowLongLine(name_);
    if (buffer_.size() < size_ + kPiece) buffer_.resize(size_ + kPiece);
    const std::size_t size = std::fread(buffer_.data() + size_, 1, kPiece, file_.get());
    if (std::ferror(file_.get()) != 0) ThrowCannotRead(name_);
    size_ += size;
    bytes_ += size;
    at_end_ = size < kPiece;
    end = Text().rfind('\n');
  }
  given_ = at_end_ ? size_ : end + 1;
  return Text().substr(0, given_);
}

}  // namespace mindahl::io
