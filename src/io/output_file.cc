#include "mindahl/io/output_file.h"

#include <fmt/format.h>

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>
#include <utility>

#include "core/platform.h"
#include "io/source.h"

namespace mindahl::io {
namespace {

void RequireWritten(const std::filesystem::path& path, int error) {
  if (error != 0) Refuse("cannot write '{}': {}", path.string(), std::strerror(error));
}

}  // namespace

void WriteFileAtomically(const std::filesystem::path& path, std::string_view content) {
  std::error_code error;
  const std::filesystem::file_status old = std::filesystem::status(path, error);
  const bool is_old = std::filesystem::exists(old);
  // /dev/stdout may lead to a regular file, which the shell opened and must not be replaced.
  const std::string plain = path.lexically_normal().string();
  const bool is_device = plain.starts_with("/dev/") || plain.starts_with("/proc/");
  const bool replaces = !is_device && (!is_old || std::filesystem::is_regular_file(old));
  const std::filesystem::path target = replaces && is_old ? std::filesystem::canonical(path) : path;
  static std::atomic<unsigned> counter = 0;
  const std::string name =
      (target.parent_path() /
       fmt::format(".{}.{}.{}.tmp", target.filename().string(), ProcessNumber(), counter++))
          .string();
  int file = -1;
  int fault = replaces ? OpenFile(name, Opening::kNew, file)
                       : OpenFile(path.string(), Opening::kExisting, file);
  if (fault == 0 && replaces && is_old) {
    std::filesystem::permissions(name, old.permissions(), error);
    fault = error.value();
  }
  if (fault == 0) fault = WriteFile(file, content);
  if (fault == 0 && replaces) fault = WriteToDisk(file);
  // A full disk may show only here.
  const int closed = file >= 0 ? CloseFile(file) : 0;
  if (fault == 0) fault = closed;
  if (fault == 0 && replaces && std::rename(name.c_str(), target.c_str()) != 0) fault = errno;
  if (fault != 0 && replaces) static_cast<void>(std::remove(name.c_str()));
  RequireWritten(path, fault);
}

AppendedFile::AppendedFile(const std::filesystem::path& path, std::uintmax_t kept)
    : path_(path), size_(kept) {
  RequireWritten(path, OpenFile(path.string(), Opening::kCreated, file_));
  const int error = EndFileAt(file_, kept);
  if (error != 0) CloseFile(file_);
  RequireWritten(path, error);
}

AppendedFile::~AppendedFile() {
  if (file_ >= 0) CloseFile(file_);
}

void AppendedFile::Append(std::string_view block) {
  const int error = WriteFile(file_, block);
  if (error != 0) EndFileAt(file_, size_);
  RequireWritten(path_, error);
  size_ += block.size();
}

void AppendedFile::Finish() {
  RequireWritten(path_, WriteToDisk(file_));
  RequireWritten(path_, CloseFile(std::exchange(file_, -1)));
}

}  // namespace mindahl::io
