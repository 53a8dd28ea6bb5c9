#include "cli/colours.h"

#include <cstdlib>
#include <iostream>
#include <string_view>

#include "core/platform.h"

namespace mindahl::cli {

bool HasColours(const std::ostream& results) {
  if (&results != &std::cout || !IsTerminal(Stream::kOutput)) return false;
  const char* const no_colour = std::getenv("NO_COLOR");
  if (no_colour != nullptr && *no_colour != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  return terminal != nullptr && std::string_view(terminal) != "dumb";
}

}  // namespace mindahl::cli
