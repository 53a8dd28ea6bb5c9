#include "cli/app.h"

#include <fmt/ranges.h>
#include <toml++/toml.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <new>
#include <sstream>
#include <stdexcept>
#include <system_error>

#include "cli/command.h"
#include "mindahl/core/version.h"

namespace mindahl::cli {
namespace {

struct CommandRow {
  std::string_view name;
  void (*add)(CLI::App& app, Console& console);
};
constexpr std::array kCommands = {
    CommandRow{"fit", AddFitCommand},           CommandRow{"simulate", AddSimulateCommand},
    CommandRow{"validate", AddValidateCommand}, CommandRow{"contact", AddContactCommand},
    CommandRow{"convert", AddConvertCommand},   CommandRow{"tradeoff", AddTradeoffCommand},
    CommandRow{"plan", AddPlanCommand},         CommandRow{"track", AddTrackCommand},
    CommandRow{"batch", AddBatchCommand}};

bool IsCommand(std::string_view name) {
  return std::ranges::find(kCommands, name, &CommandRow::name) != kCommands.end();
}

/// TOML whose keys belong to the command being run, with or without its name as a section; the
/// sections of other commands are theirs. A key that is no option is an error: it is a misspelling.
class CommandConfig : public CLI::ConfigTOML {
 public:
  explicit CommandConfig(const CLI::App& app) : app_(app) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> selected;
    if (app_.get_subcommands().empty()) return selected;
    try {
      AddItems(toml::parse(input), /*is_section=*/false, selected);
    } catch (const toml::parse_error& error) {
      Refuse(error.source(), error.description());
    }
    return selected;
  }

 private:
  [[noreturn]] void Refuse(const toml::source_region& place, std::string_view why) const {
    mindahl::Refuse("--config: {}:{}: {}", app_.get_config_ptr()->as<std::string>(),
                    place.begin.line, why);
  }

  std::string ValueOf(const toml::node& node) const {
    if (const auto* text = node.as_string()) return text->get();
    if (const auto* number = node.as_integer()) return fmt::format("{}", number->get());
    if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
    if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
    Refuse(node.source(), "the value is no string, number or boolean, nor an array of such");
  }

  void AddItems(const toml::table& table, bool is_section,
                std::vector<CLI::ConfigItem>& selected) const {
    const CLI::App& command = *app_.get_subcommands().front();
    const std::string& running = command.get_name();
    for (const auto& [key, node] : table) {
      const std::string name(key.str());
      if (!is_section && node.is_table() && IsCommand(name)) {
        if (name == running) AddItems(*node.as_table(), /*is_section=*/true, selected);
        continue;
      }
      if (command.get_option_no_throw("--" + name) == nullptr) {
        Refuse(
            key.source(),
            fmt::format("'{0}.{1}' is no option of {0}: keys are those of {0} --help without the "
                        "dashes, in a section named after a command or in none",
                        running, name));
      }
      CLI::ConfigItem item{{running}, name, {}};
      if (const toml::array* array = node.as_array()) {
        for (const toml::node& value : *array) item.inputs.push_back(ValueOf(value));
      } else {
        item.inputs.push_back(ValueOf(node));
      }
      if (!item.inputs.empty()) selected.push_back(std::move(item));  // nothing asks for nothing
    }
  }

