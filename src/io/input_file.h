#pragma once

#include <cstddef>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>

/// Files that are read, and standard input under the name "-".
namespace mindahl::io {

/// A line longer than that is no row of a record.
inline constexpr std::size_t kLongestLine = 16U << 20U;

/// Returns what messages call the file.
std::string NameOfInput(const std::filesystem::path& path);

/// @throws InputError "cannot read '<name>': <reason>", by errno
[[noreturn]] void ThrowCannotRead(const std::string& name);

/// @throws InputError for a line longer than kLongestLine
[[noreturn]] void ThrowLongLine(const std::string& name);

/// Closes what was opened; standard input stays open.
struct CloseInput {
  void operator()(std::FILE* file) const;
};
using InputFile = std::unique_ptr<std::FILE, CloseInput>;

/// @throws InputError where the file cannot be opened
InputFile OpenInput(const std::filesystem::path& path);

}  // namespace mindahl::io
