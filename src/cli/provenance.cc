#include "cli/provenance.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <vector>

#include "cli/options.h"
#include "io/source.h"

namespace mindahl::cli {
namespace {

bool IsFlag(const CLI::Option& option) { return option.get_items_expected_max() == 0; }

report::InputFile DigestOf(const std::string& file) {
  return {.name = file, .sha256 = io::Sha256OfFile(file)};
}

}  // namespace

report::Provenance ProvenanceOf(const CLI::App& command, const Console& console,
                                std::span<const std::string> files) {
  report::Provenance provenance{.command = console.command_line, .inputs = {}, .options = {}};
  for (const std::string& file : files) provenance.inputs.push_back(DigestOf(file));
  for (const std::string& file : console.inputs) {
    if (!file.empty()) provenance.inputs.push_back(DigestOf(file));
  }
  for (const CLI::Option* option : OptionsOf(command)) {
    if (option->count() == 0) continue;
    provenance.options.emplace_back(
        "--" + NameOf(*option),
        IsFlag(*option) ? "on" : fmt::format("{}", fmt::join(option->results(), ", ")));
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

report::Provenance ProvenanceOfOneFit(const CLI::App& batch, const Console& console,
                                      const std::string& file) {
  constexpr std::array<std::string_view, 6> kOfBatch = {"--output", "--overwrite", "--json",
                                                        "--report", "--threads",   "--strict"};
  report::Provenance provenance = ProvenanceOf(batch, console, {&file, 1});
  std::erase_if(provenance.options, [&](const auto& option) {
    return std::ranges::find(kOfBatch, option.first) != kOfBatch.end();
  });
  provenance.command = "mindahl fit " + ShellWord(file);
  for (const CLI::Option* option : OptionsOf(batch)) {
    const std::string name = "--" + NameOf(*option);
    if (option->count() == 0 || std::ranges::find(kOfBatch, name) != kOfBatch.end()) continue;
    if (IsFlag(*option)) {
      provenance.command.append(" ").append(name);
      continue;
    }
    for (const std::string& value : option->results()) {
      provenance.command.append(" ").append(name).append(" ").append(ShellWord(value));
    }
  }
  return provenance;
}

}  // namespace mindahl::cli
