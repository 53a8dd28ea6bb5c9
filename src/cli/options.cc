#include "cli/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/from_chars.h"
#include "core/nearest_name.h"
#include "mindahl/core/error.h"
#include "mindahl/core/units.h"

namespace mindahl::cli {

CLI::App& AddCommand(CLI::App& program, const std::string& name, const std::string& about,
                     std::initializer_list<std::string_view> examples) {
  CLI::App* command = program.add_subcommand(name, about);
  std::string text = "Examples:\n";
  for (const std::string_view line : examples) {
    text += "  ";
    text += line;
    text += '\n';
  }
  command->footer(text + '\n' + program.get_footer());
  command->set_help_all_flag("--help-all", "Print all options and exit");
  return *command;
}

namespace {

class EverydayFormatter : public CLI::Formatter {
 public:
  explicit EverydayFormatter(std::vector<std::string> names) : names_(std::move(names)) {}

  std::string make_help(const CLI::App* app, std::string name,
                        CLI::AppFormatMode mode) const override {
    if (mode == CLI::AppFormatMode::All) return Formatter::make_help(app, std::move(name), mode);
    std::vector<const CLI::Option*> shown;
    shown.reserve(names_.size());
    for (const std::string& each : names_) shown.push_back(app->get_option(each));
    const auto all = app->get_options([](const CLI::Option* option) {
      return !option->get_group().empty() && !option->get_lnames().empty();
    });
    const std::size_t hidden = all.size() - shown.size();
    return fmt::format("{}{}{}{}\n{} further options: mindahl {} --help-all\n\n{}",
                       make_description(app), make_usage(app, std::move(name)),
                       make_positionals(app),
                       make_group("Options", /*is_positional=*/false, std::move(shown)), hidden,
                       app->get_name(), make_footer(app));
  }

