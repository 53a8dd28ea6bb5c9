#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "io/input_file.h"

namespace mindahl::io {

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
