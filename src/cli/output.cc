#include <filesystem>
#include <system_error>

#include "cli/command.h"

namespace mindahl::cli {

void WriteText(std::string_view text, const std::string& path, Console& console) {
  if (path == "-") {
    console.out << text;
  } else {
    io::WriteFileAtomically(path, text);
  }
}

void WriteAnswer(Console& console, std::string_view json, std::string_view text) {
  if (!console.json_path.empty()) WriteText(json, console.json_path, console);
  if (console.json_path != "-") console.out << text;
}

void Say(std::string_view what, const std::vector<std::string>& sentences, Console& console) {
  for (const std::string& sentence : sentences) {
    console.err << fmt::format("mindahl {}: {}\n", what, sentence);
  }
}

namespace fs = std::filesystem;

namespace {

/// True for one file under one name or two; writing to a device or a pipe replaces nothing.
bool IsSameFile(const fs::path& first, const fs::path& second) {
  std::error_code error;
  return fs::equivalent(first, second, error) && fs::is_regular_file(first, error);
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

void RequireDistinct(const std::vector<std::string>& files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!IsSameFile(files[i], files[k])) continue;
      Refuse("'{}' and '{}' are one file, whose samples would count twice: give it once", files[k],
             files[i]);
    }
  }
}

}  // namespace

void RequireFiles(const CLI::App& command) {
  std::vector<std::string> inputs;  // a configuration the last
  for (const CLI::App* app : {&command, command.get_parent()}) {
    for (const CLI::Option* each : app->get_options()) {
      if (each->get_type_name() != "FILE") continue;
      inputs.insert(inputs.end(), each->results().begin(), each->results().end());
    }
  }
  std::vector<std::string> outputs;
  for (const CLI::Option* each : command.get_options()) {
    const std::string type = each->get_type_name();
    if (each->count() == 0 || (type != "PATH" && type != "DIR")) continue;
    const std::string option = each->get_name();
    const std::string& path = each->results().back();
    if (path.empty()) continue;
    const bool is_for_output = each->get_description().find("standard output") != std::string::npos;
    if (path == "-" && !is_for_output) {
      Refuse("{}: '-' is standard output, where this does not go: name a file", option);
    }
    if (path != "-" && type == "PATH") RequireWritable(option, path);
    if (option == "--plot") io::RequirePlotName(path);
    for (const std::string& input : inputs) {
      if (!IsSameFile(path, input)) continue;
      Refuse("{}: '{}' is the input '{}', which it would replace: write to another file", option,
             path, input);
    }
    if (std::ranges::find(outputs, path) != outputs.end() && path != "/dev/null") {
      Refuse("{}: '{}' is another output too: give each a file of its own", option, path);
    }
    outputs.push_back(path);
  }
  const CLI::Option* const files = command.get_option_no_throw("files");
  if (files != nullptr) RequireDistinct(files->results());
}

std::string CommandLine(int argc, const char* const* argv) {
  constexpr std::string_view kPlain =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./:,=+@%";
  std::string line = "mindahl";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool is_plain = !word.empty() && word.find_first_not_of(kPlain) == std::string::npos;
    line += is_plain ? " " + word : " '" + CLI::detail::find_and_replace(word, "'", "'\\''") + "'";
  }
  return line;
}

}  // namespace mindahl::cli
