#include "cli/toml.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/options.h"
#include "mindahl/core/error.h"

namespace mindahl::cli {
namespace {

constexpr std::string_view kBlanks = " \t\r";

class TomlReader {
 public:
  TomlReader(std::string_view text, std::string_view file) : text_(text), file_(file) {
    constexpr std::string_view kUtf8Mark = "\xEF\xBB\xBF";
    if (text_.starts_with(kUtf8Mark)) at_ = kUtf8Mark.size();
  }

  std::vector<TomlItem> Read() {
    std::vector<TomlItem> items;
    std::string section;
    while (SkipToContent()) {
      if (Peek() == '[') {
        section = ReadSection();
      } else {
        TomlItem& item = items.emplace_back();
        item.section = section;
        item.line = line_;
        item.key = ReadKey();
        item.values = Peek() == '[' ? ReadArray() : std::vector{ReadValue("#")};
      }
      RequireEndOfLine();
    }
    return items;
  }

 private:
  [[nodiscard]] bool AtEnd() const { return at_ >= text_.size(); }
  [[nodiscard]] char Peek() const { return AtEnd() ? '\n' : text_[at_]; }

  [[noreturn]] void Fail(std::size_t line, std::string_view what) const {
    throw InputError(fmt::format("{}:{}: {}", file_, line, what));
  }

  void SkipBlanks() { at_ = std::min(text_.find_first_not_of(kBlanks, at_), text_.size()); }

  /// Skips blanks, comments and ends of lines; false at the end of the text.
  bool SkipToContent() {
    for (SkipBlanks(); !AtEnd(); SkipBlanks()) {
      if (Peek() == '#') at_ = std::min(text_.find('\n', at_), text_.size());
      if (AtEnd() || Peek() != '\n') break;
      ++at_;
      ++line_;
    }
    return !AtEnd();
  }

  void RequireEndOfLine() {
    SkipBlanks();
    if (AtEnd() || Peek() == '\n' || Peek() == '#') return;
    Fail(line_, fmt::format("unexpected '{}': begin a new line", RestOfLine()));
  }

  [[nodiscard]] std::string_view RestOfLine() const {
    const std::string_view rest = text_.substr(at_);
    return Trimmed(rest.substr(0, rest.find('\n')));
  }

  std::string ReadSection() {
    const std::string_view line = RestOfLine();
    const std::size_t end = line.find(']');
    if (end == std::string_view::npos) Fail(line_, fmt::format("'{}' lacks its ']'", line));
    at_ += end + 1;
    return std::string(Trimmed(line.substr(1, end - 1)));
  }

  std::string ReadKey() {
    const std::string_view line = RestOfLine();
    const std::size_t equals = line.find('=');
    std::string_view key = Trimmed(line.substr(0, equals));
    if (equals == std::string_view::npos || key.empty()) {
      Fail(line_, fmt::format("'{}' is no option with its value: write key = value", line));
    }
    const bool quoted =
        key.size() >= 2 && key.front() == key.back() && (key.front() == '"' || key.front() == '\'');
    if (quoted) key = key.substr(1, key.size() - 2);
    at_ += equals + 1;
    SkipBlanks();
    return std::string(key);
  }

  std::vector<std::string> ReadArray() {
    const std::size_t opened = line_;
    std::vector<std::string> values;
    ++at_;
    while (SkipToContent()) {
      if (Peek() == ']') {
        ++at_;
        return values;
      }
      if (Peek() == ',' || Peek() == '[') {
        Fail(line_, fmt::format("'{}' is no value of an array of strings or numbers", Peek()));
      }
      values.push_back(ReadValue("#,]"));
      if (!SkipToContent()) break;
      if (Peek() == ',') {
        ++at_;
      } else if (Peek() != ']') {
        Fail(line_, fmt::format("a comma is missing before '{}'", RestOfLine()));
      }
    }
    Fail(opened, "the array opened here is never closed: end it with ']'");
  }

  /// @param ends  what ends a value without quotation marks
  std::string ReadValue(std::string_view ends) {
    if (Peek() == '"' || Peek() == '\'') return ReadString();
    const std::string_view line = RestOfLine();
    const std::string_view value = line.substr(0, line.find_first_of(ends));
    if (Trimmed(value).empty()) Fail(line_, "a value is missing after '='");
    at_ += value.size();
    return std::string(Trimmed(value));
  }

  /// "with \\ escapes" or 'as it stands'.
  std::string ReadString() {
    const char mark = text_[at_++];
    std::string value;
    for (; !AtEnd() && Peek() != '\n'; ++at_) {
      if (Peek() == mark) {
        ++at_;
        return value;
      }
      if (mark == '"' && Peek() == '\\') {
        ++at_;
        if (Peek() != '"' && Peek() != '\\') {
          Fail(line_, fmt::format("'\\{}' is no escape: write \\\\ for a backslash, or put the "
                                  "string between ' and '",
                                  Peek()));
        }
      }
      value += Peek();
    }
    Fail(line_, fmt::format("a string is never closed: end it with {}", mark));
  }

  std::string_view text_;
  std::string_view file_;
  std::size_t at_ = 0;
  std::size_t line_ = 1;
};

}  // namespace

std::vector<TomlItem> ReadToml(std::string_view text, std::string_view file) {
  return TomlReader(text, file).Read();
}

}  // namespace mindahl::cli
