#include "report/style.h"

#include <algorithm>

#include "core/text.h"

namespace mindahl::report {

namespace {

/// True for a number, or what stands before one: what comes after it belongs to it.
bool IsNumber(std::string_view word) {
  if (word == "±" || word == "…" || word == ">" || word == "=") return true;
  return !word.empty() && word.find_first_not_of("0123456789.+-e") == std::string_view::npos &&
         word.find_first_of("0123456789") != std::string_view::npos;
}

}  // namespace

std::string Wrapped(std::string_view text, std::size_t indent) {
  if (text.empty()) return "";
  constexpr std::size_t kColumns = 100;
  std::string wrapped;
  std::size_t column = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    // A word takes the blanks before it along, and a number its error and its unit.
    const std::size_t letter = std::min(text.find_first_not_of(' ', begin), text.size());
    std::size_t end = std::min(text.find(' ', letter), text.size());
    const auto goes_on = [&](std::size_t last) {
      return IsNumber(text.substr(last, end - last)) || text.substr(end).starts_with(" = ");
    };
    for (std::size_t last = letter; end < text.size() && goes_on(last);) {
      last = end + 1;
      end = std::min(text.find(' ', last), text.size());
    }
    const std::string_view word = text.substr(begin, end - begin);
    if (column > indent && column + CharactersIn(word) > kColumns) {
      wrapped += '\n' + std::string(indent, ' ') + std::string(text.substr(letter, end - letter));
      column = indent + CharactersIn(text.substr(letter, end - letter));
    } else {
      wrapped += word;
      column += CharactersIn(word);
    }
    begin = end;
  }
  return wrapped + '\n';
}

}  // namespace mindahl::report
