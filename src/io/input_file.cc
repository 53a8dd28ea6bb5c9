#include "io/input_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

#include "mindahl/core/error.h"
#include "mindahl/io/csv_table.h"

namespace mindahl::io {

std::string NameOfInput(const std::filesystem::path& path) {
  return path == kStandardInput ? "standard input" : path.string();
}

void ThrowCannotRead(const std::string& name) {
  throw InputError(fmt::format("cannot read '{}': {}", name, std::strerror(errno)));
}

void ThrowLongLine(const std::string& name) {
  throw InputError(fmt::format("{}: has a line of more than {} bytes: lines must end in LF or CRLF",
                               name, kLongestLine));
}

void CloseInput::operator()(std::FILE* file) const {
  if (file != stdin) std::fclose(file);
}

InputFile OpenInput(const std::filesystem::path& path) {
  InputFile file(path == kStandardInput ? stdin : std::fopen(path.c_str(), "rb"));
  if (!file) ThrowCannotRead(NameOfInput(path));
  return file;
}

}  // namespace mindahl::io
