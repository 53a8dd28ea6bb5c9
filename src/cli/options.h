#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "cli/app.h"
#include "core/text.h"

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

/// Lists the words in the help; a word that is none of them is refused with the nearest.
CLI::Validator OneOf(std::vector<std::string> words);
CLI::Validator OneOf(std::span<const std::string_view> words);
/// Refuses all but whole numbers: CLI11 itself reads -1 as 2⁶⁴ − 1.
CLI::Validator WholeNumber(std::uint64_t least, std::uint64_t most);
/// Transforms a quantity with its unit, "50 N", to the number in `unit`.
CLI::Validator InUnit(const std::string& unit);

/// Adds options to one group of a command's help. A name without dashes stands for the words that
/// are no options.
class OptionGroup {
 public:
  OptionGroup(CLI::App& command, std::string name) : command_(command), name_(std::move(name)) {}

  /// @param type  stands for the value in the help: "PATH"; empty for CLI11's own word
  template <typename Value>
  CLI::Option* Add(const std::string& option, Value& value, const std::string& help,
                   const std::string& type = "") const {
    return Grouped(command_.add_option(option, value, help), type);
  }
  /// Adds an option that takes a quantity, a number in `unit` or one with its own: "50 N".
  template <typename Value>
  CLI::Option* AddQuantity(const std::string& option, Value& value, const std::string& help,
                           const std::string& type, const std::string& unit) const {
    return Add(option, value, help, type)->transform(InUnit(unit));
  }
  /// Adds an option whose default the help shows.
  template <typename Value>
  CLI::Option* AddShown(const std::string& option, Value& value, const std::string& help,
                        const std::string& type = "") const {
    return Add(option, value, help, type)->capture_default_str();
  }
  /// Adds an option whose words stand for values, the first for the one that it has.
  template <typename Value>
  CLI::Option* AddChoice(const std::string& option, Value& target,
                         std::vector<std::pair<std::string, Value>> choices,
                         const std::string& help) const {
    const auto text = std::make_shared<std::string>(choices.front().first);
    return AddShown(option, *text, help)
        ->check(OneOf(NamesOf(choices, &std::pair<std::string, Value>::first)))
        ->each([text, &target, choices](const std::string& word) {
          const auto named = [&](const auto& choice) { return choice.first == word; };
          target = std::ranges::find_if(choices, named)->second;
        });
  }
  /// Adds an option whose text, or whose texts, a function reads.
  template <typename Text = std::string>
  CLI::Option* AddRead(const std::string& option,
                       const std::type_identity_t<std::function<void(const Text&)>>& read,
                       const std::string& help, const std::string& type) const {
    return Grouped(command_.add_option_function<Text>(option, read, help), type);
  }
  CLI::Option* AddFlag(const std::string& option, bool& value, const std::string& help) const;
  /// Adds a flag that may have a word of its own: "--strict{adequate}".
  CLI::Option* AddFlagWithWord(const std::string& option,
                               std::function<void(const std::string&)> read,
                               const std::string& help) const;

 private:
  CLI::Option* Grouped(CLI::Option* added, const std::string& type) const;

  CLI::App& command_;
  std::string name_;
};

/// The group of options that belong to none.
inline constexpr const char* kPlainGroup = "Options";

/// Returns the options of a command in the order in which they were added, without words that are
/// no options.
std::vector<const CLI::Option*> OptionsOf(const CLI::App& command);
/// Returns the name of one of these, without its dashes.
inline const std::string& NameOf(const CLI::Option& option) { return option.get_lnames().front(); }

/// Reads a number > 0, "0.01", or the same in percent, "1%"; empty where the text is neither.
std::optional<double> ParseShare(std::string_view text);

/// Adds --tolerance, "0.01" or "1%", by default 1 %.
void AddTolerance(const OptionGroup& group, double& tolerance, const std::string& help);

/// Adds --path, a file with an imposed displacement, and --displacement, its column.
/// @param remark  goes on with the help of --path
/// @returns the former
CLI::Option* AddPath(const OptionGroup& group, std::string& path, std::string& column,
                     const std::string& remark);

/// Adds --threads.
void AddThreads(const OptionGroup& group, std::size_t& threads, const std::string& unchanged);

}  // namespace mindahl::cli
