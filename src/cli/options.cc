#include <fmt/ranges.h>

#include <cmath>

#include "cli/command.h"
#include "core/refuse.h"
#include "core/text.h"
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

CLI::Validator OneOf(const std::vector<std::string_view>& words) {
  const auto check =
      [names = std::vector<std::string>(words.begin(), words.end())](const std::string& text) {
        const bool is_one = std::ranges::find(names, text) != names.end();
        return is_one ? std::string() : UnknownAmong(text, names);
      };
  return {check, fmt::format("{{{}}}", fmt::join(words, ","))};
}

CLI::Validator WholeNumber(std::uint64_t least, std::uint64_t most) {
  const auto check = [least, most](const std::string& text) -> std::string {
    const auto number = NumberIn<std::uint64_t>(text);
    if (number && *number >= least && *number <= most) return {};
    return fmt::format("'{}' is invalid: must be a whole number from {} to {}", text, least, most);
  };
  return {check, /*description=*/""};
}

CLI::Validator InUnit(const std::string& unit) {
  const auto convert = [unit](std::string& text) -> std::string {
    // A text without a unit is read, and refused, as a number.
    if (Trimmed(std::string_view(text).substr(BeginOfUnit(text))).empty()) return {};
    const std::optional<double> value = ParseQuantity(text, unit);
    if (!value) {
      return fmt::format("'{}' is no quantity in {}: write a number or its unit", text, unit);
    }
    text = fmt::format("{}", *value);
    return {};
  };
  return {convert, /*description=*/""};
}

CLI::Option* OptionGroup::Grouped(CLI::Option* added, const std::string& type) const {
  added->group(name_);
  if (!type.empty()) added->type_name(type);
  return added;
}

CLI::Option* OptionGroup::AddFlag(const std::string& option, bool& value,
                                  const std::string& help) const {
  // CLI11 itself reads --flag=5 as five times --flag.
  const auto check = [](const std::string& text) -> std::string {
    if (text == "true" || text == "false") return {};
    return fmt::format("'{}' is no value: a flag takes none, or true or false", text);
  };
  return Grouped(command_.add_flag(option, value, help)->check(check), "");
}

std::vector<const CLI::Option*> OptionsOf(const CLI::App& command) {
  return command.get_options(
      [](const CLI::Option* option) { return !option->get_lnames().empty(); });
}

std::optional<double> ParseShare(std::string_view text) {
  const bool is_percent = text.ends_with('%');
  if (is_percent) text.remove_suffix(1);
  const std::optional<double> number = NumberIn<double>(text);
  if (!number || !(*number > 0) || !std::isfinite(*number)) return std::nullopt;
  return is_percent ? *number / 100 : *number;
}

void AddTolerance(const OptionGroup& group, double& tolerance, const std::string& help) {
  const auto read = [&tolerance](const std::string& text) {
    const std::optional<double> share = ParseShare(text);
    if (!share) {
      Refuse("--tolerance '{}' is invalid: must be a number > 0, as 0.01 or 1%", text);
    }
    tolerance = *share;
  };
  group.AddRead("--tolerance", read, help, "E")->default_str("1%");
}

CLI::Option* AddPath(const OptionGroup& group, std::string& path, std::string& column,
                     const std::string& remark) {
  CLI::Option* const added =
      group.Add("--path", path, "CSV file with a displacement, any sequence" + remark, "FILE");
  group
      .Add("--displacement", column,
           "its column, by header name or number, with its unit, \"[um]\", if the\nheader has "
           "none; default by its name, else the first",
           "COL")
      ->needs(added);
  return added;
}

void AddThreads(const OptionGroup& group, std::size_t& threads, const std::string& unchanged) {
  constexpr std::uint64_t kMost = 1024;
  group
      .Add("--threads", threads,
           "number of worker threads (default: one per core); they do not change\n" + unchanged)
      ->check(WholeNumber(1, kMost));
}

}  // namespace mindahl::cli
