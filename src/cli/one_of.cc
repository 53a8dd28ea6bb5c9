#include "cli/one_of.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "core/nearest_name.h"

namespace mindahl::cli {

CLI::Validator OneOf(std::vector<std::string> words) {
  const std::string listed = fmt::format("{{{}}}", fmt::join(words, ","));
  const auto check = [words = std::move(words)](const std::string& text) {
    const bool is_one = std::ranges::find(words, text) != words.end();
    return is_one ? std::string() : UnknownAmong(text, words);
  };
  return CLI::Validator(check, listed);
}

}  // namespace mindahl::cli
