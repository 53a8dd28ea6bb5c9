#pragma once

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <string>
#include <string_view>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl {

/// @throws InputError of a text always
template <typename... Parts>
[[noreturn]] void Refuse(fmt::format_string<Parts...> text, Parts&&... parts) {
  throw InputError(fmt::format(text, std::forward<Parts>(parts)...));
}

/// Returns "'mindin' is unknown: must be one of dahl, mindlin": of a word that is none of the names
/// that it may be.
template <typename Names>
std::string UnknownAmong(std::string_view word, const Names& names) {
  return fmt::format("'{}' is unknown: must be one of {}", word, fmt::join(names, ", "));
}

}  // namespace mindahl
