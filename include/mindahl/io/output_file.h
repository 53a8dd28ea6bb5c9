#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

namespace mindahl::io {

/// Writes a whole file so that a reader finds the old content or the new, never a part: to a
/// temporary name in the same directory, which is renamed when all of it is on the disk. On failure
/// nothing is left behind; a signal may leave the temporary file, whose name begins with a dot.
///
/// A new file gets the permissions of the umask, an existing one keeps its own, and a symbolic link
/// stays a link. A device, a pipe and what is below /dev or /proc is written to directly.
/// @throws InputError "cannot write '<path>': <reason>"
void WriteFileAtomically(const std::filesystem::path& path, std::string_view content);

/// A file that grows by whole blocks while a run goes on. What was appended stays, whatever ends
/// the run: a block that cannot be written whole is cut off again.
class AppendedFile {
 public:
  /// Opens the file, or makes it, and cuts it off after its first `kept` bytes.
  /// @throws InputError "cannot write '<path>': <reason>"
  AppendedFile(const std::filesystem::path& path, std::uintmax_t kept);
  ~AppendedFile();
  AppendedFile(const AppendedFile&) = delete;
  AppendedFile& operator=(const AppendedFile&) = delete;

  /// @throws InputError likewise, as where the disk is full
  void Append(std::string_view block);

  /// Closes the file once all of it is on the disk; until then it survives the end of the program.
  /// @throws InputError likewise
  void Finish();

 private:
  std::filesystem::path path_;
  int file_ = -1;
  std::uintmax_t size_;
};

}  // namespace mindahl::io
