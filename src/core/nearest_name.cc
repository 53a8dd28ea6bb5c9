#include "core/nearest_name.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "core/text.h"

namespace mindahl {
namespace {

/// Edits from one text to the other, in which no part is edited twice.
std::size_t EditDistance(std::string_view from, std::string_view to) {
  std::vector<std::vector<std::size_t>> edits(from.size() + 1,
                                              std::vector<std::size_t>(to.size() + 1));
  for (std::size_t i = 0; i <= from.size(); ++i) edits[i][0] = i;
  for (std::size_t j = 0; j <= to.size(); ++j) edits[0][j] = j;
  for (std::size_t i = 1; i <= from.size(); ++i) {
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = edits[i - 1][j - 1] + (from[i - 1] == to[j - 1] ? 0 : 1);
      edits[i][j] = std::min({edits[i - 1][j] + 1, edits[i][j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
      if (swapped) edits[i][j] = std::min(edits[i][j], edits[i - 2][j - 2] + 1);
    }
  }
  return edits.back().back();
}

}  // namespace

std::optional<std::string> NearestName(std::string_view word, std::span<const std::string> names) {
  const std::string lower = LowerCase(word);
  std::optional<std::string> nearest;
  std::size_t least = std::clamp<std::size_t>(word.size() / 3, 1, 3) + 1;
  for (const std::string& name : names) {
    const std::size_t edits = EditDistance(lower, LowerCase(name));
    // A name that shares no letter with the word is no remedy for it.
    if (edits < least && edits < std::max(word.size(), name.size())) {
      least = edits;
      nearest = name;
    }
  }
  if (nearest || word.size() < 3) return nearest;
  for (const std::string& name : names) {
    if (LowerCase(name).starts_with(lower) && (!nearest || name.size() < nearest->size())) {
      nearest = name;
    }
  }
  return nearest;
}

std::string DidYouMean(std::string_view word, std::span<const std::string> names) {
  const std::optional<std::string> name = NearestName(word, names);
  return name ? fmt::format(": did you mean '{}'?", *name) : ":";
}

std::string UnknownAmong(std::string_view word, std::span<const std::string> names) {
  return fmt::format("'{}' is unknown{} must be one of {}", word, DidYouMean(word, names),
                     fmt::join(names, ", "));
}

}  // namespace mindahl