  const CLI::App& app_;
};

/// The first word that looks like an option and is none, without its value: whatever else is then
/// wrong with the line follows from it.
std::optional<std::string> UnknownOption(const CLI::App& app) {
  for (const std::string& word : app.remaining(/*recurse=*/true)) {
    const bool is_option = word.size() > 1 && word[0] == '-' &&
                           std::string_view("0123456789.").find(word[1]) == std::string_view::npos;
    if (is_option && word != "--") return word.substr(0, word.find('='));
  }
  return std::nullopt;
}

std::string OneLine(std::string text) {
  text.erase(text.find_last_not_of('\n') + 1);
  std::ranges::replace(text, '\n', ' ');
  return text;
}

std::string CommandName(const CLI::App& app) {
  const auto running = app.get_subcommands();
  return running.empty() ? "mindahl" : "mindahl " + running.front()->get_name();
}

/// The message of a broken precondition, "lag [s] = nan is invalid: …", with the option in place of
/// the quantity where the user gave it: "--lag [s] = nan is invalid: …".
std::string WithOption(const CLI::App& app, const std::string& message) {
  const auto running = app.get_subcommands();
  const std::size_t unit = message.find(" [");
  if (running.empty() || unit == std::string::npos) return message;
  const std::string quantity = message.substr(0, unit);
  std::string name = quantity == "tangential stiffness" ? "--sigma"
                     : quantity == "shape exponent"     ? "--alpha"
                                                        : "--" + quantity;
  std::ranges::replace(name, ' ', '-');
  std::ranges::replace(name, '_', '-');
  const CLI::Option* option = running.front()->get_option_no_throw(name);
  return option == nullptr || option->count() == 0 ? message : name + message.substr(unit);
}

/// @returns `status`, or that of an output which cannot be written
int Print(std::string_view results, const std::string& program, int status, std::ostream& out,
          std::ostream& err) {
  errno = 0;
  out << results << std::flush;
  if (out) return status;
  err << fmt::format("{}: cannot write to standard output: {}\n", program,
                     errno != 0 ? std::strerror(errno) : "it is closed");
  return kBadInput;
}

int RunAndExplain(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  // Results go out in one piece at the end: of a run that fails nothing is printed, and what a full
  // disk does not take is noticed.
  std::ostringstream results;
  CLI::App app{
      "Identifies the friction parameters of a contact from its measured hysteresis loop:\n"
      "tangential displacement and force in; Dahl's stiffness sigma [N/m], shape exponent alpha "
      "[-]\n"
      "and slip force Tc [N] out, with their uncertainties and the Hertz-Mindlin contact behind "
      "them.",
      "mindahl"};
  app.footer(
      "Every command takes its options from a TOML file too: --config FILE.\n"
      "Exit status: 0 done, 1 internal error, 2 bad usage or input, 3 ran but not established\n"
      "(not converged, not identifiable with --strict, or a validation failed).");
  app.set_version_flag("--version", std::string(Version()));
  app.require_subcommand(1);
  app.fallthrough();
  app.set_config("--config", "",
                 "TOML file with options of the command, keys as on the command line")
      ->type_name("FILE");
  app.config_formatter(std::make_shared<CommandConfig>(app));

  Console console{results, err, kDone, CommandLine(argc, argv)};
  const std::string_view first = argc > 1 ? argv[1] : "";
  for (const CommandRow& command : kCommands) {
    // The options of the commands that do not run take a seventh of the time of a short fit.
    if (command.name == first || !IsCommand(first)) {
      command.add(app, console);
    } else {
      app.add_subcommand(std::string(command.name));  // a configuration may have its section
    }
  }

  // CLI11 only says that a command is missing.
  if (argc > 1 && !first.starts_with('-') && !IsCommand(first)) {
    const auto names = NamesOf(kCommands, &CommandRow::name);
    err << fmt::format("mindahl: there is no command '{}': must be one of {}; see mindahl --help\n",
                       OneLine(std::string(first)), fmt::join(names, ", "));
    return kBadInput;
  }
  const auto refuse = [&](std::string_view why) {
    err << fmt::format("{}: {}\n", CommandName(app), why);
    return kBadInput;
  };
  try {
    app.parse(argc, argv);
    return Print(results.view(), CommandName(app), console.exit_status, out, err);
  } catch (const CLI::Success& request) {  // --help, --version
    const int status = app.exit(request, results, err);
    return Print(results.view(), CommandName(app), status, out, err);
  } catch (const CLI::ParseError& error) {
    const auto unknown = UnknownOption(app);
    const std::string fault = unknown ? fmt::format("there is no option '{}':", OneLine(*unknown))
                                      : OneLine(error.what()) + ";";
    return refuse(fmt::format("{} see {} --help", fault, CommandName(app)));
  } catch (const InputError& error) {
    return refuse(OneLine(error.what()));
  } catch (const InvalidArgument& error) {
    return refuse(WithOption(app, OneLine(error.what())));
  } catch (const std::length_error&) {  // more elements than any memory holds
    return refuse("more is asked for than memory can hold");
  } catch (const std::bad_alloc&) {
    return refuse("memory ran out: ask for less, or allow more");
  } catch (const std::system_error& error) {  // no thread or no directory for temporary files
    return refuse("the system refuses: " + OneLine(error.what()));
  } catch (const std::exception& error) {
    err << fmt::format("{}: internal error: {}\n", CommandName(app), OneLine(error.what()));
    return kInternalError;
  }
}

}  // namespace

void ReadOptions(const std::vector<std::string>& words, const std::function<void(CLI::App&)>& add) {
  CLI::App app;
  add(app);
  try {
    app.parse(std::vector<std::string>(words.rbegin(), words.rend()));
  } catch (const CLI::ParseError& error) {
    throw InputError(OneLine(error.what()));
  }
}

int Run(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  try {
    return RunAndExplain(argc, argv, out, err);
  } catch (const std::bad_alloc&) {  // before there is a command, or of the message itself
    err << "mindahl: memory ran out\n";
    return kBadInput;
  }
}

}  // namespace mindahl::cli
