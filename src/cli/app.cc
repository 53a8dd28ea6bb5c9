#include "cli/app.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cli/commands.h"
#include "mindahl/core/error.h"
#include "mindahl/core/version.h"

namespace mindahl::cli {
namespace {

std::vector<const CLI::App*> Commands(const CLI::App& app) {
  return app.get_subcommands([](const CLI::App*) { return true; });
}

bool IsCommand(const CLI::App& app, std::string_view name) {
  return std::ranges::any_of(
      Commands(app), [name](const CLI::App* command) { return command->get_name() == name; });
}

/// TOML whose keys belong to the command being run, with or without its name as a section; the
/// sections of other commands are theirs. A key that is no option is an error: it is a misspelling.
class CommandConfig : public CLI::ConfigTOML {
 public:
  explicit CommandConfig(const CLI::App& app) : app_(app) {}

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override {
    std::vector<CLI::ConfigItem> selected;
    const auto running = app_.get_subcommands();
    for (CLI::ConfigItem& item : CLI::ConfigTOML::from_config(input)) {
      if (item.name == "++" || item.name == "--" || running.empty()) continue;
      const CLI::App& command = *running.front();
      if (item.parents.empty()) item.parents = {command.get_name()};
      const std::string& section = item.parents.front();
      if (!IsCommand(app_, section)) {
        throw InputError(fmt::format("--config: section '{}' is no command of mindahl", section));
      }
      if (section != command.get_name()) continue;
      if (item.parents.size() > 1 || command.get_option_no_throw("--" + item.name) == nullptr) {
        throw InputError(
            fmt::format("--config: '{}' is no option of {}: keys are those of {} "
                        "--help without the dashes",
                        item.fullname(), section, section));
      }
      selected.push_back(std::move(item));
    }
    return selected;
  }

 private:
  const CLI::App& app_;
};

/// The first word that is no option, where it is no command either; CLI11 only says that one is
/// missing.
std::optional<std::string> UnknownCommand(const CLI::App& app, int argc, const char* const* argv) {
  if (argc < 2 || std::string_view(argv[1]).starts_with('-')) return std::nullopt;
  if (IsCommand(app, argv[1])) return std::nullopt;
  return argv[1];
}

std::string CommandNames(const CLI::App& app) {
  std::string names;
  for (const CLI::App* command : Commands(app)) {
    names += (names.empty() ? "" : ", ") + command->get_name();
  }
  return names;
}

std::string OneLine(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  for (char& c : text) {
    if (c == '\n') c = ' ';
  }
  return text;
}

std::string CommandName(const CLI::App& app) {
  const auto running = app.get_subcommands();
  return running.empty() ? "mindahl" : "mindahl " + running.front()->get_name();
}

}  // namespace

int Run(int argc, const char* const* argv, std::ostream& out, std::ostream& err) {
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

  Console console{out, err};
  AddFitCommand(app, console);
  AddSimulateCommand(app, console);
  AddValidateCommand(app, console);
  AddContactCommand(app, console);
  AddTradeoffCommand(app, console);
  AddRecommendCommand(app, console);

  if (const auto unknown = UnknownCommand(app, argc, argv)) {
    err << fmt::format("mindahl: there is no command '{}': must be one of {}; see mindahl --help\n",
                       OneLine(*unknown), CommandNames(app));
    return kBadInput;
  }
  try {
    app.parse(argc, argv);
    out.flush();
    return console.exit_status;
  } catch (const CLI::Success& request) {  // --help, --version
    return app.exit(request, out, err);
  } catch (const CLI::ParseError& error) {
    err << fmt::format("{}: {}; see {} --help\n", CommandName(app), OneLine(error.what()),
                       CommandName(app));
    return kBadInput;
  } catch (const InputError& error) {
    err << fmt::format("{}: {}\n", CommandName(app), OneLine(error.what()));
    return kBadInput;
  } catch (const InvalidArgument& error) {
    err << fmt::format("{}: {}\n", CommandName(app), OneLine(error.what()));
    return kBadInput;
  } catch (const std::exception& error) {
    err << fmt::format("{}: internal error: {}\n", CommandName(app), OneLine(error.what()));
    return kInternalError;
  }
}

}  // namespace mindahl::cli
