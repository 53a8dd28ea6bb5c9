#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace mindahl::io {

/// A file that grows by whole blocks while a run goes on. What was appended stays, whatever ends
/// the run: a block that cannot be written whole is cut off again.
class AppendedFile {
 public:
  /// Opens the file, or makes it, and cuts it off after its first `kept` bytes.
  /// @throws InputError "cannot write '<path>': <reason>"
  AppendedFile(std::filesystem::path path, std::uintmax_t kept);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  /// @throws InputError likewise, as where the disk is full
  void Append(std::string_view block);

  /// Closes the file once all of it is on the disk. What was appended before that survives the end
  /// of the program, and of the machine only what the system has written by then, within half a
  /// minute as a rule.
  /// @throws InputError likewise
  void Finish();

 private:
  std::filesystem::path path_;
  int descriptor_;
  std::uintmax_t size_;
};

}  // namespace mindahl::io
