#pragma once

#include <span>
#include <string>
#include <string_view>

namespace mindahl::request {

/// Refuses a word that is none of those that an option takes.
/// @throws InputError naming the option, the word, the nearest of the words where one is near, and
///   all of them
void RequireOneOf(std::string_view option, std::string_view word,
                  std::span<const std::string_view> words);

}  // namespace mindahl::request
