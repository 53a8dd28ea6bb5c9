#pragma once

#include <algorithm>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>

/// Pages of docs/, to be compared with what the program does.
namespace mindahl::testing {

/// @param page  from the project's folder, "docs/contract.md"
inline std::string PageText(const std::string& page) {
  std::ifstream in(std::string(MINDAHL_SOURCE_DIR) + "/" + page);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  std::erase(text, '\\');  // of G\*, which is plain text in the program
  return text;
}

/// By heading, "mindahl fit"; what stands before the first has the heading "".
inline std::map<std::string, std::string> PageSections(const std::string& page) {
  std::map<std::string, std::string> sections;
  const std::string text = PageText(page);
  std::string heading;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    if (line.starts_with("## ")) {
      heading = line.substr(3);
    } else {
      sections[heading] += line + "\n";
    }
    begin = end + 1;
  }
  return sections;
}

inline std::map<std::string, std::string> ContractSections() {
  return PageSections("docs/contract.md");
}

/// What a pattern's first group matches.
inline std::set<std::string> Matches(const std::string& text, const std::string& pattern) {
  std::set<std::string> found;
  const std::regex regex(pattern);
  for (std::sregex_iterator match(text.begin(), text.end(), regex), end; match != end; ++match) {
    found.insert((*match)[1]);
  }
  return found;
}

}  // namespace mindahl::testing
