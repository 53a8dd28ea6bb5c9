#pragma once

#include <regex>
#include <set>
#include <string>

namespace mindahl::testing {

/// A page without what says where its lines may break, for text to be looked for as it reads.
inline std::string Unbroken(std::string page) {
  static const std::regex kBreaks("<span class=\"option\">(.*?)</span>|<wbr>");
  return std::regex_replace(page, kBreaks, "$1");
}

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
