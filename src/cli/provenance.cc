#include "cli/provenance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/options.h"
#include "io/source.h"

namespace mindahl::cli {

report::Provenance ProvenanceOf(const CLI::App& command, const std::string& command_line,
                                std::span<const std::string> files) {
  report::Provenance provenance{.command = command_line, .inputs = {}, .options = {}};
  for (const std::string& file : files) {
    provenance.inputs.push_back({.name = file, .sha256 = io::Sha256OfFile(file)});
  }
  for (const CLI::Option* option : OptionsOf(command)) {
    if (option->count() == 0) continue;
    const bool is_flag = option->get_items_expected_max() == 0;
    provenance.options.emplace_back(
        "--" + NameOf(*option),
        is_flag ? "on" : fmt::format("{}", fmt::join(option->results(), ", ")));
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
