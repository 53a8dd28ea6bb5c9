#pragma once

#include <algorithm>
#include <cstddef>
#include <string>
#include <string_view>

namespace mindahl::io {

/// Text from a file as a message shows it: on one line, and cut off after 60 bytes or so.
inline std::string ForMessage(std::string_view text) {
  constexpr std::size_t kLongest = 60;
  std::size_t size = std::min(text.size(), kLongest);
  // Never within a UTF-8 character, whose bytes after the first are 10xxxxxx.
  while (size < text.size() && (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U) ++size;
  std::string shown(text.substr(0, size));
  std::ranges::replace_if(
      shown, [](char byte) { return static_cast<unsigned char>(byte) < 0x20; }, ' ');
  return size < text.size() ? shown + "..." : shown;
}

}  // namespace mindahl::io
