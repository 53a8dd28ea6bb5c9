#pragma once

#include <string>
#include <string_view>

namespace mindahl::testing {

/// A page without what says where its lines may break, for text to be looked for as it reads.
inline std::string Unbroken(std::string page) {
  constexpr std::string_view kOption = "<span class=\"option\">";
  constexpr std::string_view kEnd = "</span>";
  constexpr std::string_view kBreak = "<wbr>";
  for (std::size_t at = page.find(kOption); at != std::string::npos; at = page.find(kOption, at)) {
    page.erase(at, kOption.size());
    page.erase(page.find(kEnd, at), kEnd.size());
  }
  for (std::size_t at = page.find(kBreak); at != std::string::npos; at = page.find(kBreak, at)) {
    page.erase(at, kBreak.size());
  }
  return page;
}

}  // namespace mindahl::testing
