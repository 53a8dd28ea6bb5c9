#include "cli/app.h"

#include <toml++/toml.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <exception>
#include <new>
#include <sstream>
#include <system_error>

#include "cli/command.h"
#include "mindahl/core/version.h"

namespace mindahl::cli {
namespace {

using Command = std::pair<std::string_view, void (*)(CLI::App& app, Console& console)>;
constexpr auto kCommands = std::to_array<Command>({{"fit", AddFitCommand},
                                                   {"simulate", AddSimulateCommand},
                                                   {"validate", AddValidateCommand},
                                                   {"contact", AddContactCommand},
                                                   {"convert", AddConvertCommand},
                                                   {"tradeoff", AddTradeoffCommand},
                                                   {"plan", AddPlanCommand},
                                                   {"track", AddTrackCommand},
                                                   {"batch", AddBatchCommand}});

/// TOML whose keys are options of the command being run. Another key is an error: a misspelling.
class CommandConfig : public CLI::ConfigTOML {
 public:
  explicit CommandConfig(const CLI::App& app) : app_(app) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> read;
    if (app_.get_subcommands().empty()) return read;
    const CLI::App& command = *app_.get_subcommands().front();
    toml::table options;
    try {
      options = toml::parse(input);
    } catch (const toml::parse_error& error) {
      const toml::source_position& at = error.source().begin;
      Refuse("--config {}:{}:{}: {}", app_.get_config_ptr()->as<std::string>(), at.line, at.column,
             error.description());
    }
    for (const auto& [key, node] : options) {
      CLI::ConfigItem& item = read.emplace_back();
      item.parents = {command.get_name()};
      item.name = key.str();
      if (command.get_option_no_throw("--" + item.name) == nullptr) {
        Refuse("--config: '{}' is no option of {}: see mindahl {} --help-all", item.name,
               command.get_name(), command.get_name());
      }
      if (const toml::array* values = node.as_array()) {
        for (const toml::node& value : *values) item.inputs.push_back(TextOf(value));
      } else {
        item.inputs.push_back(TextOf(node));
      }
    }
    return read;
  }

 private:
  /// Returns a value as the command line has it.
  static std::string TextOf(const toml::node& value) {
    if (const auto* text = value.as_string()) return text->get();
    std::ostringstream text;
    text << toml::node_view(value);
    return text.str();
  }

  const CLI::App& app_;
};

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
  std::string name = "--" + message.substr(0, unit);
  std::ranges::replace_if(
      name, [](char c) { return c == ' ' || c == '_'; }, '-');
  if (name == "--tangential-stiffness") name = "--sigma";
  if (name == "--shape-exponent") name = "--alpha";
  const CLI::Option* option = running.front()->get_option_no_throw(name);
  return option == nullptr || option->count() == 0 ? message : name + message.substr(unit);
}

int RunAndExplain(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
  // Results go out in one piece at the end: of a run that fails nothing is printed, and what a full
  // disk does not take is noticed.
  std::ostringstream results;
  results.exceptions(std::ios::badbit);  // where memory runs out
  CLI::App app{
      "Identifies the friction parameters of a contact from its measured hysteresis loop:\n"
      "tangential displacement and force in; Dahl's stiffness sigma [N/m], shape exponent alpha "
      "[-]\nand slip force Tc [N] out, with their uncertainties and the Hertz-Mindlin contact "
      "behind them.",
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

  Console console{.out = results, .err = err, .command_line = CommandLine(argc, argv)};
  const std::string_view first = argc > 1 ? argv[1] : "";
  const bool is_command = std::ranges::find(kCommands, first, &Command::first) != kCommands.end();
  for (const auto& [name, add] : kCommands) {
    // The options of the commands that do not run take a seventh of the time of a short fit.
    if (name == first || !is_command) add(app, console);
  }

  const auto refuse = [&](std::string_view why) {
    err << fmt::format("{}: {}\n", CommandName(app), why);
    return kBadInput;
  };
  if (!is_command && !first.empty() && first.front() != '-') {
    return refuse("command " + UnknownAmong(first, NamesOf(kCommands, &Command::first)));
  }
  try {
    try {
      app.parse(argc, argv);
    } catch (const CLI::Success& request) {  // --help, --version
      console.exit_status = app.exit(request, results, err);
    }
    errno = 0;
    if (out << results.view() << std::flush) return console.exit_status;
    return refuse(fmt::format("cannot write to standard output: {}",
                              errno != 0 ? std::strerror(errno) : "it is closed"));
  } catch (const CLI::ParseError& error) {
    return refuse(fmt::format("{}; see {} --help", OneLine(error.what()), CommandName(app)));
  } catch (const InputError& error) {
    return refuse(OneLine(error.what()));
  } catch (const InvalidArgument& error) {
    return refuse(WithOption(app, OneLine(error.what())));
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
