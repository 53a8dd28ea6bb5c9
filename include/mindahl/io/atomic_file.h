#pragma once

#include <filesystem>
#include <string_view>

namespace mindahl::io {

/// Writes a whole file so that a reader finds the old content or the new, never a part: to a
/// temporary name in the same directory, then by renaming. On failure nothing is left behind and an
/// existing file is untouched.
///
/// A new file gets the permissions of the umask, an existing one keeps its own, and a symbolic link
/// stays a link. What cannot be renamed over (a device, a pipe, anything below /dev or /proc, as
/// /dev/stdout is) is written straight to.
/// @throws InputError "cannot write '<path>': <reason>"
/// Safe against a crash of the program, not of the machine: the disk is not told to synchronise.
void WriteFileAtomically(const std::filesystem::path& path, std::string_view content);

/// For a program: from now on SIGINT, SIGTERM and SIGHUP, unless they are ignored, remove the files
/// that this module has begun and not yet finished, and then end the program as they would have.
void RemoveTemporaryFilesOnSignals();

}  // namespace mindahl::io
