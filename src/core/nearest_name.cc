#include "core/nearest_name.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "core/text.h"

namespace mindahl {
namespace {

/// Edits from one text to the other, in which no part is edited twice.
std::size_t EditDistance(std::string_view from, std::string_view to) {
  std::vector<std::size_t> before_last(to.size() + 1);
  std::vector<std::size_t> last(to.size() + 1);
  std::vector<std::size_t> row(to.size() + 1);
  for (std::size_t j = 0; j <= to.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= from.size(); ++i) {
    before_last.swap(last);
    last.swap(row);
    row[0] = i;
    for (std::size_t j = 1; j <= to.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (from[i - 1] == to[j - 1] ? 0 : 1);
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, replaced});
      const bool swapped = i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1];
      if (swapped) row[j] = std::min(row[j], before_last[j - 2] + 1);
    }
  }
  return row[to.size()];
}

/// Edits by which a word of so many letters may be off the name that is meant.
std::size_t MostEdits(std::size_t letters) { return std::clamp<std::size_t>(letters / 3, 1, 3); }

}  // namespace

std::optional<std::string> NearestName(std::string_view word, std::span<const std::string> names) {
  const std::string lower = LowerCase(word);
  std::optional<std::string> nearest;
  std::size_t least = MostEdits(word.size()) + 1;
  for (const std::string& name : names) {
    const std::size_t edits = EditDistance(lower, LowerCase(name));
    // A name that shares no letter with the word is no remedy for it.
    if (edits < least && edits < std::max(word.size(), name.size())) {
      least = edits;
      nearest = name;
    }
  }
  if (nearest || word.size() < 3) return nearest;
  std::size_t shortest = std::numeric_limits<std::size_t>::max();
  for (const std::string& name : names) {
    if (name.size() < shortest && LowerCase(name).starts_with(lower)) {
      shortest = name.size();
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
