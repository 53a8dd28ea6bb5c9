#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace mindahl::report {

/// Breaks a sentence between words at 100 columns, with a line feed at its end; lines after the
/// first are indented. A number stays with its error and its unit.
std::string Wrapped(std::string_view text, std::size_t indent);

}  // namespace mindahl::report
