#pragma once

#include <fmt/format.h>

#include <utility>

#include "mindahl/core/error.h"

namespace mindahl {

/// @throws InputError of a text always
template <typename... Parts>
[[noreturn]] void Refuse(fmt::format_string<Parts...> text, Parts&&... parts) {
  throw InputError(fmt::format(text, std::forward<Parts>(parts)...));
}

}  // namespace mindahl
