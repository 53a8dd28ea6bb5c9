#include "cli/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "core/text.h"
#include "mindahl/core/error.h"
#include "mindahl/io/output_file.h"

namespace mindahl::cli {

void WriteText(std::string_view text, const std::string& path, Console& console) {
  if (path == "-") {
    console.out << text;
  } else {
    io::WriteFileAtomically(path, text);
  }
}

namespace fs = std::filesystem;

namespace {

/// Writing to a device, a terminal or a pipe replaces nothing.
bool CanBeReplaced(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  return !fs::exists(status) || fs::is_regular_file(status);
}

/// One file under one name or two, of which neither need be there yet.
bool IsSameFile(const fs::path& first, const fs::path& second) {
  std::error_code error;
  if (fs::equivalent(first, second, error)) return CanBeReplaced(first);
  if (fs::exists(first, error) || fs::exists(second, error)) return false;
  const auto place = [&](const fs::path& path) {
    const fs::path parent = path.parent_path();
    return fs::weakly_canonical(parent.empty() ? fs::path(".") : parent, error) / path.filename();
  };
  return place(first) == place(second);
}

void RequireWritable(const OutputPath& output) {
  constexpr std::array<std::string_view, 11> kNotWritten = {
      ".parquet", ".pq", ".feather", ".arrow", ".xlsx", ".xls",
      ".ods",     ".h5", ".hdf5",    ".mat",   ".npz"};
  const std::string ending = LowerCase(fs::path(output.path).extension().string());
  if (std::ranges::find(kNotWritten, ending) != kNotWritten.end()) {
    throw InputError(fmt::format("{}: '{}' would hold text, not what {} says: give it another name",
                                 output.option, output.path, ending));
  }
  std::error_code ignored;
  if (fs::is_directory(output.path, ignored)) {
    throw InputError(
        fmt::format("{}: cannot write '{}': it is a directory", output.option, output.path));
  }
  const fs::path parent = fs::path(output.path).parent_path();
  if (!parent.empty() && !fs::is_directory(parent, ignored)) {
    throw InputError(fmt::format("{}: cannot write '{}': there is no directory '{}'", output.option,
                                 output.path, parent.string()));
  }
}

}  // namespace

void RequireOutputPaths(std::initializer_list<OutputPath> outputs, const Console& console,
                        const std::vector<std::string>& files) {
  std::vector<std::string> inputs = console.inputs;
  inputs.insert(inputs.end(), files.begin(), files.end());
  std::vector<OutputPath> checked;
  for (const OutputPath& output : outputs) {
    if (output.path.empty() || (output.dash_is_stdout && output.path == "-")) continue;
    RequireWritable(output);
    for (const std::string& input : inputs) {
      if (input.empty() || !IsSameFile(output.path, input)) continue;
      throw InputError(
          fmt::format("{}: '{}' is the input '{}', which it would replace: write to another file",
                      output.option, output.path, input));
    }
    for (const OutputPath& other : checked) RequireDistinctOutputs(other, output);
    checked.push_back(output);
  }
}

void RequireDistinctOutputs(const OutputPath& first, const OutputPath& second) {
  if (first.path.empty() || second.path.empty() || !IsSameFile(first.path, second.path)) return;
  throw InputError(fmt::format("{} and {} both write to '{}': give each a file of its own",
                               first.option, second.option, second.path));
}

void RequireDistinctFiles(std::span<const std::string> files) {
  for (std::size_t i = 0; i < files.size(); ++i) {
    for (std::size_t k = 0; k < i; ++k) {
      if (!IsSameFile(files[i], files[k])) continue;
      throw InputError(
          fmt::format("'{}' and '{}' are one file, whose samples would count twice: give it once",
                      files[k], files[i]));
    }
  }
}

void RequireNotThere(const OutputPath& output, std::string_view remedy) {
  std::error_code ignored;
  if (!fs::is_regular_file(output.path, ignored)) return;  // a device loses nothing
  throw InputError(fmt::format("{}: {} exists: add {}", output.option, output.path, remedy));
}

}  // namespace mindahl::cli
