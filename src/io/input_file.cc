#include "io/input_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {

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
