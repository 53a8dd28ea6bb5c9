#include "cli/text_output.h"

#include "mindahl/io/output_file.h"

namespace mindahl::cli {

void WriteText(std::string_view text, const std::string& path, Console& console) {
  if (path == "-") {
    console.out << text;
  } else {
    io::WriteFileAtomically(path, text);
  }
}

}  // namespace mindahl::cli
