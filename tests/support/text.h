#pragma once

#include <regex>
#include <set>
#include <string>

namespace mindahl::testing {

/// Returns the matches of a pattern's first group.
inline std::set<std::string> Matches(const std::string& text, const std::string& pattern) {
  std::set<std::string> found;
  const std::regex regex(pattern);
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match) {
    found.insert((*match)[1]);
  }
  return found;
}

}  // namespace mindahl::testing
