#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace mindahl {

/// Returns the name that a misspelt word was probably meant for: the one which fewest insertions,
/// deletions, substitutions and swaps of neighbouring letters lead to (optimal string alignment),
/// whatever their case; a third of the word's letters, at least one and at most three. Where there
/// is none, the shortest name of those that begin with the word, of three letters or more. Of
/// equals the first.
///
/// Costs the product of the lengths for each name.
std::optional<std::string> NearestName(std::string_view word, std::span<const std::string> names);

/// Returns the end of a message about an unknown word, before its remedy: ": did you mean 'NAME'?",
/// or ":" where no name is near.
std::string DidYouMean(std::string_view word, std::span<const std::string> names);

/// Returns "'mindin' is unknown: did you mean 'mindlin'? must be one of dahl, mindlin": of a word
/// that is none of the names that it may be.
std::string UnknownAmong(std::string_view word, std::span<const std::string> names);

}  // namespace mindahl
