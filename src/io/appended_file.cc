#include "mindahl/io/appended_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

#include "io/to_disk.h"
#include "io/write_fault.h"

namespace mindahl::io {
AppendedFile::AppendedFile(std::filesystem::path path, std::uintmax_t kept)
    : path_(std::move(path)),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666)),
      size_(kept) {
  if (descriptor_ < 0) ThrowCannotWrite(path_, errno);
  const auto end = static_cast<off_t>(kept);
  if (::ftruncate(descriptor_, end) != 0 || ::lseek(descriptor_, end, SEEK_SET) != end) {
    const int error = errno;
    ::close(descriptor_);
    ThrowCannotWrite(path_, error);
  }
}

AppendedFile::~AppendedFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void AppendedFile::Append(std::string_view block) {
  std::string_view rest = block;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      const auto end = static_cast<off_t>(size_);
      if (::ftruncate(descriptor_, end) == 0) ::lseek(descriptor_, end, SEEK_SET);
      ThrowCannotWrite(path_, error);
    }
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  size_ += block.size();
}

void AppendedFile::Finish() {
  WriteToDisk(descriptor_, path_);
  if (::close(std::exchange(descriptor_, -1)) != 0) ThrowCannotWrite(path_, errno);
  WriteNameToDisk(path_, path_);
}

}  // namespace mindahl::io
