#include "mindahl/request/one_of.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/nearest_name.h"
#include "mindahl/core/error.h"

namespace mindahl::request {

void RequireOneOf(std::string_view option, std::string_view word,
                  std::span<const std::string_view> words) {
  if (std::ranges::find(words, word) != words.end()) return;
  const std::vector<std::string> names(words.begin(), words.end());
  throw InputError(fmt::format("{}: {}", option, UnknownAmong(word, names)));
}

}  // namespace mindahl::request
