#include "mindahl/io/appended_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "mindahl/core/error.h"

namespace mindahl::io {
namespace {

[[noreturn]] void Fail(const std::filesystem::path& path, int error) {
  throw InputError(fmt::format("cannot write '{}': {}", path.string(), std::strerror(error)));
}

}  // namespace

AppendedFile::AppendedFile(std::filesystem::path path, std::uintmax_t kept)
    : path_(std::move(path)),
      descriptor_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666)),
      size_(kept) {
  if (descriptor_ < 0) Fail(path_, errno);
  const auto end = static_cast<off_t>(kept);
  if (::ftruncate(descriptor_, end) != 0 || ::lseek(descriptor_, end, SEEK_SET) != end) {
    const int error = errno;
    ::close(descriptor_);
    Fail(path_, error);
  }
}

AppendedFile::~AppendedFile() { ::close(descriptor_); }

void AppendedFile::Append(std::string_view block) {
  std::string_view rest = block;
  while (!rest.empty()) {
    const ssize_t written = ::write(descriptor_, rest.data(), rest.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) {
      const int error = errno;
      const auto end = static_cast<off_t>(size_);
      if (::ftruncate(descriptor_, end) == 0) ::lseek(descriptor_, end, SEEK_SET);
      Fail(path_, error);
    }
    rest.remove_prefix(static_cast<std::size_t>(written));
  }
  size_ += block.size();
}

}  // namespace mindahl::io
