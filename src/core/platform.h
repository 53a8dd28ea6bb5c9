#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace mindahl {

// Everything that the project asks of the operating system stands here: a port writes platform.cc
// anew. Only that file includes headers of POSIX; branch_kernel.cc has what compilers differ in.
// Functions that return an error return errno's value, 0 where there is none.

/// Keeps what a fit's columns of samples allocate and free, instead of asking the system for it
/// anew: a tenth of the time of a fit of 10,000 samples.
void KeepFreedMemory();
/// Ignores SIGXFSZ, so that exceeding the file-size limit is reported as a write error.
void IgnoreFileSizeSignal();
int ProcessNumber();

enum class Opening {
  kNew,       ///< fails where the file exists
  kExisting,  ///< appends to what exists
  kCreated    ///< creates it where it does not exist
};
/// Opens a file for writing; children do not have it.
int OpenFile(const std::string& name, Opening opening, int& file);
/// Writes all of it.
int WriteFile(int file, std::string_view content);
/// Ends the file at a size, after which the next write goes.
int EndFileAt(int file, std::uintmax_t size);
/// Waits until a file is on the disk, so that it survives a loss of power; a file system that has
/// no such request is left to itself.
int WriteToDisk(int file);
int CloseFile(int file);

/// Runs a command of the shell; what it reads and writes is in files without names.
/// @returns what it writes; empty where it cannot be run or fails, whatever it says of that
std::optional<std::string> OutputOf(const std::string& command, std::string_view input);

}  // namespace mindahl
