#include "core/text.h"

#include <algorithm>
#include <string>
#include <string_view>

#include "mindahl/report/report.h"
#include "report/answer.h"

namespace mindahl::report {

namespace {

constexpr std::size_t kColumns = 100;
constexpr std::size_t kLabel = 14;  // where texts begin

/// True for a number, or what stands before one: what comes after it belongs to it.
bool IsNumber(std::string_view word) {
  if (word == "±" || word == "…" || word == ">" || word == "<" || word == "=") return true;
  if (word.starts_with('(')) word.remove_prefix(1);
  return !word.empty() && word.find_first_not_of("0123456789.+-e") == std::string_view::npos &&
         word.find_first_of("0123456789") != std::string_view::npos;
}

/// Breaks a text between words; a number stays with what belongs to it.
std::string Wrapped(std::string_view text) {
  std::string wrapped;
  std::size_t column = kLabel;
  for (std::size_t begin = 0; begin < text.size();) {
    std::size_t last = begin;
    std::size_t end = std::min(text.find(' ', begin), text.size());
    while (end < text.size() &&
           (IsNumber(text.substr(last, end - last)) || text.substr(end + 1).starts_with("…") ||
            text.substr(end + 1).starts_with("("))) {
      last = end + 1;
      end = std::min(text.find(' ', last), text.size());
    }
    const std::string_view word = text.substr(begin, end - begin);
    const std::size_t width = CharactersIn(word);
    if (column > kLabel && column + 1 + width > kColumns) {
      wrapped += '\n' + std::string(kLabel, ' ');
      column = kLabel;
    } else if (column > kLabel) {
      wrapped += ' ';
      ++column;
    }
    wrapped += word;
    column += width;
    begin = std::min(end + 1, text.size());
  }
  return wrapped;
}

std::string LinesText(const std::vector<Line>& lines) {
  std::string text;
  for (const Line& line : lines) {
    const std::size_t width = CharactersIn(line.label);
    text += line.label + std::string(width < kLabel ? kLabel - width : 1, ' ') +
            Wrapped(line.text) + '\n';
  }
  return text;
}

}  // namespace

std::string ToText(const Report& report, Detail detail) {
  RequireFitted(report, "a text");
  std::string text = LinesText(AnswerLines(report));
  if (detail == Detail::kAll) text += '\n' + LinesText(DetailLines(report));
  return text;
}

}  // namespace mindahl::report
