#include "cli/options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

#include "core/from_chars.h"
#include "core/nearest_name.h"
#include "mindahl/core/error.h"

namespace mindahl::cli {

void AddExamples(CLI::App& command, const CLI::App& app,
                 std::initializer_list<std::string_view> lines) {
  std::string text = "Examples:\n";
  for (const std::string_view line : lines) {
    text += "  ";
    text += line;
    text += '\n';
  }
  command.footer(text + '\n' + app.get_footer());
}

CLI::Validator OneOf(std::vector<std::string> words) {
  const std::string listed = fmt::format("{{{}}}", fmt::join(words, ","));
  const auto check = [words = std::move(words)](const std::string& text) {
    const bool is_one = std::ranges::find(words, text) != words.end();
    return is_one ? std::string() : UnknownAmong(text, words);
  };
  return CLI::Validator(check, listed);
}

double ParseTolerance(const std::string& text) {
  const bool percent = text.ends_with('%');
  const char* end = text.data() + text.size() - (percent ? 1 : 0);
  double number = 0.0;
  const auto [rest, error] = FromChars(text.data(), end, number);
  if (error != std::errc() || rest != end || !(number > 0) || !std::isfinite(number)) {
    throw InputError(
        fmt::format("--tolerance '{}' is invalid: must be a number > 0, as 0.01 or 1%", text));
  }
  return percent ? number / 100 : number;
}

}  // namespace mindahl::cli
