#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <memory>
#include <type_traits>

#include "cli/app.h"
#include "core/refuse.h"
#include "core/text.h"
#include "mindahl/core/units.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"
#include "mindahl/models/response.h"
#include "mindahl/request/fit_request.h"
#include "report/json.h"

// This header declares what the sources of all commands use: functions that add options, the
// options that several commands share, and functions that write answers.
namespace mindahl::cli {

using report::Json;
using report::NumberOrNull;
using request::ContactOptions;
using request::FitRequest;
using request::LawRequest;
using request::Strictness;

// --- adding commands and options

/// Refuses files of a command as AddCommand() says.
void RequireFiles(const CLI::App& command);

/// Adds a command to the program. Before running, it refuses outputs that are not writable, that
/// name one file twice, or that are also inputs, and `files` that are given twice, by one name or
/// two. An option whose value is called PATH or DIR writes there, "-" to standard output where its
/// help says so; one called FILE is read.
/// @param examples  lines of its help to copy, which tests/cli/help_text.py runs; one that
///                  continues the last begins with blanks
/// @returns the command, and the options that it runs with, which live as long
template <typename Options>
std::pair<CLI::App&, Options&> AddCommand(CLI::App& program, Console& console,
                                          const std::string& name, const std::string& about,
                                          std::initializer_list<std::string_view> examples,
                                          void (*run)(const Options&, Console&)) {
  const auto options = std::make_shared<Options>();
  CLI::App* const command = program.add_subcommand(name, about);
  command->footer(
      fmt::format("Examples:\n  {}\n\n{}", fmt::join(examples, "\n  "), program.get_footer()));
  command->set_help_all_flag("--help-all", "Print all options and exit");
  command->callback([command, options, run, &console] {
    RequireFiles(*command);
    run(*options, console);
  });
  return {*command, *options};
}

/// Lets the help of a command show these options alone, and `--help-all` all of them.
/// @param names  with their dashes, in the order of the help
void ShowFirst(CLI::App& command, std::vector<std::string> names);

/// Adds options to one group of a command's help. A name without dashes is that of
/// positional arguments.
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
    const auto to_number = [unit](std::string& text) -> std::string {
      const std::optional<double> number = ParseQuantity(text, unit);
      if (!number) {
        return fmt::format("'{}' is no quantity in {}: write a number or its unit", text, unit);
      }
      text = fmt::format("{}", *number);
      return {};
    };
    return Add(option, value, help, type)->transform({to_number, /*description=*/""});
  }
  /// Adds an option whose default the help shows.
  template <typename Value>
  CLI::Option* AddShown(const std::string& option, Value& value, const std::string& help,
                        const std::string& type = "") const {
    return Add(option, value, help, type)->capture_default_str();
  }
  /// Adds an option that takes a whole number.
  template <typename Value>
  CLI::Option* AddCount(const std::string& option, Value& value, const std::string& help,
                        std::int64_t least = 1, std::int64_t most = 1'000'000'000) const {
    return AddShown(option, value, help)->check(CLI::Range(least, most).description(""));
  }
  /// Adds an option that takes one of some words.
  CLI::Option* AddWord(const std::string& option, std::string& word,
                       const std::vector<std::string>& words, const std::string& help) const {
    return AddShown(option, word, help)->check(CLI::IsMember(words));
  }
  /// Adds an option whose words stand for values, the first for the one that it has.
  template <typename Value>
  CLI::Option* AddChoice(const std::string& option, Value& target,
                         std::vector<std::pair<std::string, Value>> choices,
                         const std::string& help) const {
    constexpr auto kName = &std::pair<std::string, Value>::first;
    const auto read = [&target, choices](const std::string& word) {
      target = std::ranges::find(choices, word, kName)->second;
    };
    const std::vector<std::string> names = NamesOf(choices, kName);
    return AddRead(option, read, help, "")->default_str(names.front())->check(CLI::IsMember(names));
  }
  /// Adds an option whose text, or whose texts, a function reads.
  template <typename Text = std::string>
  CLI::Option* AddRead(const std::string& option,
                       const std::type_identity_t<std::function<void(const Text&)>>& read,
                       const std::string& help, const std::string& type) const {
    return Grouped(command_.add_option_function<Text>(option, read, help), type);
  }
  /// Adds an option that may be repeated, each of whose texts a function reads.
  CLI::Option* AddEach(const std::string& option,
                       const std::function<void(const std::string&)>& read, const std::string& help,
                       const std::string& type) const {
    const auto read_all = [read](const std::vector<std::string>& texts) {
      std::ranges::for_each(texts, read);
    };
    return AddRead<std::vector<std::string>>(option, read_all, help, type)->allow_extra_args(false);
  }
  CLI::Option* AddFlag(const std::string& option, bool& value, const std::string& help) const {
    // CLI11 itself reads --flag=5 as five times --flag.
    const CLI::Validator is_one = CLI::IsMember({"true", "false"}).description("");
    return Grouped(command_.add_flag(option, value, help)->check(is_one), "");
  }
  CLI::Option* AddJson(Console& console) const {
    return Add("--json", console.json_path, "answer as JSON; - for standard output alone", "PATH");
  }
  CLI::Option* AddThreads(std::size_t& threads, const std::string& unchanged) const {
    const char* help = "number of worker threads (default: one per core); they do not change\n";
    return Add("--threads", threads, help + unchanged)->check(CLI::Range(1, 1024).description(""));
  }
  /// Adds --path, which it returns, a file with a displacement, and --displacement, its column.
  CLI::Option* AddPath(std::string& path, std::string& column) const {
    CLI::Option* file = Add("--path", path, "CSV file with a displacement, any sequence", "FILE");
    Add("--displacement", column,
        "its column, by header name or number, with its unit, \"[um]\", if the\nheader has none; "
        "default by its name, else the first",
        "COL")
        ->needs(file);
    return file;
  }

 private:
  CLI::Option* Grouped(CLI::Option* added, const std::string& type) const {
    added->group(name_);
    return type.empty() ? added : added->type_name(type);
  }

  CLI::App& command_;
  std::string name_;
};

