#include "cli/examples.h"

namespace mindahl::cli {

void AddExamples(CLI::App& command, const CLI::App& app,
                 std::initializer_list<std::string_view> lines) {
  std::string text = "Examples:\n";
  for (const std::string_view line : lines) {
    text += "  ";
    text += line;
    text += '\n';
  }
  command.footer(text + '\n' + app.get_footer());
}

}  // namespace mindahl::cli
