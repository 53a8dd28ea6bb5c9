#pragma once

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <charconv>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace mindahl::cli {

/// Ends a command's help with lines to copy, before what ends every help. tests/cli/help_text.py
/// runs each, and makes the records that they name. A line that continues the last one begins with
/// blanks.
void AddExamples(CLI::App& command, const CLI::App& app,
                 std::initializer_list<std::string_view> lines);

/// Adds options to one group of a command's help.
class OptionGroup {
 public:
  OptionGroup(CLI::App& command, std::string name) : command_(command), name_(std::move(name)) {}

  [[nodiscard]] const std::string& name() const { return name_; }

  /// @param type  stands for the value in the help: "PATH"; empty for CLI11's own word
  template <typename Value>
  CLI::Option* Add(const std::string& option, Value& value, const std::string& help,
                   const std::string& type = "") const {
    CLI::Option* added = command_.add_option(option, value, help)->group(name_);
    return type.empty() ? added : added->type_name(type);
  }
  /// Adds an option whose default the help shows.
  template <typename Value>
  CLI::Option* AddShown(const std::string& option, Value& value, const std::string& help,
                        const std::string& type = "") const {
    return Add(option, value, help, type)->capture_default_str();
  }
  template <typename Value>
  CLI::Option* AddFlag(const std::string& option, Value& value, const std::string& help) const {
    return command_.add_flag(option, value, help)->group(name_);
  }

 private:
  CLI::App& command_;
  std::string name_;
};

/// A text without blanks and ends of lines around it.
inline std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Check for options that count: CLI11 itself reads -1 as 2⁶⁴ − 1.
inline CLI::Validator WholeNumber(std::uint64_t least, std::uint64_t most) {
  const auto check = [least, most](const std::string& text) -> std::string {
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    const bool whole = error == std::errc() && end == text.data() + text.size();
    if (whole && number >= least && number <= most) return {};
    return fmt::format("'{}' is invalid: must be a whole number from {} to {}", text, least, most);
  };
  return CLI::Validator(check, "");
}

/// Check for options that take one of several words: help lists them, and a word that is none is
/// refused with the nearest.
CLI::Validator OneOf(std::vector<std::string> words);

/// Reads "0.01" or "1%".
/// @throws InputError naming --tolerance, the text and the rule
double ParseTolerance(const std::string& text);

}  // namespace mindahl::cli
