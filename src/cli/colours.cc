#include "cli/colours.h"

#include <unistd.h>

#include <cstdlib>
#include <iostream>
#include <string_view>

namespace mindahl::cli {

bool HasColours(const std::ostream& results) {
  if (&results != &std::cout || ::isatty(STDOUT_FILENO) == 0) return false;
  const char* const no_colour = std::getenv("NO_COLOR");
  if (no_colour != nullptr && *no_colour != '\0') return false;
  const char* const terminal = std::getenv("TERM");
  return terminal != nullptr && std::string_view(terminal) != "dumb";
}

}  // namespace mindahl::cli