 private:
  std::vector<std::string> names_;
};

}  // namespace

void ShowFirst(CLI::App& command, std::vector<std::string> names) {
  command.formatter(std::make_shared<EverydayFormatter>(std::move(names)));
  command.get_formatter()->column_width(30);
}

void WhenCalled(CLI::App& command, std::function<void()> run) { command.callback(std::move(run)); }

const Option& Option::OneOf(std::vector<std::string> words) const {
  const std::string listed = fmt::format("{{{}}}", fmt::join(words, ","));
  const auto check = [words = std::move(words)](const std::string& text) {
    const bool is_one = std::ranges::find(words, text) != words.end();
    return is_one ? std::string() : UnknownAmong(text, words);
  };
  option_->check(CLI::Validator(check, listed));
  return *this;
}

const Option& Option::OneOf(std::span<const std::string_view> words) const {
  return OneOf(std::vector<std::string>(words.begin(), words.end()));
}

const Option& Option::WholeNumber(std::uint64_t least, std::uint64_t most) const {
  const auto check = [least, most](const std::string& text) -> std::string {
    const auto number = NumberIn<std::uint64_t>(text);
    if (number && *number >= least && *number <= most) return {};
    return fmt::format("'{}' is invalid: must be a whole number from {} to {}", text, least, most);
  };
  option_->check(CLI::Validator(check, ""));
  return *this;
}

const Option& Option::Required() const {
  option_->required();
  return *this;
}

const Option& Option::Needs(const Option& other) const {
  option_->needs(other.option_);
  return *this;
}

const Option& Option::Excludes(const Option& other) const {
  option_->excludes(other.option_);
  return *this;
}

const Option& Option::SplitAtCommas() const {
  option_->delimiter(',');
  return *this;
}

const Option& Option::OneAtATime() const {
  option_->allow_extra_args(false);
  return *this;
}

const Option& Option::InUnit(const std::string& unit) const {
  const auto convert = [unit](std::string& text) -> std::string {
    // A text without a unit is read, and refused, as a number.
    if (Trimmed(std::string_view(text).substr(BeginOfUnit(text))).empty()) return {};
    const std::optional<double> value = ParseQuantity(text, unit);
    if (!value)
      return fmt::format("'{}' is no quantity in {}: write a number or its unit", text, unit);
    text = fmt::format("{}", *value);
    return {};
  };
  option_->transform(CLI::Validator(convert, ""));
  return *this;
}

const Option& Option::WithUnitOfSize() const {
  option_->transform(CLI::AsSizeValue(/*kb_is_1000=*/true));
  return *this;
}

Option OptionGroup::Grouped(CLI::Option* added, const std::string& type) const {
  added->group(name_);
  if (!type.empty()) added->type_name(type);
  return Option(added);
}

template <typename Value>
Option OptionGroup::Add(const std::string& option, Value& value, const std::string& help,
                        const std::string& type) const {
  return Grouped(command_.add_option(option, value, help), type);
}

template <typename Value>
Option OptionGroup::AddShown(const std::string& option, Value& value, const std::string& help,
                             const std::string& type) const {
  return Grouped(command_.add_option(option, value, help)->capture_default_str(), type);
}

using Text = const std::string&;
template Option OptionGroup::Add(Text, std::uint64_t&, Text, Text) const;
template Option OptionGroup::Add(Text, double&, Text, Text) const;
template Option OptionGroup::Add(Text, std::string&, Text, Text) const;
template Option OptionGroup::Add(Text, std::optional<std::uint64_t>&, Text, Text) const;
template Option OptionGroup::Add(Text, std::optional<double>&, Text, Text) const;
template Option OptionGroup::Add(Text, std::vector<double>&, Text, Text) const;
template Option OptionGroup::Add(Text, std::vector<std::string>&, Text, Text) const;
template Option OptionGroup::AddShown(Text, std::uint64_t&, Text, Text) const;
template Option OptionGroup::AddShown(Text, double&, Text, Text) const;
template Option OptionGroup::AddShown(Text, std::string&, Text, Text) const;

Option OptionGroup::AddRead(const std::string& option,
                            const std::function<void(const std::string&)>& read,
                            const std::string& help, const std::string& type) const {
  return Grouped(command_.add_option_function<std::string>(option, read, help), type);
}

Option OptionGroup::AddReadAll(const std::string& option,
                               const std::function<void(const std::vector<std::string>&)>& read,
                               const std::string& help, const std::string& type) const {
  return Grouped(command_.add_option_function<std::vector<std::string>>(option, read, help), type);
}

namespace {

/// Checks what a flag is given: CLI11 itself reads --flag=5 as five times --flag.
CLI::Validator TrueOrFalse() {
  const auto check = [](const std::string& text) -> std::string {
    if (text == "true" || text == "false") return {};
    return fmt::format("'{}' is no value: a flag takes none, or true or false", text);
  };
  return {check, /*description=*/""};
}

}  // namespace

Option OptionGroup::AddFlag(const std::string& option, bool& value, const std::string& help) const {
  return Grouped(command_.add_flag(option, value, help)->check(TrueOrFalse()), "");
}

Option OptionGroup::AddFlagWithWord(const std::string& option,
                                    std::function<void(const std::string&)> read,
                                    const std::string& help) const {
  const auto text = std::make_shared<std::string>();
  return Grouped(
      command_.add_flag(option, *text, help)->each([text, read](const std::string& word) {
        read(word);
      }),
      "");
}

Option OptionGroup::AddAction(const std::string& option, std::function<void()> act,
                              const std::string& help) const {
  return Grouped(command_.add_flag_callback(option, std::move(act), help)->check(TrueOrFalse()),
                 "");
}

Option FindOption(CLI::App& command, const std::string& option) {
  return Option(command.get_option(option));
}

std::vector<OptionState> OptionsOf(const CLI::App& command) {
  std::vector<OptionState> options;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_lnames().empty()) continue;
    options.push_back({.name = option->get_lnames().front(),
                       .group = option->get_group(),
                       .default_text = option->get_default_str(),
                       .values = option->results(),
                       .is_given = option->count() > 0,
                       .is_flag = option->get_items_expected_max() == 0});
  }
  return options;
}

std::optional<double> NumberOf(std::string_view text) {
  double number = 0.0;
  if (!CLI::detail::lexical_cast(std::string(Trimmed(text)), number)) return std::nullopt;
  return number;
}

double ParseTolerance(const std::string& text) {
  const bool percent = text.ends_with('%');
  const std::optional<double> number =
      NumberIn<double>(std::string_view(text).substr(0, text.size() - (percent ? 1 : 0)));
  if (!number || !(*number > 0) || !std::isfinite(*number)) {
    throw InputError(
        fmt::format("--tolerance '{}' is invalid: must be a number > 0, as 0.01 or 1%", text));
  }
  return percent ? *number / 100 : *number;
}

}  // namespace mindahl::cli
