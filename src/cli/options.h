#pragma once

#include <cstdint>
#include <functional>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cli/app.h"

namespace mindahl::cli {

/// Adds a command to the program.
/// @param examples  lines to copy at the end of its help, before what ends every help.
///   tests/cli/help_text.py runs each, and makes the records that they name. A line that continues
///   the last one begins with blanks.
CLI::App& AddCommand(CLI::App& program, const std::string& name, const std::string& about,
                     std::initializer_list<std::string_view> examples);

/// Lets the help of a command show these options alone, and `--help-all` all of them.
/// @param names  with their dashes, in the order of the help
void ShowFirst(CLI::App& command, std::vector<std::string> names);

/// Sets what a command does once its options are read.
void WhenCalled(CLI::App& command, std::function<void()> run);

class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}

  /// Lists the words in the help; a word that is none of them is refused with the nearest.
  const Option& OneOf(std::vector<std::string> words) const;
  const Option& OneOf(std::span<const std::string_view> words) const;
  /// Refuses all but whole numbers: CLI11 itself reads -1 as 2⁶⁴ − 1.
  const Option& WholeNumber(std::uint64_t least, std::uint64_t most) const;
  const Option& Required() const;
  const Option& Needs(const Option& other) const;
  const Option& Excludes(const Option& other) const;
  /// Takes several values in one text: "0.5,1,2".
  const Option& SplitAtCommas() const;
  /// Takes one value each time that it is given; others take all words up to the next option.
  const Option& OneAtATime() const;
  /// Takes a quantity with its unit, "50 N", where a number is one in `unit`.
  const Option& InUnit(const std::string& unit) const;
  /// Takes a size in bytes with a unit: "4GB".
  const Option& WithUnitOfSize() const;

 private:
  CLI::Option* option_;
};

/// Adds options to one group of a command's help. A name without dashes stands for the words that
/// are no options.
class OptionGroup {
 public:
  OptionGroup(CLI::App& command, std::string name) : command_(command), name_(std::move(name)) {}

  /// @param value  of a type for which options.cc instantiates this
  /// @param type   stands for the value in the help: "PATH"; empty for CLI11's own word
  template <typename Value>
  Option Add(const std::string& option, Value& value, const std::string& help,
             const std::string& type = "") const;
  /// Adds an option whose default the help shows.
  template <typename Value>
  Option AddShown(const std::string& option, Value& value, const std::string& help,
                  const std::string& type = "") const;
  /// Adds an option whose text, or whose texts, a function reads.
  Option AddRead(const std::string& option, const std::function<void(const std::string&)>& read,
                 const std::string& help, const std::string& type) const;
  Option AddReadAll(const std::string& option,
                    const std::function<void(const std::vector<std::string>&)>& read,
                    const std::string& help, const std::string& type) const;
  Option AddFlag(const std::string& option, bool& value, const std::string& help) const;
  /// Adds a flag that may have a word of its own: "--strict{adequate}".
  Option AddFlagWithWord(const std::string& option, std::function<void(const std::string&)> read,
                         const std::string& help) const;
  /// Adds a flag at which a function is called.
  Option AddAction(const std::string& option, std::function<void()> act,
                   const std::string& help) const;

 private:
  Option Grouped(CLI::Option* added, const std::string& type) const;

  CLI::App& command_;
  std::string name_;
};

/// The group of options that belong to none.
inline constexpr const char* kPlainGroup = "Options";

Option FindOption(CLI::App& command, const std::string& option);

/// Holds what the command line, or a configuration, gives for an option.
struct OptionState {
  std::string name;  ///< without its dashes
  std::string group;
  std::string default_text;
  std::vector<std::string> values;
  bool is_given = false;
  bool is_flag = false;
};

/// Returns the options of a command in the order in which they were added, without words that are
/// no options.
std::vector<OptionState> OptionsOf(const CLI::App& command);

/// Returns a number, as it is read for every option; nothing where the text is none.
std::optional<double> NumberOf(std::string_view text);

/// A text without blanks and ends of lines around it.
inline std::string_view Trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t\r\n";
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// Reads "0.01" or "1%".
/// @throws InputError naming --tolerance, the text and the rule
double ParseTolerance(const std::string& text);

}  // namespace mindahl::cli
