#pragma once

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

namespace mindahl {

/// Returns the text with the letters of ASCII in lower case.
inline std::string LowerCase(std::string_view text) {
  std::string lower(text);
  std::ranges::transform(lower, lower.begin(), [](unsigned char character) {
    return static_cast<char>(std::tolower(character));
  });
  return lower;
}

/// Returns the text without the blanks and tabs around it.
inline std::string_view Trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

/// Returns the number that a whole text is; empty where it is none, or beyond what the type holds.
template <typename Value>
std::optional<Value> NumberIn(std::string_view text) {
  Value value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && stop == end ? std::optional(value) : std::nullopt;
}

/// Returns the number of characters of a text in UTF-8: of bytes that do not go on with one.
inline std::size_t CharactersIn(std::string_view text) {
  return static_cast<std::size_t>(std::ranges::count_if(
      text, [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0) != 0x80; }));
}

/// Returns the parts of a text between separators, one more than there are of these.
inline std::vector<std::string_view> PartsOf(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// Returns words with blanks between them in lines of at most so many characters; a longer word has
/// a line of its own.
inline std::vector<std::string> LinesOf(const std::vector<std::string_view>& words,
                                        std::size_t width) {
  std::vector<std::string> lines;
  for (const std::string_view word : words) {
    if (!lines.empty() && CharactersIn(lines.back()) + 1 + CharactersIn(word) <= width) {
      lines.back().append(" ").append(word);
    } else {
      lines.emplace_back(word);
    }
  }
  return lines;
}

/// Returns the names of the rows of a table.
template <typename Rows, typename Member>
std::vector<std::string> NamesOf(const Rows& rows, Member name) {
  std::vector<std::string> names;
  for (const auto& row : rows) names.emplace_back(row.*name);
  return names;
}

}  // namespace mindahl