inline constexpr const char* kPlainGroup = "Options";

// --- options that make a request: for a contact, for a law, and for a fit

/// Reads "50", "50±0.5", "50+-0.5", "50+/-0.5" or "50±1%": a number and, unless it is exact, one
/// standard uncertainty. Either may have a unit; one at the end is of both, "50±0.5 N".
/// @param unit  that of a number
/// @throws InputError naming the option, the text, the rule and the remedy
contact::UncertainValue ParseUncertainValue(std::string_view text, std::string_view option,
                                            std::string_view unit);

/// Adds --normal-load, --youngs-modulus-1 … --radius-2, --contact-radius and --compliance, and
/// --friction where it is no result, each with a standard uncertainty.
void AddContactOptions(CLI::App& command, ContactOptions& options, bool has_friction = false);

void AddLawParameters(const OptionGroup& group, LawRequest& law);

/// Returns the displacement [m] of λ = 1, behind a rig: gross slip, but at most three elastic
/// limits, 3Tc/σ, which a law of α > 2/3 passes before it slips.
double SlipReach(const models::BranchLaw& law, const models::SeriesSpring& rig = {});

void AddColumnOptions(CLI::App& command, io::RecordColumns& columns);
/// @param of_cycles  the help is that of `track`, which has no asymmetry, column or choice of law
void AddModelOptions(CLI::App& command, FitRequest& request, bool of_cycles = false);
/// Adds those of columns, of the model and of the contact, and which samples count.
void AddFitOptions(CLI::App& command, FitRequest& request);

/// Adds `--strict`, which asks for kAdequate, and `--strict=doubtful`.
/// @param otherwise  what happens to a fit that is not: "exit status 3"
void AddStrict(CLI::App& command, Strictness& strictness, const std::string& otherwise);

// --- inputs and outputs

/// Writes to a file, whole or not at all, or to standard output for "-".
/// @throws InputError when the file cannot be written
void WriteText(std::string_view text, const std::string& path, Console& console);

/// Says sentences on standard error, each behind "mindahl <what>: ".
void Say(std::string_view what, const std::vector<std::string>& sentences, Console& console);

/// Writes an answer as JSON where that is asked for, and as text unless the JSON goes there.
void WriteAnswer(Console& console, std::string_view json, std::string_view text);

/// Returns the command line as a shell takes it, words in single quotes where they need them.
std::string CommandLine(int argc, const char* const* argv);

}  // namespace mindahl::cli
