#include <fmt/ranges.h>

#include <filesystem>
#include <system_error>

#include "cli/command.h"
#include "io/source.h"
#include "mindahl/io/output_file.h"
#include "mindahl/io/plot.h"

namespace mindahl::cli {

void WriteText(std::string_view text, const std::string& path, Console& console) {
  if (path == "-") {
    console.out << text;
  } else {
    io::WriteFileAtomically(path, text);
  }
}

void WriteAnswer(const std::string& json_path, Console& console, std::string_view json,
                 std::string_view text) {
  if (!json_path.empty()) WriteText(json, json_path, console);
  if (json_path != "-") console.out << text;
}

void Say(std::string_view what, const std::vector<std::string>& sentences, Console& console) {
  for (const std::string& sentence : sentences) {
    console.err << fmt::format("mindahl {}: {}\n", what, sentence);
  }
}

namespace fs = std::filesystem;

namespace {

/// One file under one name or two, of which neither need be there yet; a device, a terminal or a
/// pipe is none, as writing to it replaces nothing.
bool IsSameFile(const fs::path& first, const fs::path& second) {
  std::error_code error;
  if (fs::equivalent(first, second, error)) return fs::is_regular_file(first, error);
  if (fs::exists(first, error) || fs::exists(second, error)) return false;
  const auto place = [&](const fs::path& path) {
    const fs::path parent = path.parent_path();
    return fs::weakly_canonical(parent.empty() ? fs::path(".") : parent, error) / path.filename();
  };
  return place(first) == place(second);
}

void RequireWritable(const std::string& option, const std::string& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    Refuse("{}: cannot write '{}': it is a directory", option, path);
  }
  const fs::path parent = fs::path(path).parent_path();
  if (!parent.empty() && !fs::is_directory(parent, ignored)) {
    Refuse("{}: cannot write '{}': there is no directory '{}'", option, path, parent.string());
  }
}

/// Returns the options that were given, of a command and of the program, whose value is called so.
std::vector<const CLI::Option*> GivenOf(const CLI::App& command,
                                        std::initializer_list<std::string_view> types) {
  const auto is_given = [&](const CLI::Option* option) {
    return option->count() > 0 && std::ranges::find(types, option->get_type_name()) != types.end();
  };
  std::vector<const CLI::Option*> options = command.get_options(is_given);
  std::ranges::copy(command.get_parent()->get_options(is_given), std::back_inserter(options));
  return options;
}

void RequireOutputs(const CLI::App& command) {
  const std::vector<std::string> inputs = InputsOf(command);
  std::vector<std::pair<std::string, std::string>> checked;  // options with their paths
  for (const CLI::Option* each : GivenOf(command, {"PATH", "DIR"})) {
    const std::string option = "--" + NameOf(*each);
    const std::string& path = each->results().back();
    if (path.empty()) continue;
    const bool is_stdout = path == "-";
    if (!is_stdout && each->get_type_name() == "PATH") RequireWritable(option, path);
    if (option == "--plot") io::RequirePlotName(path);
    for (const std::string& input : inputs) {
      if (is_stdout || !IsSameFile(path, input)) continue;
      Refuse("{}: '{}' is the input '{}', which it would replace: write to another file", option,
             path, input);
    }
    for (const auto& [other, other_path] : checked) {
      if (!(is_stdout ? other_path == "-" : IsSameFile(other_path, path))) continue;
      Refuse("{} and {} both write to '{}': give each a file of its own", other, option, path);
    }
    checked.emplace_back(option, path);
  }
}

}  // namespace

std::vector<std::string> InputsOf(const CLI::App& command) {
  std::vector<std::string> inputs;
  for (const CLI::Option* option : GivenOf(command, {"FILE"})) {
    inputs.insert(inputs.end(), option->results().begin(), option->results().end());
  }
  return inputs;
}

void OnRun(CLI::App& command, std::function<void()> run) {
  command.callback([&command, run = std::move(run)] {
    RequireOutputs(command);
    run();
  });
}

void RequireDistinctFiles(std::span<const std::string> files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!IsSameFile(files[i], files[k])) continue;
      Refuse("'{}' and '{}' are one file, whose samples would count twice: give it once", files[k],
             files[i]);
    }
  }
}

report::Provenance ProvenanceOf(const std::string& command_line,
                                std::span<const std::string> files) {
  report::Provenance provenance{.command = command_line, .inputs = {}};
  for (const std::string& file : files) {
    provenance.inputs.push_back({.name = file, .sha256 = io::Sha256OfFile(file)});
  }
  return provenance;
}

std::string ShellWord(std::string_view word) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:,=+@%";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string_view::npos) {
    return std::string(word);
  }
  return fmt::format("'{}'", CLI::detail::find_and_replace(std::string(word), "'", "'\\''"));
}

std::string CommandLine(int argc, const char* const* argv) {
  std::string line = "mindahl";
  for (int i = 1; i < argc; ++i) line.append(" ").append(ShellWord(argv[i]));
  return line;
}

}  // namespace mindahl::cli
