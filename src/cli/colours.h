#pragma once

#include <iosfwd>

namespace mindahl::cli {

/// True if results are shown by a terminal that has colours: the stream is standard output and a
/// terminal, TERM is not `dumb`, and NO_COLOR is not set (https://no-color.org).
bool HasColours(const std::ostream& results);

}  // namespace mindahl::cli
